"""Command lines made odd: texts that nobody would plan from, and values that no option has."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from random import Random

from chord_usd.cli import build_parser
from chord_usd.faces.commands.paths import output_file, output_folder, output_place, output_run
from outside.mutate import NUMBERS, TEXTS

_PHRASES = (
    "two bedrooms", "a living room of 20 m2", "minus 5 bedrooms", "1e9 bathrooms", "no kitchen",
    "Küche",
    "bedroom next to kitchen", "90 square metres", "-3 m wide", "a study north of the living room",
    "0 rooms", "99999999999999999999 rooms", "three floors", "open plan", "\u4e00", "and", ",", ";",
    "(",
    "3.5 bedrooms", "bedroom", "x" * 2000, "two two two", "NaN square metres", "not a flat",
)  # fmt: skip

_FILES = {"plan.png": "plan.png", "plan.json": "plan.json", "scene.json": "small.json",
          "house.usda": "house/house.usda", "houses": "houses", "library": "library"}  # fmt: skip
"""What tests name, as the samples are called."""

_LONG = ("train", "evaluate", "render", "batch", "dataset synth", "assets build")
"""Verbs that may run for hours: they are given what must be refused, and nothing else."""
_ALL_OF_IT = "assets build"
"""Has no number to refuse, and draws 700 models each time."""
_REFUSED = ("nan", "inf", "-1", "", "x", "1e400", "--", "1" * 40, "-1e308", "0x1", "٣.", "1\n2")


def text(rng: Random) -> list[str]:
    """plan from-text with an odd text."""
    parts = [
        rng.choice(rng.choice((_PHRASES, _PHRASES, TEXTS)))
        for _ in range(rng.choice((1, 2, 4, 12)))
    ]
    said = rng.choice((", ", " ", "\n", " and ")).join(parts)
    # No command line holds a zero byte or half a character.
    said = said.replace("\x00", "").encode("utf-8", "replace").decode()
    return ["plan", "from-text", said, "-o", "{out}.png", "--seed", str(rng.randrange(3))]


def options(rng: Random) -> list[str]:
    """Any verb with one to three options of which any may have an odd value."""
    from tests.strangers_verbs import ENDLESS, INPUTS

    verbs = dict(_leaves(build_parser()))
    verb = rng.choice(sorted(verbs.keys() & INPUTS.keys() - ENDLESS - {_ALL_OF_IT}))
    words = [_known(word) for word in INPUTS[verb]]
    actions = [action for action in verbs[verb]._actions if _takes_value(action)]
    if verb.startswith(_LONG):
        actions = [action for action in actions if _is_number(action)]
    for action in rng.sample(actions, min(len(actions), rng.choice((1, 1, 2, 3)))):
        # A value that begins with a dash is one only after an equals sign.
        words.append(f"{action.option_strings[-1]}={_value(action, verb, rng)}")
    suffix = {"export": ".usdz", "layout": ".png", "plan draw": ".png"}.get(verb, ".usda")
    if verb.startswith("plan from"):
        suffix = ".png"
    folder = any(a.type in (output_folder, output_run, output_place) for a in verbs[verb]._actions)
    return [*verb.split(), *words, "-o", "{out}" if folder else f"{{out}}{suffix}"]


def _known(word: str) -> str:
    return f"{{in}}/{_FILES[word]}" if word in _FILES else word


def _leaves(
    parser: argparse.ArgumentParser, words: tuple[str, ...] = ()
) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    groups = [one for one in parser._actions if isinstance(one, argparse._SubParsersAction)]
    if not groups:
        yield " ".join(words), parser
    for group in groups:
        for name, child in group.choices.items():
            yield from _leaves(child, (*words, name))


def _takes_value(action: argparse.Action) -> bool:
    writes = action.type in (output_file, output_folder, output_place, output_run)
    return (
        bool(action.option_strings) and action.nargs != 0 and not writes and action.dest != "help"
    )


def _is_number(action: argparse.Action) -> bool:
    return action.type not in (None, Path, str) and action.dest not in ("passes", "resolution")


def _value(action: argparse.Action, verb: str, rng: Random) -> str:
    counts = _is_number(action)
    if verb.startswith(_LONG):
        return rng.choice(_REFUSED)
    if action.choices and rng.random() < 0.5:
        return str(rng.choice(list(action.choices)))
    kinds = (NUMBERS, NUMBERS, TEXTS) if counts else (TEXTS, TEXTS, NUMBERS)
    value = rng.choice(rng.choice(kinds)).replace("\x00", "")
    return value.encode("utf-8", "replace").decode()
