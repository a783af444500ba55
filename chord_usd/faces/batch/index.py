"""The index of a batch: one row for each house and each picture, as JSON lines and as Parquet."""

from __future__ import annotations

import json
from collections.abc import Container, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.files import deliver, write_atomic
from chord_usd.faces.batch.failures import failures_in
from chord_usd.faces.batch.make import STAGE_FILE, camera_of
from chord_usd.faces.batch.records import (
    HOUSE_RECORD,
    PICTURES_FOLDER,
    PICTURES_RECORD,
    Record,
    read_record,
)
from chord_usd.faces.batch.shared import SHARED_FOLDERS

INDEX_FILE = "index.jsonl"
PARQUET_FILE = "index.parquet"

FIGURES = (
    "rooms", "furniture", "items", "openings", "m_per_px", "holds", "errors", "collisions",
    "out_of_room", "blocked_openings", "unsupported", "empty_rooms", "walkable", "reachable_rooms",
    "por", "piou", "complete", "right",
)  # fmt: skip
"""Of a house, out of its record."""

_COLUMNS = (
    "kind", "status", "house", "camera", "plan", "seed", "path", "files", "sha256", "why",
)  # fmt: skip
"""Of every row, in this order."""

_MEASURES = ("m_per_px", "walkable", "reachable_rooms", "por", "piou", "complete", "right")
_TEXTS = ("kind", "status", "house", "camera", "plan", "path", "why")
_LISTS = ("files", "sha256")


def rows(folder: Path, names: Container[str] | None = None) -> list[dict[str, Any]]:
    """All rows of a folder of houses, by name; houses that could not be made come last.

    names: of the houses that count; None for all.

    A row has kind (house or picture), status (done or failed), house, camera, plan, seed, path
    (of the stage or the picture), files and sha256 (what it alone is made of, and the hashes),
    why (it failed), and for houses FIGURES. Paths are relative to the folder.
    """
    rows: list[dict[str, Any]] = []
    failed = failures_in(folder)
    for record_file in sorted(folder.glob(f"*/{HOUSE_RECORD}")):
        house = record_file.parent
        record = read_record(record_file)
        if record and house.name not in failed and (names is None or house.name in names):
            rows.append(_house_row(house.name, record))
            rows += _picture_rows(house, record)
    rows += [_failed_row(why) for name, why in failed.items() if names is None or name in names]
    return rows


def write_index(rows: Iterable[Mapping[str, Any]], folder: Path) -> Path:
    """Write the rows as JSON lines. Raises OutputError."""
    path = folder / INDEX_FILE
    write_atomic(path, "".join(json.dumps(row) + "\n" for row in rows), asked=False)
    return path


def write_parquet(rows: list[dict[str, Any]], folder: Path) -> Path:
    """Write the rows as a Parquet table, all columns of it even where they are empty.

    Raises MissingExtraError without pyarrow, OutputError.
    """
    require_parquet()
    import pyarrow
    import pyarrow.parquet

    types = [
        *((name, pyarrow.string()) for name in _TEXTS),
        *((name, pyarrow.list_(pyarrow.string())) for name in _LISTS),
        ("seed", pyarrow.int64()),
        *((name, _figure_type(name)) for name in FIGURES),
    ]
    path = folder / PARQUET_FILE
    with deliver() as delivery:
        table = pyarrow.Table.from_pylist(rows, schema=pyarrow.schema(types))
        pyarrow.parquet.write_table(table, delivery.place(path, asked=False))
    return path


def require_parquet() -> None:
    """Raises MissingExtraError without pyarrow."""
    with needed_for("a Parquet index"):
        import pyarrow  # noqa: F401


def _figure_type(name: str) -> Any:
    import pyarrow

    if name == "holds":
        return pyarrow.bool_()
    return pyarrow.float64() if name in _MEASURES else pyarrow.int64()


def _house_row(name: str, record: Record) -> dict[str, Any]:
    facts = record.told
    shared = tuple(f"{kind}/" for kind in SHARED_FOLDERS)
    files = {k: digest for k, digest in record.files.items() if not k.startswith(shared)}
    return _row(
        kind="house",
        status="done",
        house=name,
        plan=facts["plan"],
        seed=facts["seed"],
        path=f"{name}/{STAGE_FILE}",
        files=[f"{name}/{file}" for file in files],
        sha256=list(files.values()),
        **{key: facts.get(key) for key in FIGURES},
    )


def _picture_rows(house: Path, made: Record) -> Iterator[dict[str, Any]]:
    record = read_record(house / PICTURES_RECORD)
    if record is None:
        return
    cameras: dict[str, dict[str, str]] = {}
    for file, digest in record.files.items():
        cameras.setdefault(camera_of(Path(file)), {})[f"{house.name}/{file}"] = digest
    for camera, files in cameras.items():
        sidecar = f"{house.name}/{PICTURES_FOLDER}/{camera}.json"
        if len(files) == 1:  # coco.json speaks of all cameras
            continue
        yield _row(
            kind="picture",
            status="done",
            house=house.name,
            camera=camera,
            plan=made.told["plan"],
            seed=made.told["seed"],
            path=next((file for file in files if file.endswith(f"/{camera}.png")), sidecar),
            files=list(files),
            sha256=list(files.values()),
        )


def _failed_row(failure: Mapping[str, Any]) -> dict[str, Any]:
    """failure: as failures_in has it."""
    known = {key: failure[key] for key in ("house", "plan", "seed", "why")}
    return _row(kind="house", status="failed", files=[], sha256=[], **known)


def _row(**known: Any) -> dict[str, Any]:
    return {**dict.fromkeys(_COLUMNS), **known}
