"""Options of a house on the command line: arguments from the table, and Settings from arguments."""

from __future__ import annotations

import argparse
from collections.abc import Collection
from pathlib import Path
from typing import Any

from chord_usd.base.scene.settings import OPTIONS, Option, Settings, form_field, offered_by
from chord_usd.faces.commands.common import Options, Parser, real_number, whole_number
from chord_usd.faces.commands.paths import sky


def add_options(parser: Options, *names: str, unset: Collection[str] = (), **helps: str) -> None:
    """Arguments for rows of the table, by name.

    unset: rows without a default, for verbs that read it elsewhere. helps: other help texts, by
    name.
    """
    for name in [*names, *helps]:
        default = None if name in unset else OPTIONS[name].default
        _add(parser, OPTIONS[name], default, helps.get(name, OPTIONS[name].help))


def _add(parser: Options, option: Option, default: object, help: str) -> None:
    arguments: dict[str, Any] = {"dest": option.name, "help": help}
    if isinstance(option.default, bool):
        parser.add_argument(f"--{option.word}", action="store_false", **arguments)
    elif isinstance(option.default, tuple):
        arguments |= {"action": "append", "default": [], "type": Path}
        parser.add_argument(f"--{option.word}", metavar=option.metavar, **arguments)
    elif option.choices:
        parser.add_argument(
            f"--{option.word}", choices=option.choices, default=default, **arguments
        )
    else:
        # argparse gives texts that are defaults to the type, too.
        default = None if default == "" else default
        arguments |= {"type": _type_of(option), "metavar": option.metavar, "default": default}
        parser.add_argument(f"--{option.word}", **arguments)


def _type_of(option: Option) -> Any:
    if option.limits:
        least, most = option.limits
        if isinstance(least, int):
            return whole_number(least, int(most))
        return real_number(least, most, " metres per pixel")
    return sky if option.name == "sky" else option.check or _filled


def _filled(text: str) -> str:
    """An option type: a text that holds something."""
    if not text.strip():
        raise argparse.ArgumentTypeError("is empty")
    return text


def settings_of(options: argparse.Namespace) -> Settings:
    """The settings of all rows that a verb has; "" for a style that stays as it is noted.

    Raises ChordError.
    """
    chosen = {name: getattr(options, name) for name in OPTIONS if hasattr(options, name)}
    if "asset_folders" in chosen:
        chosen["asset_folders"] = tuple(chosen["asset_folders"])
    for name in [name for name, value in chosen.items() if value is None]:
        chosen[name] = "" if name == "style" else OPTIONS[name].default
    return Settings(**chosen)


def panel_rows() -> list[dict[str, Any]]:
    """Rows that the Blender panel offers, as JSON, each with the verbs that take it."""
    from chord_usd.faces.commands import generate, regenerate

    verbs = Parser(prog="chord-usd").add_subparsers()
    for verb in (generate, regenerate):
        verb.add(verbs)
    taken = {name: set(parser._option_string_actions) for name, parser in verbs.choices.items()}
    return [
        {
            **form_field(option),
            "word": option.word,
            "verbs": [name for name, words in taken.items() if f"--{option.word}" in words],
        }
        for option in offered_by("panel")
    ]


def documented_rows() -> str:
    """All rows as a table of Markdown."""
    lines = ["| option | Python | what it does |", "|---|---|---|"]
    for row in OPTIONS.values():
        value = f" {row.metavar}" if row.metavar else ""
        choices = f"; one of {', '.join(row.choices)}" if row.choices else ""
        python = f"{row.name}=False" if row.default is True else row.name
        lines.append(f"| `--{row.word}{value}` | `{python}` | {row.help}{choices} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    import json
    import sys

    panel = json.dumps(panel_rows(), indent=1) + "\n"
    sys.stdout.write(panel if "panel" in sys.argv else documented_rows())
