"""Every verb and every option of the command line."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from chord_usd.cli import build_parser


def leaves(parser: argparse.ArgumentParser, words: tuple[str, ...] = ()) -> list[str]:
    """Every verb, as a user types it."""
    groups = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    if not groups:
        return [" ".join(words)]
    children = groups[0].choices.items()
    return [verb for name, child in children for verb in leaves(child, (*words, name))]


def actions_of(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.Action]]:
    """Every action of every verb, with the verb's name."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for inner in action.choices.values():
                yield from actions_of(inner)
        else:
            yield parser.prog, action


VERBS = leaves(build_parser())
ACTIONS = list(actions_of(build_parser()))
