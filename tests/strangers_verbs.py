"""Every verb that writes: what it is given to read, where it can write, and a stranger's folder.

The outputs are read off the parser, so that a new one cannot be forgotten.
"""

from __future__ import annotations

from argparse import ArgumentParser, _SubParsersAction
from collections.abc import Iterator
from pathlib import Path

from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import write_plan, write_scene
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import build_parser
from chord_usd.faces.commands.paths import (
    output_file,
    output_folder,
    output_package,
    output_place,
    output_run,
)
from chord_usd.line.pipeline import draw_plan

INPUTS: dict[str, tuple[str, ...]] = {
    "generate": ("plan.png",),
    "plan read": ("plan.png",),
    "plan draw": ("plan.json",),
    "plan from-text": ("two bedrooms",),
    "plan from-outline": ("plan.png",),
    "layout": ("plan.png",),
    "graph": ("plan.png",),
    "stage": ("scene.json",),
    "render": ("house.usda",),
    "serve": (),
    "batch": ("plan.png",),
    "farm bundle": ("house.usda",),
    "check": ("house.usda",),
    "describe": ("house.usda",),
    "regenerate": ("house.usda", "--room", "Bedroom_0"),
    "edit": ("house.usda", "no rug in bedroom 1"),
    "export": ("house.usda", "--for", "web"),
    "dataset synth": ("--count", "1"),
    "dataset import": ("scene.json",),
    "dataset clean": ("houses",),
    "dataset stats": ("houses",),
    "dataset split": ("houses",),
    "dataset keep": ("houses",),
    "dataset draw": ("houses",),
    "dataset release": ("--count", "1"),
    "dataset twins": ("houses", "--count", "1"),
    "train plan2layout": (),
    "train table": (),
    "train text2plan": (),
    "train outline2plan": (),
    "train bubbles": (),
    "train lists": (),
    "train boxes": (),
    "train reader": (),
    "train symbols": (),
    "train next": (),
    "train detector": (),
    "evaluate layouts": ("--from", "houses"),
    "evaluate scenes": ("scene.json",),
    "evaluate ood": ("--houses", "houses"),
    "evaluate speed": ("--houses", "houses"),
    "evaluate diversity": ("--houses", "houses"),
    "evaluate detector": ("--layouts", "plan.png"),
    "evaluate plans": (),
    "evaluate tabletops": (),
    "evaluate text": (),
    "evaluate outlines": (),
    "assets list": (),
    "assets nearest": ("bed", "--size", "2x2x1"),
    "assets show": ("Bed",),
    "assets export": ("Book_Lying", "--for", "simready"),
    "assets add": ("library",),
    "assets build": (),
    "looks sheet": (),
    "looks show": ("planks",),
}
"""What each verb that writes is given to read."""

ENDLESS = {"serve"}
"""Verbs that run until they are interrupted."""


_ROLES = (output_file, output_folder, output_package, output_place, output_run)


def outputs(parser: ArgumentParser, words: tuple[str, ...] = ()) -> Iterator[tuple[str, str, str]]:
    """(verb, option, kind of output) for everything that the command line can write to."""
    for action in parser._actions:
        if isinstance(action, _SubParsersAction):
            for name, child in action.choices.items():
                yield from outputs(child, (*words, name))
        elif action.type in _ROLES:
            yield " ".join(words), action.option_strings[-1], action.type.__name__


OUTPUTS = sorted(set(outputs(build_parser())))


def make_home(home: Path, house: SceneGraph) -> Path:
    """Fill a folder with all kinds of inputs, a stage, and a thesis; returns it."""
    write_plan(house.plan, home / "plan.json")
    write_scene(house, home / "scene.json")
    write_raster(draw_plan(house.plan), home / "plan.png")
    (home / "houses").mkdir()
    write_scene(house, home / "houses" / "one.json")
    (home / "library").mkdir()
    (home / "library" / "manifest.json").write_text("[]")
    (home / "mine").mkdir()
    (home / "mine" / "thesis.txt").write_text("years of work")
    (home / "house.usda").write_text('#usda 1.0\n(defaultPrim = "House")\ndef Xform "House" {}\n')
    return home


def option_strings(parser: ArgumentParser, verb: str) -> set[str]:
    """All options of a verb, such as "dataset synth"."""
    for word in verb.split():
        group = next(one for one in parser._actions if isinstance(one, _SubParsersAction))
        parser = group.choices[word]
    return {option for action in parser._actions for option in action.option_strings}
