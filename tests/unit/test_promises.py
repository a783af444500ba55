"""What scripts may rely on stays: docs/promises.md, by the record of what was there before."""

from __future__ import annotations

import argparse
import inspect
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import chord_usd
from chord_usd.cli import build_parser
from chord_usd.faces.commands.results import RESULTS, schema_of

RECORD = Path(__file__).parents[1] / "fixtures" / "promised.json"


def options_of(parser: argparse.ArgumentParser, verb: str = "") -> Iterator[str]:
    """Every verb with each of its options and places, as "edit --force" and "edit 1"."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                yield from options_of(inner, f"{verb} {name}".strip())
        elif action.option_strings:
            yield from (f"{verb} {name}" for name in action.option_strings if name[:2] == "--")


def keys_of(schema: dict[str, Any], place: str) -> Iterator[str]:
    """Every key with its types, as "check/por number"; "?" where it may be missing."""
    for name, inner in schema.get("properties", {}).items():
        kind = inner.get("type", "any")
        optional = "" if name in schema.get("required", ()) else "?"
        yield f"{place}/{name}{optional} {kind}"
        yield from keys_of(inner, f"{place}/{name}")
    if isinstance(schema.get("items"), dict):
        yield from keys_of(schema["items"], f"{place}[]")


def names_of_python() -> Iterator[str]:
    """Every public name with its parameters, as "House.render camera"."""
    for name in chord_usd._EXPORTED:
        value = getattr(chord_usd, name)
        yield name
        members = inspect.getmembers(value) if inspect.isclass(value) else [("", value)]
        for member, inner in members:
            if member.startswith("_") or issubclass(chord_usd.ChordError, value_class(value)):
                continue
            whole = f"{name}.{member}".rstrip(".")
            yield whole
            if callable(inner):
                parameters = inspect.signature(inner).parameters
                yield from (f"{whole} {each}" for each in parameters if each != "self")


def value_class(value: object) -> type:
    """The class itself, or one that no error is."""
    return value if inspect.isclass(value) else int


def surface() -> dict[str, list[str]]:
    """What there is now."""
    schemas = ((verb, schema_of(verb)) for verb in RESULTS)
    return {
        "command line": sorted(set(options_of(build_parser()))),
        "json": sorted({key for verb, schema in schemas for key in keys_of(schema, verb)}),
        "python": sorted(set(names_of_python())),
    }


def test_nothing_that_was_promised_is_gone() -> None:
    """A new name goes into the record with the release that has it: run this file as a script."""
    promised = json.loads(RECORD.read_text())
    now = surface()
    gone = {part: sorted({*names} - {*now[part]}) for part, names in promised.items()}
    assert not any(gone.values()), gone


def test_the_record_covers_what_the_promise_names() -> None:
    promised = json.loads(RECORD.read_text())
    assert {"generate --seed", "check --standard", "edit --dry-run"} <= {*promised["command line"]}
    assert {"check/holds boolean", "check/por number"} <= {*promised["json"]}
    assert {"generate", "generate seed", "House.rooms", "House.undo"} <= {*promised["python"]}


if __name__ == "__main__":
    RECORD.write_text(json.dumps(surface(), indent=0, ensure_ascii=False) + "\n")
