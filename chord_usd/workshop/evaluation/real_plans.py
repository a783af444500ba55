"""Files of a folder, read: a sheet of overlays for eyes, a table, and scores where truth is known.

The truth of NAME.png is NAME.json beside it: CHOrD JSON that says where its picture lies, such as
`plan read` writes, put right by hand.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image, ImageDraw

from chord_usd.base.errors import ChordError, PlanError
from chord_usd.base.raster.lettering import text_size, write_text
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.chord_json import read_plan
from chord_usd.base.scene.types import ByteArray, Plan
from chord_usd.workshop.evaluation.plans import Case, PlanScore, Reader, score_reading
from chord_usd.workshop.evaluation.report import framed, markdown_table, picture_png

_PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".gif", ".tif", ".tiff")
SUFFIXES = frozenset((*_PICTURES, ".pdf", ".svg", ".dxf", ".ifc", ".sh3d"))
_TILE_PX = (620, 520)
_CAPTION_PX, _LETTER_PX = 44, 15
_COLUMNS, _TILES_PER_SHEET = 3, 24
_REFUSED_RGB = (210, 20, 30)


@dataclass(frozen=True)
class Eyes:
    """How files are read and shown."""

    read: Callable[[Path], Plan]
    """Raises ChordError."""
    show: Callable[[Plan | None, Path], ByteArray]
    """(H, W, 3) the overlay with its doubts, or the file as it is where none was read."""
    reader: Reader
    """Where plans lie; its read is not called."""


@dataclass(frozen=True, eq=False)
class RealReading:
    """One file, read or refused."""

    name: str
    seconds: float
    plan: Plan | None = None
    refusal: str = ""
    """In one line; of a file that broke the reader, too."""
    score: PlanScore | None = None
    tile: ByteArray | None = None

    @property
    def doubts(self) -> list[str]:
        return (
            [str(warning) for warning in self.plan.extra.get("warnings", ())] if self.plan else []
        )


def real_files(folder: Path) -> list[Path]:
    """The plans in a folder, by name. Raises ChordError for none."""
    files = sorted(p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.is_file())
    if not files:
        raise ChordError(
            "holds no file to read", where=str(folder),
            expected=f"pictures, PDF or vector files ({' '.join(sorted(SUFFIXES))})",
        )  # fmt: skip
    return files


def read_real(files: Sequence[Path], eyes: Eyes, progress: Progress) -> list[RealReading]:
    """Every file, read; one that fails is a row like the others."""
    readings = []
    for number, file in enumerate(files, 1):
        readings.append(_read_one(file, eyes))
        progress(number, len(files))
    return readings


def _read_one(file: Path, eyes: Eyes) -> RealReading:
    start = time.perf_counter()
    plan, refusal = None, ""
    try:
        plan = eyes.read(file)
    except ChordError as error:
        refusal = str(error).removeprefix(f"{file}: ")
    except Exception as error:  # A stranger's file that breaks the reader is a finding, too.
        refusal = f"broke the reader: {type(error).__name__}: {error}"
    reading = RealReading(file.name, time.perf_counter() - start, plan, " ".join(refusal.split()))
    score, problem = _scored(file, plan, eyes.reader)
    reading = replace(reading, score=score, refusal=reading.refusal or problem)
    return replace(reading, tile=_tile(reading, file, eyes))


def _scored(file: Path, plan: Plan | None, reader: Reader) -> tuple[PlanScore | None, str]:
    """Scores against the truth beside a picture, and what keeps it from being scored."""
    beside = file.with_suffix(".json")
    if not beside.is_file():
        return None, ""
    try:
        truth = read_plan(beside)
    except ChordError as error:
        return None, f"truth cannot be read: {' '.join(str(error).split())}"
    frame = reader.frame_of(truth)
    if frame is None:
        return None, "truth does not say where its picture lies ('drawing')"
    if plan is None:
        return PlanScore("real", kinds=len(_known(truth))), ""
    if file.suffix.lower() not in _PICTURES or reader.frame_of(plan) is None:
        return None, "only pictures are compared with a truth in pixels"
    shape = decode("plan picture", file, where=str(file), error=PlanError).rgb.shape
    paper = np.linalg.inv(reader.straightening(truth, shape))
    sheet = np.broadcast_to(np.uint8(255), shape)
    case = Case("real", sheet, (truth,), frame, paper, _known(truth))
    return score_reading(case, replace(reader, read=lambda _: plan)), ""


def _known(truth: Plan) -> frozenset[str]:
    return frozenset(room.id for room in truth.rooms if room.kind != "unknown")


# Sheets ------------------------------------------------------------------------------------------


def _tile(reading: RealReading, file: Path, eyes: Eyes) -> ByteArray:
    """The overlay, or the file, in a tile of one size with its name and figures below."""
    width, height = _TILE_PX
    canvas = np.full((height, width, 3), 255, np.uint8)
    space = height - _CAPTION_PX
    try:
        shown = eyes.show(reading.plan, file)
    except Exception:
        # What cannot be read can often not be shown either; the caption says why.
        shown = np.full((1, 1, 3), 255, np.uint8)
    share = min(width / shown.shape[1], space / shown.shape[0])
    size = max(1, int(shown.shape[1] * share)), max(1, int(shown.shape[0] * share))
    how = cv2.INTER_AREA if share < 1.0 else cv2.INTER_LINEAR
    canvas[: size[1], : size[0]] = cv2.resize(shown, size, interpolation=how)
    picture = Image.fromarray(canvas)
    draw = ImageDraw.Draw(picture)
    color = _REFUSED_RGB if reading.plan is None else (0, 0, 0)
    first = f"{reading.name}  {_scale_text(reading.plan)}  {reading.seconds:.1f} s"
    second = reading.refusal or f"{_counts_text(reading)}, {len(reading.doubts)} doubts"
    for line, text in enumerate((first, second)):
        at = 4.0, space + 4.0 + line * 1.25 * _LETTER_PX
        write_text(draw, at, _cut(text, width - 8), _LETTER_PX, color, "la")
    return framed(np.asarray(picture))


def _cut(text: str, width_px: float) -> str:
    if text_size(text, _LETTER_PX)[0] <= width_px:
        return text
    while text and text_size(f"{text}…", _LETTER_PX)[0] > width_px:
        text = text[:-1]
    return f"{text}…"


def sheets(readings: Sequence[RealReading]) -> dict[str, bytes]:
    """Contact sheets as PNG, by what is added to the report's name: "", "2", "3" ..."""
    pictures: dict[str, bytes] = {}
    for first in range(0, len(readings), _TILES_PER_SHEET):
        tiles = [r.tile for r in readings[first : first + _TILES_PER_SHEET] if r.tile is not None]
        blank = np.full_like(tiles[0], 255)
        tiles += [blank] * (-len(tiles) % min(_COLUMNS, len(readings)))
        columns = min(_COLUMNS, len(tiles))
        rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
        number = first // _TILES_PER_SHEET + 1
        pictures["" if number == 1 else str(number)] = picture_png(np.vstack(rows))
    return pictures


# Report ------------------------------------------------------------------------------------------


def _counts(reading: RealReading) -> dict[str, int]:
    openings = [o.kind for o in reading.plan.openings] if reading.plan else []
    rooms = len(reading.plan.rooms) if reading.plan else 0
    doors = openings.count("door") + openings.count("passage")
    return {"rooms": rooms, "doors": doors, "windows": openings.count("window")}


def _counts_text(reading: RealReading) -> str:
    return ", ".join(f"{count} {name}" for name, count in _counts(reading).items())


def _scale_text(plan: Plan | None) -> str:
    said = plan.extra.get("scale", {}) if plan else {}
    return f"{said['mPerPx']:.4g} ({said['witness']})" if "witness" in said else ""


def as_rows(readings: Sequence[RealReading]) -> list[dict[str, Any]]:
    """For JSON: one row per file."""
    return [
        {
            "file": r.name, **_counts(r), "scale": r.plan.extra.get("scale") if r.plan else None,
            "doubts": r.doubts, "seconds": round(r.seconds, 2), "refusal": r.refusal,
            "score": asdict(r.score) if r.score else None,
        }
        for r in readings
    ]  # fmt: skip


def as_markdown(readings: Sequence[RealReading], pictures: Sequence[str] = ()) -> str:
    """The table, with the sheets below it. pictures: names of their files."""
    head = ["file", "rooms", "doors", "windows", "m per px (witness)", "seconds",
            "wall F1", "opening F1", "room IoU", "doubts or refusal"]  # fmt: skip
    table = markdown_table(head, [_row(reading) for reading in readings])
    read = sum(reading.plan is not None for reading in readings)
    sure = sum(reading.plan is not None and not reading.doubts for reading in readings)
    summary = f"{len(readings)} files: {read} read, {sure} of them without a doubt.\n\n"
    return summary + table + "".join(f"\n![overlays]({name})\n" for name in pictures)


def _row(reading: RealReading) -> list[str]:
    score = reading.score
    parts = (score.walls, score.openings, score.room_iou) if score else ()
    scored = [f"{part:.3f}" for part in parts] or ["", "", ""]
    counts = [str(n) if reading.plan else "" for n in _counts(reading).values()]
    doubts = "; ".join([*([reading.refusal] if reading.refusal else []), *reading.doubts])
    cells = [reading.name, *counts, _scale_text(reading.plan), f"{reading.seconds:.1f}", *scored]
    return [cell.replace("|", "\\|") for cell in (*cells, doubts)]


def sheet_names(report: Path, pictures: Mapping[str, bytes]) -> list[str]:
    """The files that write_report gives the pictures."""
    return [f"{report.stem}{f'_{name}' if name else ''}.png" for name in pictures]
