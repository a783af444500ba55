"""Every verb of the command line."""

from __future__ import annotations

import argparse

from chord_usd.cli import build_parser


def leaves(parser: argparse.ArgumentParser, words: tuple[str, ...] = ()) -> list[str]:
    """Every verb, as a user types it."""
    groups = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    if not groups:
        return [" ".join(words)]
    children = groups[0].choices.items()
    return [verb for name, child in children for verb in leaves(child, (*words, name))]


VERBS = leaves(build_parser())
