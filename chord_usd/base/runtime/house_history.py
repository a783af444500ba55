"""The history of a house on disk: a tree of its states, so that each change can be undone.

.chord-usd.history/house.usda/changes.json   the changes, and the one that the house stands at
                              objects/…      the bytes of its own files, named after their SHA-256

A state is all that belongs to one house alone: its layer, the layer of edits over it, its shell and
its attribution. Meshes and materials have names after their content, and no change takes them away.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import time
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from chord_usd.base.errors import OutputError, StageError
from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.alone import alone_with
from chord_usd.base.runtime.files import deliver, hash_file, link_or_copy
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.scratch import PREFIX as SCRATCH_PREFIX
from chord_usd.base.runtime.targets import MANIFEST_FILE, Manifest, output_error

FORMAT = 1
MOST_CHANGES = 100
"""Of one house; the earliest are forgotten."""

EDITS = ".edits"
OUTSIDE = "outside"
"""The verb of a change that no verb of this program made."""

_FOLDER = ".chord-usd.history"
_INDEX = "changes.json"
_SMALL_BYTES = 8 * 2**20
"""Below this a file is kept packed; a larger one is a link to the file where disks have links."""
_PACKED = ".z"
_PATIENCE_S = 10.0


@dataclass(frozen=True)
class Deed:
    """What is done to a house, as a history lists it."""

    verb: str
    words: str = ""
    """The sentence, room or piece that it is about."""


@dataclass(frozen=True)
class Change:
    """A state of a house, and how it came about."""

    number: int
    """From 1."""
    parent: int | None
    made: str
    """ISO 8601, UTC."""
    verb: str
    words: str
    files: Mapping[str, str] = field(default_factory=dict, repr=False)
    """SHA-256 of each file, by its POSIX path in the folder of the house."""

    @property
    def summary(self) -> str:
        """In one line."""
        return f"{self.verb} {self.words}".strip()


@dataclass(frozen=True)
class History:
    """The changes of a house, the earliest first. Without any, number is 0."""

    changes: tuple[Change, ...] = ()
    number: int = 0
    """Of the change that the house stands at."""
    visited: tuple[int, ...] = ()
    """Numbers in the order of their latest visits: of several that follow, redo takes the last."""

    def change(self, number: int | None) -> Change | None:
        """The change of a number."""
        return next((change for change in self.changes if change.number == number), None)

    @property
    def now(self) -> Change | None:
        """The change that the house stands at."""
        return self.change(self.number)

    @property
    def undone(self) -> Change | None:
        """What redo would do again."""
        after = [change.number for change in self.changes if change.parent == self.number]
        return self.change(max(after, key=self._visit, default=None))

    @property
    def before(self) -> Change | None:
        """Where undo leads."""
        return self.change(self.now.parent) if self.now else None

    def _visit(self, number: int) -> tuple[int, int]:
        return (self.visited.index(number) if number in self.visited else -1), number

    def at(self, number: int) -> History:
        """The same, standing at another change."""
        visited = (*(earlier for earlier in self.visited if earlier != number), number)
        return replace(self, number=number, visited=visited)

    def with_now(self, change: Change) -> History:
        """The same with another change in place of the one that it stands at."""
        changes = (change if old.number == self.number else old for old in self.changes)
        return replace(self, changes=tuple(changes))

    def grown(self, deed: Deed, files: Mapping[str, str]) -> History:
        """The same with one more change; the earliest goes where there are too many."""
        latest = max((change.number for change in self.changes), default=0)
        parent = self.number if self.now else None
        made = Change(latest + 1, parent, _now(), deed.verb, deed.words, files)
        others = [change for change in self.changes if change.number != self.number]
        stays = others[-MOST_CHANGES + 2 :]
        kept = {change.number for change in stays} | {self.number}
        changes = tuple(
            replace(change, parent=change.parent if change.parent in kept else None)
            for change in self.changes
            if change.number in kept
        )
        return replace(self, changes=(*changes, made)).at(made.number)


@contextmanager
def recorded(house: Path, deed: Deed) -> Iterator[None]:
    """Around what changes a house, or replaces it: its state before and after can be had again.

    A house that is not there yet gets no history, so that a new one costs nothing; its first change
    begins one. A block that fails, or changes nothing, leaves no trace. What is recorded within the
    block, by another process too, is part of the same change.
    """
    house = house_of(house)
    if not house.is_file() or any(part.startswith(SCRATCH_PREFIX) for part in house.parts):
        yield
        return
    is_first = not _folder(house).exists()
    before = _state_of(house)
    number = _begin(house).number
    try:
        yield
        after = _state_of(house)
        if after != before:
            _note(house, deed, after, since=number)
    finally:
        if is_first and _state_of(house) == before:
            forget(house)


def amend(house: Path) -> History:
    """Take the house as it lies on disk for the state after its latest change; returns the history.

    For a program that changes the layer of edits because of what this program has just done. A
    house without a history gets none. Raises StageError as read_history does, OutputError.
    """
    house = _there(house)
    with alone_with(house):
        history, files = read_history(house), _state_of(house)
        if history.now is None or history.now.files == files:
            return history
        history = history.with_now(replace(history.now, files=files))
        with _writing(house):
            _keep(house, files)
            _write(house, history)
        return history


def forget(house: Path) -> None:
    """Remove all that is kept of a house; the house itself stays."""
    folder = _folder(house_of(house))
    shutil.rmtree(folder, ignore_errors=True)
    with suppress(OSError):  # rmdir removes no folder with the history of another house
        folder.parent.rmdir()


def read_history(house: Path) -> History:
    """What is kept of a house. Raises StageError for a history of another version."""
    house = house_of(house)
    index = _folder(house) / _INDEX
    try:
        data = json.loads(index.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return History()
    except (OSError, ValueError) as error:
        raise _unreadable(index, "cannot be read") from error
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise _unreadable(index, "was written by another version of chord-usd")
    try:
        changes = tuple(Change(**row) for row in data["changes"])
        _require_own(house, changes)
        return History(changes, int(data["number"]), tuple(data["visited"]))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise _unreadable(index, "is damaged") from error


def undo(house: Path) -> Change:
    """Give a house the state before its latest change; returns the change that is undone.

    A change by another program counts as one. Raises StageError where there is nothing to undo or
    the state is not whole any more, and OutputError while the house is being changed.
    """
    house = _there(house)
    with alone_with(house):
        history = _begin(house)
        if history.before is None or history.now is None:
            raise StageError(
                "has no earlier state that is kept", where=str(house),
                expected="a house that this version of the program changed",
                try_="<history>",
            )  # fmt: skip
        _put_back(house, history, history.before)
        return history.now


def redo(house: Path) -> Change:
    """Do again what was undone last; returns that change. Raises as undo does."""
    house = _there(house)
    with alone_with(house):
        history = _begin(house)
        if history.undone is None:
            raise StageError(
                "has nothing that was undone", where=str(house), expected="a house after undo"
            )
        _put_back(house, history, history.undone)
        return history.undone


def go_to(house: Path, number: int) -> Change:
    """Give a house the state of any change that is kept; returns it. Raises as undo does."""
    house = _there(house)
    with alone_with(house):
        history = _begin(house)
        change = history.change(number)
        if change is None:
            numbers = ", ".join(str(change.number) for change in history.changes)
            raise StageError(
                f"has no change {number}", where=str(house), expected=f"one of {numbers}"
            )
        _put_back(house, history, change)
        return change


def house_of(path: Path) -> Path:
    """The house that a path means: of a layer of edits, the house that it lies over."""
    path = absolute(Path(path))
    below = path.with_name(path.stem.removesuffix(EDITS) + path.suffix)
    return below if path.stem.endswith(EDITS) and below.is_file() else path


def _there(house: Path) -> Path:
    house = house_of(house)
    if not house.is_file():
        raise StageError("there is no such file", where=str(house), expected="a house")
    return house


def _begin(house: Path) -> History:
    """The history up to the house as it lies on disk."""
    history, files = read_history(house), _state_of(house)
    if history.now and history.now.files == files:
        return history
    words = "" if history.changes else "the house as it was"
    verb = OUTSIDE if history.changes else "begin"
    return _note(house, Deed(verb, words), files)


def _note(house: Path, deed: Deed, files: Mapping[str, str], since: int | None = None) -> History:
    """since: number of the change at which this one began."""
    with _writing(house):
        history = read_history(house)
        now = history.now
        if now and now.files == files and now.verb != OUTSIDE:
            return history
        if now and now.files == files:
            # Another process met the house between its change and its note.
            history = history.with_now(replace(now, verb=deed.verb, words=deed.words))
        elif now and since is not None and now.number > since:
            history = history.with_now(replace(now, files=files))
        else:
            history = history.grown(deed, files)
        _keep(house, files)
        _write(house, history)
        return history


@contextmanager
def _writing(house: Path) -> Iterator[None]:
    """Alone with a history, and what fails as an error of the house."""
    try:
        _folder(house).mkdir(parents=True, exist_ok=True)
        with _held(_folder(house)):
            yield
    except OSError as error:
        raise output_error(error, house) from error


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Hold a folder's lock, after waiting for it. A file system without locks holds nothing."""
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    handle, until = os.open(folder, os.O_RDONLY), time.monotonic() + _PATIENCE_S
    try:
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                if time.monotonic() > until:
                    raise OutputError(
                        "is being changed by somebody else", where=str(folder),
                        try_="again in a moment",
                    ) from error  # fmt: skip
                time.sleep(0.05)
                continue
            except OSError:
                pass
            break
        yield
    finally:
        os.close(handle)


# States ------------------------------------------------------------------------------------------


def _own_files(house: Path) -> Iterator[Path]:
    """The files that belong to this house alone."""
    yield house
    yield house.with_name(f"{house.stem}{EDITS}{house.suffix}")
    yield house.with_name(f"{house.stem}_attribution.txt")
    architecture = house.with_name(f"{house.stem}_architecture")
    if architecture.is_dir() and not architecture.is_symlink():
        yield from (path for path in sorted(architecture.rglob("*")) if path.name != MANIFEST_FILE)


def _require_own(house: Path, changes: Iterable[Change]) -> None:
    """Raises ValueError for a history, perhaps a stranger's, that would write to other files."""
    stem = re.escape(house.stem)
    name_pattern = re.compile(
        rf"{stem}({re.escape(EDITS)})?{re.escape(house.suffix)}|{stem}_attribution\.txt"
        rf"|{stem}_architecture(/(?!\.\.?/)[^/\0]+)+"
    )
    for change in changes:
        for name, digest in change.files.items():
            if not name_pattern.fullmatch(name) or not re.fullmatch("[0-9a-f]{64}", digest):
                raise ValueError(name)


def _state_of(house: Path) -> dict[str, str]:
    return {
        path.relative_to(house.parent).as_posix(): hash_file(path)
        for path in _own_files(house)
        if path.is_file() and not path.is_symlink()
    }


def _object(house: Path, digest: str) -> Path:
    return _folder(house) / "objects" / digest if digest else _folder(house) / "objects"


def _keep(house: Path, files: Mapping[str, str]) -> None:
    """Keep the bytes of a state that the house is in."""
    _object(house, "").mkdir(exist_ok=True)
    for name, digest in files.items():
        source, kept = house.parent / name, _object(house, digest)
        packed = kept.with_suffix(_PACKED)
        if kept.exists() or packed.exists():
            continue
        if source.stat().st_size < _SMALL_BYTES:
            _write_whole(packed, zlib.compress(source.read_bytes(), 1))
        else:
            link_or_copy(source, kept)


def _bring(house: Path, digest: str, target: Path) -> None:
    """Write a kept file to target. Raises StageError where it is not whole."""
    kept = _object(house, digest)
    packed = kept.with_suffix(_PACKED)
    try:
        if packed.exists():
            target.write_bytes(zlib.decompress(packed.read_bytes()))
        else:
            shutil.copyfile(kept, target)
        is_whole = hash_file(target) == digest
    except (FileNotFoundError, zlib.error):
        is_whole = False
    if not is_whole:
        raise StageError(
            "an earlier state is not whole any more", where=str(kept),
            expected="the file as it was kept", try_="<history>",
        )  # fmt: skip


def _put_back(house: Path, history: History, change: Change) -> None:
    """Make a house what it was at a change, byte for byte, all of it or nothing."""
    now, home = _state_of(house), house.parent
    manifest = Manifest(home)
    with _writing(house):
        with deliver() as delivery:
            for name, digest in change.files.items():
                if (home / name).parent.is_symlink():
                    raise _unreadable(home / name, "leads through a link")
                if now.get(name) != digest:
                    _bring(house, digest, delivery.place(home / name))
        with interrupts.held():
            for name in now.keys() - change.files.keys():
                (home / name).unlink()
        manifest.note(home / name for name in change.files if manifest.lists(home / name))
        _write(house, history.at(change.number))
    if "pxr.Sdf" in sys.modules:
        from pxr import Sdf

        for layer in filter(None, (Sdf.Layer.Find(str(home / name)) for name in change.files)):
            layer.Reload()


def _folder(house: Path) -> Path:
    return house.parent / _FOLDER / house.name


def _write(house: Path, history: History) -> None:
    data: dict[str, Any] = {"format": FORMAT, **asdict(history)}
    _write_whole(_folder(house) / _INDEX, json.dumps(data, indent=1).encode())
    kept = {digest for change in history.changes for digest in change.files.values()}
    for file in _object(house, "").iterdir():
        if file.stem not in kept:
            file.unlink(missing_ok=True)


def _write_whole(path: Path, data: bytes) -> None:
    """In place of what is there, all of it or nothing; nobody named this file."""
    partial = path.with_name("part.tmp")
    with partial.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def _unreadable(index: Path, what: str) -> StageError:
    return StageError(
        f"the history {what}", where=str(index), expected=f"a history of format {FORMAT}",
        try_="move its folder away: the house itself is whole",
    )  # fmt: skip


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
