"""Vector files as plans, each read in a process of its own."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from shapely import affinity

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.scene.json_stairs import stair_to_json
from chord_usd.base.scene.stair_places import StairShape, placed_stair, with_stairwell
from chord_usd.base.scene.storeys import STAIRS, STOREY_M
from chord_usd.base.scene.types import Plan
from chord_usd.base.terms import with_step
from chord_usd.line.plan.placement import WARNINGS
from chord_usd.line.plan.scale_choice import SCALE
from chord_usd.line.plan.vector import READERS, is_svg
from chord_usd.line.plan.vector.assemble import assemble
from chord_usd.line.plan.vector.shapes import VectorDrawing, refuse_absurd

Reader = Callable[[Path], list[VectorDrawing]]

_LEAST_STOREY = 0.2
"""Share of the largest storey's floor that another one has; a roof's or a cellar's may be less."""


def read_drawings(path: Path) -> list[VectorDrawing]:
    """The storeys or sheets in a vector file. Raises PlanError, and MissingExtraError.

    To be called in a confined process, as read_vector and backdrop do.
    """
    module, function = READERS[path.suffix.lower()]
    try:
        if path.stat().st_size == 0:
            raise PlanError("is empty", where=str(path), expected=f"a {path.suffix.lower()} file")
        read: Reader = getattr(
            importlib.import_module(f"chord_usd.line.plan.vector.{module}"), function
        )  # fmt: skip
        drawings = read(path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise PlanError(f"cannot be read ({reason})", where=str(path)) from error
    for drawing in drawings:
        refuse_absurd(drawing, path)
    return drawings


def read_vector(path: Path, m_per_unit: float | None = None, part: int = 1) -> Plan | None:
    """The plan in a vector file, read in a process of its own; None of an SVG that names none.

    m_per_unit overrides the file's own units; part: which storey, the one with most rooms that
    doors lead into being 1. Raises PlanError.
    """
    plan: Plan = decode("vector plan", path, m_per_unit, part, where=str(path), error=PlanError)
    return plan


def _read_plan(path: Path, m_per_unit: float | None, part: int) -> Plan | None:
    drawings = read_drawings(path)
    plans, reasons = [], []
    for drawing in drawings:
        try:
            plans.append((assemble(drawing, str(path), m_per_unit), drawing.name))
        except PlanError as error:
            reasons.append(error)
    if not plans:
        _refuse_nothing(path, reasons)
        return None
    plans.sort(key=lambda row: _homeliness(row[0]), reverse=True)
    if part > len(plans):
        holds = "one storey" if len(plans) == 1 else f"{len(plans)} storeys"
        raise PlanError(
            f"part {part} was asked for, but the file holds {holds} with rooms", where=str(path),
            expected="no <part>" if len(plans) == 1 else f"<part> from 1 to {len(plans)}",
        )  # fmt: skip
    plan, name = plans[part - 1]
    if len(plans) == 1:
        return plan
    called = f" ({name})" if name else ""
    warning = (
        f"the file holds {len(plans)} storeys; number {part} by rooms with doors{called} was taken"
    )
    extra = {
        **plan.extra,
        WARNINGS: [with_step(warning, ", <part> takes another"), *_warnings_in(plan)],
    }
    return Plan(plan.rooms, plan.openings, extra)


def _refuse_nothing(path: Path, reasons: Sequence[PlanError]) -> None:
    """Raises PlanError for a file that holds no plan, but not for an SVG: it has looks, too."""
    if is_svg(path):
        return
    if reasons:
        raise reasons[0]
    raise PlanError("has no storey with rooms that doors lead into", where=str(path))


def read_vector_storeys(path: Path, m_per_unit: float | None = None) -> list[tuple[Plan, str]]:
    """The storeys of a vector file that rooms with doors are on, and their names, the lowest first;
    none of an SVG that names none.

    Where they lie on each other is as in the file. Raises PlanError.
    """
    plans: list[tuple[Plan, str]] = decode(
        "vector storeys", path, m_per_unit, where=str(path), error=PlanError
    )
    return plans


def _read_storeys(path: Path, m_per_unit: float | None) -> list[tuple[Plan, str]]:
    drawings, reasons = [], []
    for drawing in read_drawings(path):
        try:
            drawings.append((drawing.elevation, assemble(drawing, str(path), m_per_unit), drawing))
        except PlanError as error:
            reasons.append(error)
    most = max((_floor_m2(plan) for _, plan, _ in drawings), default=0.0)
    homes = [
        row for row in drawings
        if _homeliness(row[1])[0] and _floor_m2(row[1]) >= _LEAST_STOREY * most
    ]  # fmt: skip
    if not homes:
        _refuse_nothing(path, reasons)
        return []
    homes.sort(key=lambda row: row[0])
    plans = [plan for _, plan, _ in homes]
    for index, (_, plan, drawing) in enumerate(homes[:-1]):
        scale = m_per_unit or drawing.m_per_unit or plan.extra[SCALE]["mPerPx"]
        plans[index] = _with_stairs(plan, drawing.stairs, scale, plans[index + 1])
    return [(plan, drawing.name) for plan, (_, _, drawing) in zip(plans, homes, strict=True)]


def _with_stairs(plan: Plan, shapes: Sequence[StairShape], m_per_unit: float, above: Plan) -> Plan:
    """The plan with the stairs that can be built to rule, and a warning for each other stair."""
    stairs, refused = [], []
    for number, shape in enumerate(shapes, start=1):
        area = affinity.scale(shape.area, m_per_unit, m_per_unit, origin=(0, 0))
        ends = shape.ends and (shape.ends[0] * m_per_unit, shape.ends[1] * m_per_unit)
        scaled = replace(shape, area=area, ends=ends)
        stair = placed_stair(scaled, f"stair{number}", plan, above, STOREY_M)
        if stair is None:  # the file may have a void there, and no space
            wider = with_stairwell(plan, area, f"stairwell{number}")
            stair = placed_stair(scaled, f"stair{number}", wider, above, STOREY_M)
            plan = wider if stair is not None else plan
        if stair is None:
            refused.append(
                f"stair {number} of the file is left out: none to rule joins two rooms there"
            )
        else:
            stairs.append(stair_to_json(stair))
    if not shapes:
        return plan
    warnings = {WARNINGS: [*_warnings_in(plan), *refused]} if refused else {}
    return replace(plan, extra={**plan.extra, **warnings, **({STAIRS: stairs} if stairs else {})})


def _homeliness(plan: Plan) -> tuple[int, float]:
    """Rooms that doors lead into, and floor area: a roof has more floor than a storey, no doors."""
    doors = [opening for opening in plan.openings if opening.kind != "window"]
    entered = {room_id for door in doors for room_id in door.room_ids}
    return len(entered), _floor_m2(plan)


def _warnings_in(plan: Plan) -> list[str]:
    return list(plan.extra.get(WARNINGS, ()))


def _floor_m2(plan: Plan) -> float:
    from chord_usd.base.scene.geometry import room_polygon

    return float(sum(room_polygon(room).area for room in plan.rooms))
