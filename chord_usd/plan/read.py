"""Plan file -> Plan: CHOrD JSON, a plan raster, or any other drawing of a floor plan."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from chord_usd import palette
from chord_usd.chord_json import read_plan
from chord_usd.errors import PlanError
from chord_usd.plan.decode import decode_plan
from chord_usd.plan.drawing import read_drawing
from chord_usd.plan.picture import read_picture
from chord_usd.plan.placement import WARNINGS
from chord_usd.plan.vector.formats import is_vector, read_vector
from chord_usd.types import ByteArray, Plan, PlanImage

_PALETTE_SHARE = 0.99
"""A picture of which so much is in the palette's plan colours is a plan raster."""

_COLOR_SLACK = 3
_SAMPLES = 50_000


def read_plan_file(path: Path, scale: float | None = None, part: int = 1) -> Plan:
    """The plan in a file: CHOrD JSON or a picture of whatever kind.

    scale: metres per pixel of a picture; None takes it from the picture's own text, its doors or
    its walls. What is worth knowing, such as that no doors were found, is listed in
    extra["warnings"]. Raises PlanError.
    """
    if path.is_dir():
        raise PlanError("is a folder", where=str(path), expected="a plan: a picture or CHOrD JSON")
    plan = _read(path, scale, part)
    warnings = _warnings(plan)
    return replace(plan, extra={**plan.extra, WARNINGS: warnings}) if warnings else plan


def _read(path: Path, scale: float | None, part: int) -> Plan:
    if is_vector(path):
        return read_vector(path, scale, part)
    return read_plan(path) if _is_json(path) else _plan_of_picture(path, scale, part)


def _is_json(path: Path) -> bool:
    if path.suffix.lower() == ".json":
        return True
    try:
        with path.open("rb") as file:
            return file.read(64).lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise PlanError(f"cannot be read ({reason})", where=str(path)) from error


def _plan_of_picture(path: Path, scale: float | None, part: int) -> Plan:
    picture = read_picture(path)
    try:
        if picture.frame is not None:
            plan = decode_plan(PlanImage(picture.rgb, picture.frame), scale)
        elif is_plan_raster(picture.rgb):
            plan = decode_plan(picture.rgb, scale)
        else:
            plan = read_drawing(picture.rgb, scale, part)
    except PlanError as error:
        raise PlanError(
            error.what, where=str(path), expected=error.expected, try_=error.try_
        ) from error
    return plan


def is_plan_raster(rgb: ByteArray) -> bool:
    """Whether a picture (H, W, 3) holds the palette's plan colours only, doors or windows too.

    A black and white drawing does not: its doors and windows are lines.
    """
    colors = np.array(
        [*palette.ROOM_SHADES.values(), *(row.rgb for row in palette.PLAN_CATEGORIES)]
    )
    step = max(1, round((rgb.size / 3 / _SAMPLES) ** 0.5))
    sample = rgb[::step, ::step].reshape(-1, 1, 3).astype(np.int16)
    known = np.abs(sample - colors).max(axis=2).min(axis=1) <= _COLOR_SLACK
    openings = [palette.category(name).rgb for name in ("door", "window")]
    has_openings = any((rgb == np.array(color)).all(axis=2).any() for color in openings)
    return has_openings and bool(known.mean() >= _PALETTE_SHARE)


def _warnings(plan: Plan) -> list[str]:
    warnings = list(plan.extra.get(WARNINGS, ()))
    kinds = [opening.kind for opening in plan.openings]
    if "door" not in kinds and "passage" not in kinds:
        warnings.append("no doors were found: rooms cannot be entered")
    joined = {room_id for opening in plan.openings for room_id in opening.room_ids}
    if "door" in kinds and len(plan.rooms) > 1:
        shut = [room.id for room in plan.rooms if room.id not in joined]
        if shut:
            warnings.append(f"no opening leads into {', '.join(shut)}")
    return list(dict.fromkeys(warnings))
