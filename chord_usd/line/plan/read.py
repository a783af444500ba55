"""Plan file -> Plan: CHOrD JSON, vector files, a plan raster, or any other drawing of a plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.errors import PlanError
from chord_usd.base.metrics.walk import walk
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.scene import palette
from chord_usd.base.scene.geometry import extent_m
from chord_usd.base.scene.limits import LARGEST_HOUSE_M
from chord_usd.base.scene.room_names import room_kinds
from chord_usd.base.scene.storeys import StoreyPlan
from chord_usd.base.scene.types import ByteArray, Plan, PlanImage
from chord_usd.base.scene.wet_rooms import with_wet_kinds
from chord_usd.base.terms import with_step
from chord_usd.line.plan.decode import decode_plan
from chord_usd.line.plan.openings import is_guessed
from chord_usd.line.plan.picture import read_picture
from chord_usd.line.plan.placement import PAGE, WARNINGS
from chord_usd.line.plan.vector import is_svg, is_vector
from chord_usd.line.plan.verdict import judged, refuse_unsure

if TYPE_CHECKING:
    from chord_usd.line.plan.vector.pdf import PdfPage

_PALETTE_SHARE = 0.99
"""A picture of which so much is in the palette's plan colours is a plan raster."""

_LARGEST_RASTER_PX = 3000
"""Two hundred metres at the coarsest scale that we draw."""

_WIDEST_DOORS_M = 5.0
"""Half of the doors of a plan are narrower; a garage door is 2.4 to 5 m wide."""

_COLOR_SLACK = 3
_SAMPLES = 50_000


def read_plan_file(
    path: Path, scale: float | None = None, part: int = 1, *, is_open: bool = False
) -> Plan:
    """The plan in a file: CHOrD JSON, SVG, DXF, IFC, Sweet Home 3D, PDF, or any kind of picture.

    scale: metres per pixel of a picture, or per unit of a vector file; None takes it from the file,
    from what is printed, from doors or from walls. part: which plan of a sheet or which storey, the
    largest being 1. is_open: whether it shows outer walls alone, whose rooms are planned later.
    What is worth knowing, such as that no doors were found, is listed in
    extra["warnings"]; extra["verdict"] says whether what is not CHOrD JSON is probably read right.
    Raises PlanError.
    """
    refuse_odd_file(path, PlanError)
    plan = _read(path, scale, part, is_open)
    across_m = extent_m(plan.rooms)
    if across_m > LARGEST_HOUSE_M:
        raise PlanError(
            f"the house would be {across_m:,.0f} m across",
            where=str(path),
            expected=f"at most {LARGEST_HOUSE_M:.0f} m",
            try_="a smaller <m_per_px>, if that is not what it is",
        )
    warnings = _warnings(plan)
    plan = replace(plan, extra={**plan.extra, WARNINGS: warnings}) if warnings else plan
    if _is_json(path):
        return plan
    _refuse_giants(plan, path)
    try:
        refuse_unsure(plan)
    except PlanError as error:
        raise _at(path, error) from error
    return judged(with_wet_kinds(plan))


def _refuse_giants(plan: Plan, path: Path) -> None:
    """Raises PlanError for a scale at which nobody lives: halls take minutes to furnish."""
    doors = [opening.box.size_m[0] for opening in plan.openings if opening.kind == "door"]
    usual_m = float(np.median(doors)) if doors else 0.0
    if usual_m > _WIDEST_DOORS_M:
        raise PlanError(
            f"its doors would be {usual_m:.1f} m wide",
            where=str(path),
            expected=f"at most {_WIDEST_DOORS_M:g} m",
            try_="a smaller <m_per_px>",
        )


def read_storey_plans(path: Path, scale: float | None = None) -> list[StoreyPlan]:
    """All storeys that a file shows, the lowest first: of a sheet by their titles, of a vector file
    by their heights, of CHOrD JSON the one. Raises PlanError."""
    refuse_odd_file(path, PlanError)
    if is_vector(path):
        from chord_usd.line.plan.vector.formats import read_vector_storeys

        plans = read_vector_storeys(path, scale)
        if is_svg(path) and not any(plan.openings for plan, _ in plans):
            return [StoreyPlan(read_plan_file(path, scale))]
        return [StoreyPlan(with_wet_kinds(plan), name, (0.0, 0.0) if index else None)
                for index, (plan, name) in enumerate(plans)]  # fmt: skip
    if path.suffix.lower() == ".pdf" or _is_json(path):
        return [StoreyPlan(read_plan_file(path, scale))]
    picture = read_picture(path)
    if picture.frame is not None or is_plan_raster(picture.rgb):
        return [StoreyPlan(read_plan_file(path, scale))]
    from chord_usd.line.plan.drawing import read_sheet

    try:
        sheet_plans = read_sheet(picture.rgb, scale)
    except PlanError as error:
        raise _at(path, error) from error
    return [StoreyPlan(with_wet_kinds(plan), title) for plan, title in sheet_plans]


def _read(path: Path, scale: float | None, part: int, is_open: bool) -> Plan:
    if path.suffix.lower() == ".pdf":
        return _plan_of_pdf(path, scale, part, is_open)
    if is_vector(path):
        from chord_usd.line.plan.vector.formats import read_vector

        named = read_vector(path, scale, part)
        return (
            named
            if named and (named.openings or not is_svg(path))
            else _plan_of_looks(path, scale, part, named, is_open)
        )
    if not _is_json(path):
        return _plan_of_picture(path, scale, part, is_open)
    from chord_usd.base.scene.chord_json import read_plan

    return read_plan(path)


def _is_json(path: Path) -> bool:
    if path.suffix.lower() == ".json":
        return True
    try:
        with path.open("rb") as file:
            return file.read(64).lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise PlanError(f"cannot be read ({reason})", where=str(path)) from error


def _plan_of_picture(path: Path, scale: float | None, part: int, is_open: bool) -> Plan:
    picture = read_picture(path)
    try:
        if picture.frame is not None:
            plan = decode_plan(PlanImage(picture.rgb, picture.frame), scale)
        elif is_plan_raster(picture.rgb):
            plan = decode_plan(picture.rgb, scale)
        else:
            from chord_usd.line.plan.drawing import Known, read_drawing

            plan = read_drawing(picture.rgb, scale, part, Known(is_open=is_open))
    except PlanError as error:
        raise _at(path, error) from error
    return plan


def _plan_of_looks(
    path: Path, scale: float | None, part: int, named: Plan | None, is_open: bool
) -> Plan:
    """The plan of an SVG that names no openings, by its looks, or else the one that it names."""
    from chord_usd.line.plan.drawing import Known, read_drawing
    from chord_usd.line.plan.scale_choice import SCALE, per_unit
    from chord_usd.line.plan.vector.svg_page import read_page

    try:
        page = read_page(path)
        known = Known((), page.stated_m_per_px, page.paper_m_per_px, is_open)
        plan = read_drawing(page.rgb, scale and scale * page.units_per_px, part, known)
    except PlanError as error:
        if named:
            return named
        warning = f"names neither walls nor rooms that close, and by its looks {error.what}"
        raise PlanError(
            warning, where=str(path), expected=error.expected, try_=error.try_
        ) from error
    if named and not plan.openings:
        return named
    missing = "doors or windows" if named else "walls or rooms"
    warning = f"the SVG names no {missing}: it was read by its looks"
    scales = per_unit(plan.extra[SCALE], page.units_per_px)
    return replace(
        plan, extra={**plan.extra, SCALE: scales, WARNINGS: [warning, *_warnings_in(plan)]}
    )


def _plan_of_pdf(path: Path, scale: float | None, part: int, is_open: bool) -> Plan:
    """The plan on the first page that shows one."""
    from chord_usd.line.plan.drawing import Known, read_drawing

    first: PlanError | None = None
    for page in _pages(path):
        try:
            known = Known(page.texts, page.stated_m_per_px, page.paper_m_per_px, is_open)
            plan = read_drawing(page.rgb, scale, part, known)
        except PlanError as error:
            first = first or error
            continue
        if page.count == 1:
            return plan
        warning = f"the file has {page.count} pages; page {page.number} was read"
        return replace(
            plan, extra={**plan.extra, PAGE: page.number, WARNINGS: [warning, *_warnings_in(plan)]}
        )
    raise _at(path, first or PlanError("has no pages"))


def _pages(path: Path) -> Iterator[PdfPage]:
    from chord_usd.line.plan.vector.pdf import read_pages

    try:
        yield from read_pages(path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise PlanError(f"cannot be read ({reason})", where=str(path)) from error


def _at(path: Path, error: PlanError) -> PlanError:
    """The error with the file it is about."""
    return PlanError(error.what, where=str(path), expected=error.expected, try_=error.try_)


def is_plan_raster(rgb: ByteArray) -> bool:
    """Whether a picture (H, W, 3) holds the palette's plan colours only, walls and openings too.

    A black and white drawing does not: its doors and windows are lines.
    """
    if max(rgb.shape) > _LARGEST_RASTER_PX:
        return False
    colors = np.array(
        [*palette.ROOM_SHADES.values(), *(row.rgb for row in palette.PLAN_CATEGORIES)]
    )
    step = max(1, round((rgb.size / 3 / _SAMPLES) ** 0.5))
    sample = rgb[::step, ::step].reshape(-1, 1, 3).astype(np.int16)
    known = np.abs(sample - colors).max(axis=2).min(axis=1) <= _COLOR_SLACK
    is_wall = (np.abs(sample[:, 0] - palette.category("wall").rgb) <= _COLOR_SLACK).all(axis=1)
    if known.mean() < _PALETTE_SHARE or not is_wall.any():
        return False
    openings = [palette.category(name).rgb for name in ("door", "window")]
    return any((rgb == np.array(color)).all(axis=2).any() for color in openings)


def _warnings_in(plan: Plan) -> list[str]:
    return list(plan.extra.get(WARNINGS, ()))


def _warnings(plan: Plan) -> list[str]:
    warnings = _warnings_in(plan)
    kinds = [opening.kind for opening in plan.openings if not is_guessed(opening)]
    if "door" not in kinds and "passage" not in kinds:
        warnings.append("no doors were found: rooms cannot be entered")
    elif "door" in kinds and len(plan.rooms) > 1:
        named = " ".join(warnings)
        shut = [room for room in walk(plan.scene()).doorless if room not in named]
        if shut:
            warnings.append(f"no way leads into {', '.join(shut)}: a door may be missing")
    return list(dict.fromkeys([*warnings, *_kitchens_missed(plan)]))


def _kitchens_missed(plan: Plan) -> list[str]:
    """Of a home whose only kitchen is in the name of a room of another kind."""
    named = [(n, r) for n, r in enumerate(plan.rooms, 1) if "kitchen" in room_kinds(r.name)]
    if not named or any(room.kind == "kitchen" for room in plan.rooms):
        return []
    number, room = named[0]
    return [
        with_step(
            f"{room.id} is named '{room.name}', but no part of it is a kitchen",
            f': <rooms="{number}: {room.kind} / kitchen"> parts it',
        )
    ]
