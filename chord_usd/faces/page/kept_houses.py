"""The houses of a page on disk: plans, versions and what was made of them, below one folder.

ROOT/0f3a…/house.json          name, plan, versions; written whole after every change
           source.png          what was dropped
           drawing.png         the same as it was read, straightened
           plans/0001.json     what was read, then one for each correction
           versions/0001/house/house.usda   with its folders
                         view.glb, pictures/, packs/
"""

from __future__ import annotations

import json
import re
import secrets
import shutil
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError, StageError
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.house_history import History, read_history
from chord_usd.base.scene.limits import MOST_STOREYS
from chord_usd.base.scene.room_names import room_kind
from chord_usd.faces.page.uploads import shown_name

MOST_HOUSES = 500
STAGE = "house.usda"
EDITS = "house.edits.usda"
"""As the Blender panel calls the layer of changes over a house."""

_FILE = "house.json"
_ID = re.compile(r"[0-9a-f]{12}")

Record = dict[str, Any]


class NotThereError(ChordError):
    """A house, version or file that does not exist."""


class ChangedError(ChordError):
    """Something was changed since it was read: by another tab, or a job."""


class KeptHouses:
    """The houses below a folder. Records are copies: update changes them."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def listed(self) -> list[Record]:
        """All houses, the latest first: id, name, when they were made, how many versions. Storeys
        above others are none by themselves."""
        records = sorted(self._all(), key=lambda record: record["made"], reverse=True)
        kept = ("id", "name", "made", "shown")
        return [{key: record[key] for key in kept} for record in records if not record.get("below")]

    def new(self, name: str, suffix: str = "", text: str = "") -> Record:
        """A house of a plan file that is still to be written, or of a text."""
        if sum(1 for _ in self._all()) >= MOST_HOUSES:
            raise ChordError(f"there are {MOST_HOUSES} houses", try_="delete some")
        record: Record = {
            "id": secrets.token_hex(6),
            "name": shown_name(name),
            "made": _now(),
            "source": f"source{suffix}" if suffix else "",
            "text": text,
            "plan": 0,
            "reading": None,
            "drawing": None,
            "versions": [],
            "shown": 0,
        }
        self.folder_of(record["id"]).mkdir()
        self._write(record)
        return record

    def get(self, house: str) -> Record:
        """A certificate is that of the stage as it lies on disk, or None. Raises NotThereError."""
        folder = self.folder(house)
        try:
            record: Record = json.loads((folder / _FILE).read_text())
        except (OSError, ValueError):
            raise NotThereError("there is no such house") from None
        for version in record["versions"]:
            now = _state(folder / "versions" / f"{int(version['number']):04d}" / "house")
            if version.get("certified") != now:
                version["certificate"] = None
        return record

    def update(self, house: str, change: Callable[[Record], None]) -> Record:
        """Change a record and write it. Raises NotThereError."""
        record = self.get(house)
        change(record)
        self._write(record)
        return record

    def put_above(self, below: str, house: str) -> None:
        """Make a house the top storey of another. Raises NotThereError, ChordError."""
        ground = self.ground_of(below)
        above = self.storeys(ground)[1:]
        if len(above) + 2 > MOST_STOREYS:
            raise ChordError(f"a house has {MOST_STOREYS} storeys at most")
        self.update(ground, lambda kept: kept.update(above=[*above, house]))
        self.update(house, lambda kept: kept.update(below=ground))

    def ground_of(self, house: str) -> str:
        """The lowest storey of the house that a storey is of."""
        return str(self.get(house).get("below") or house)

    def storeys(self, house: str) -> list[str]:
        """All storeys of a house, the lowest first; itself where it has one."""
        ground = self.ground_of(house)
        above = self.get(ground).get("above", ())
        return [ground, *(storey for storey in above if self.folder_of(storey).is_dir())]

    def plans_above(self, house: str) -> list[tuple[str, int]]:
        """The current plans of the storeys above a house. Raises ChordError where none is."""
        files = []
        for storey in self.storeys(house)[1:]:
            record = self.get(storey)
            if not record["plan"]:
                raise ChordError(
                    f"the plan of the storey {record['name']!r} could not be read",
                    try_="delete that storey, or another file",
                )
            files.append((storey, int(record["plan"])))
        return files

    def delete(self, house: str) -> None:
        """Remove a house and all that was made of it, the storeys above it too."""
        if self.ground_of(house) == house:
            for storey in self.storeys(house)[1:]:
                self.delete(storey)
        folder = self.folder(house)
        (folder / _FILE).unlink(missing_ok=True)  # first: it is gone even if the rest fails
        shutil.rmtree(folder, ignore_errors=True)

    def folder(self, house: str) -> Path:
        """The folder of a house that is there. Raises NotThereError for anything else."""
        folder = self.folder_of(house) if _ID.fullmatch(house) else None
        if folder is None or not folder.is_dir() or folder.is_symlink():
            raise NotThereError("there is no such house")
        return folder

    def folder_of(self, house: str) -> Path:
        return self.root / house

    def word(self, path: Path) -> str:
        """A path as a word of a command line that is run in the root."""
        return f"./{path.relative_to(self.root).as_posix()}"

    # plans --------------------------------------------------------------------------------------

    def plan_path(self, house: str, number: int) -> Path:
        return self.folder(house) / "plans" / f"{number:04d}.json"

    def plan(self, house: str, number: int) -> Record:
        """A plan, as CHOrD JSON in which every room says its kind. Raises NotThereError."""
        path = self.plan_path(house, number)
        if not path.is_file():
            raise NotThereError("no such plan has been read")
        plan: Record = json.loads(path.read_text())
        for room in plan["rooms"]:
            room.setdefault("roomKind", room_kind(room["roomName"]))
        return plan

    def put_plan(self, house: str, plan: object, base: object, drawing: object = None) -> int:
        """Keep a corrected plan; returns its number.

        base: number of the plan it was made of; drawing: where the picture lies now. Raises
        ChordError for what is no plan, ChangedError where another one came in between.
        """
        record = self.get(house)
        if base != record["plan"]:
            raise ChangedError("the plan was changed in another tab", try_="load the page again")
        if not isinstance(plan, dict) or not isinstance(plan.get("rooms"), list):
            raise ChordError("is no plan", expected="CHOrD JSON with rooms")
        number = int(record["plan"]) + 1
        write_atomic(self.plan_path(house, number), json.dumps(plan, allow_nan=False))

        def change(kept: Record) -> None:
            kept["plan"] = number
            if isinstance(drawing, dict) and kept["drawing"]:
                kept["drawing"] = drawing

        self.update(house, change)
        return number

    # versions -----------------------------------------------------------------------------------

    def new_version(self, house: str) -> tuple[int, Path]:
        """Number and folder of a version that no job has written to."""
        folder = self.folder(house) / "versions"
        folder.mkdir(exist_ok=True)
        taken = [int(entry.name) for entry in folder.iterdir() if entry.name.isdecimal()]
        number = max(taken, default=0) + 1
        (folder / f"{number:04d}").mkdir()
        return number, folder / f"{number:04d}"

    def version_folder(self, house: str, number: object) -> Path:
        """The folder of a version that is finished. Raises NotThereError."""
        for version in self.get(house)["versions"]:
            if version["number"] == number:
                return self.folder(house) / "versions" / f"{int(version['number']):04d}"
        raise NotThereError("there is no such version")

    def stage(self, house: str, number: object) -> Path:
        """What to open of a version: its changes over the house where there are some."""
        folder = self.version_folder(house, number) / "house"
        edits = folder / EDITS
        return edits if edits.is_file() else folder / STAGE

    def state(self, house: str, number: object) -> list[list[object]]:
        """What a certificate of a version is of: names, sizes and times of its layers."""
        return _state(self.version_folder(house, number) / "house")

    def add_version(self, house: str, version: Record) -> None:
        """Note a finished version, with the certificate of its stage as it is now, and show it."""
        number = f"{int(version['number']):04d}"
        certified = _state(self.folder(house) / "versions" / number / "house")

        def change(record: Record) -> None:
            record["versions"].append(
                {"made": _now(), "pictures": [], "packs": [], "certified": certified, **version}
            )
            record["shown"] = version["number"]

        self.update(house, change)

    def note(self, house: str, number: object, change: Callable[[Record], None]) -> None:
        """Change what is noted of a version."""

        def inside(record: Record) -> None:
            for version in record["versions"]:
                if version["number"] == number:
                    change(version)

        self.update(house, inside)

    def past(self, record: Record) -> Record:
        """What was done to the version that is shown: what undo and redo would do, in words, and
        all changes that can be had again; or why these cannot be read, as "error"."""
        history, error = History(), ""
        try:
            if record["shown"]:
                folder = self.version_folder(record["id"], record["shown"])
                history = read_history(folder / "house" / STAGE)
        except StageError as reason:
            error = str(reason)
        now, undone = history.now, history.undone
        return {
            "undo": now.summary if now and history.before else None,
            "redo": undone.summary if undone else None,
            "number": history.number,
            "error": error,
            "changes": [{"number": change.number, "made": change.made, "told": change.summary}
                        for change in history.changes],
        }  # fmt: skip

    def _all(self) -> Iterator[Record]:
        for folder in self.root.iterdir():
            if _ID.fullmatch(folder.name):
                try:
                    yield self.get(folder.name)
                except NotThereError:
                    continue  # deleted a moment ago, or half deleted

    def _write(self, record: Record) -> None:
        write_atomic(self.folder_of(record["id"]) / _FILE, json.dumps(record, indent=1))


def _state(folder: Path) -> list[list[object]]:
    files = (folder / name for name in (STAGE, EDITS))
    stats = [(file.name, file.stat()) for file in files if file.is_file()]
    return [[name, stat.st_size, stat.st_mtime_ns] for name, stat in stats]


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
