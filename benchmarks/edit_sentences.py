"""Forty sentences said to a dressed house: done, refused or done wrongly, and in how long.

    python benchmarks/edit_sentences.py [--style NAME]

The house is that of tests/fixtures/furnished_house.json, dressed; each sentence of sentences.json
is said to a copy of it, by the command line's own function; with force, since some cost a room
what it needs. Whether it was done is told by the facts that the file has for it, not by the
program: a sentence is done right if they hold and nothing that no fact speaks of was changed.
Rooms that the program does not name have to be the same, byte for byte.
"""

from __future__ import annotations

import argparse
import json
import shutil
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # tests

from pxr import Sdf  # noqa: E402
from results import write_section  # noqa: E402

from chord_usd.base.errors import ChordError  # noqa: E402
from chord_usd.base.scene.settings import Settings  # noqa: E402
from chord_usd.base.scene.styles import style_named  # noqa: E402
from chord_usd.line.pipeline import dress_rooms, read_scene_file, settle, write_stage  # noqa: E402
from chord_usd.line.pipeline.edit_house import Reading, edit  # noqa: E402
from chord_usd.line.stage.edit.staged_house import StagedHouse, read_house  # noqa: E402
from tests.house_facts import Facts  # noqa: E402

_LAYERS: list[Sdf.Layer] = []
FIXTURES = ROOT / "tests" / "fixtures"


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--style", default="modern")
    options = parser.parse_args()
    sentences = json.loads((FIXTURES / "sentences.json").read_text())
    ends, seconds = defaultdict(list), defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        house = _dressed(Path(folder), options.style)
        for number, said in enumerate(sentences):
            copy = Path(folder, str(number))
            shutil.copytree(house.parent, copy)
            end, why, cpu_s = _said(said, copy / house.name)
            seconds[end].append(cpu_s)
            ends[end].append(said["say"])
            sys.stderr.write(f"{end}: {said['say']} {why}\n")
            shutil.rmtree(copy)
    rows = [(end, str(len(said))) for end, said in sorted(ends.items())]
    rows += [
        (f"processor time, {end}", f"{statistics.median(own):.1f} s, at most {max(own):.1f} s")
        for end, own in sorted(seconds.items())
    ]
    wrong = [said for end, own in ends.items() if end.startswith("wrong") for said in own]
    note = f"{len(sentences)} sentences, a {options.style} house, one process, median."
    sys.stdout.write(write_section("sentences", rows, note + "".join(f"\n- {w}" for w in wrong)))


def _dressed(folder: Path, style: str) -> Path:
    """A stage of the test's house, dressed and with its own meshes."""
    from chord_usd.library.database import load_database

    settings = Settings(style=style, texture_px=256)
    graph = settle(read_scene_file(FIXTURES / "furnished_house.json", settings), settings)
    database = load_database((), style_named(style, 0).name, settings.texture_px)
    graph = dress_rooms(graph, database, settings)
    path = folder / "house" / "house.usda"
    path.parent.mkdir()
    write_stage(graph, path, settings)
    return path


def _said(said: dict[str, Any], house: Path) -> tuple[str, str, float]:
    """How a sentence ended, why, and in how many seconds of processor time."""
    before, rooms = read_house(house), _rooms(house)
    start = time.process_time()
    try:
        done: Reading | ChordError = edit(house, said["say"], house, force=True)[0]
    except ChordError as error:
        done = error
    cpu_s = time.process_time() - start
    return *_end(said, before, rooms, house, done), cpu_s


def _end(
    said: dict[str, Any], before: StagedHouse, rooms: dict[str, str], house: Path,
    done: Reading | ChordError,
) -> tuple[str, str]:  # fmt: skip
    if isinstance(done, ChordError):
        is_same = _rooms(house) == rooms
        end = (
            "refused, as it should be" if "refused" in said else "refused, though it could be done"
        )
        return (end if is_same else "wrong: refused and changed"), str(done)
    if "refused" in said:
        return "wrong: done, though it cannot be", ""
    changed = {name for name, text in _rooms(house).items() if text != rooms[name]}
    if not changed <= set(done.rooms):
        return "wrong: another room was changed", ", ".join(changed - set(done.rooms))
    return _judged(said, before, house, done)


def _judged(
    said: dict[str, Any], before: StagedHouse, house: Path, reading: Reading
) -> tuple[str, str]:
    after = read_house(house)
    ids = {before.titles[name]: own for name, own in before.room_ids.items()}
    styles = {
        room: intent.style
        for intent in reading.understood.intents if intent.style for room in intent.rooms
    }  # fmt: skip
    looks = {
        (before.room_ids[prim.name], part): str(prim.variantSelections[f"{part}Material"])
        .partition("_")[0].lower()
        for prim in _rooms_of(house) for part in ("wall", "floor")
    }  # fmt: skip
    facts = Facts(before.graph, after.graph, ids, styles, sorted(after.locked), looks)
    false = [fact for fact in said["true"] if not facts.is_true(fact)]
    if false:
        return "wrong: not what was asked", json.dumps(false)
    return ("right" if facts.others_are_still(said) else "wrong: more than was asked"), ""


def _rooms(house: Path) -> dict[str, str]:
    """The text of each room, and of the rest of the layer."""
    return {one.name: one.GetAsText() for one in _rooms_of(house)}


def _rooms_of(house: Path) -> list[Sdf.PrimSpec]:
    layer = Sdf.Layer.OpenAsAnonymous(str(house))
    _LAYERS.append(layer)  # its specs live as long as it does
    return list(layer.GetPrimAtPath("/House/Rooms").nameChildren)


if __name__ == "__main__":
    main()
