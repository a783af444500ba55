"""What every vector format is read into before it becomes a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from shapely import get_coordinates
from shapely.geometry import Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.stair_places import StairShape
from chord_usd.base.scene.types import FloatArray, OpeningKind

MOST_SHAPES = 20_000
"""Walls, rooms, openings and labels of one file: twenty times as many as a large office has."""

FARTHEST = 1e12
"""From the origin, in units of the file: a map's coordinates in millimetres reach 1e10."""


@dataclass(frozen=True, eq=False)
class RoomShape:
    """A room as the file has it; it may reach into its walls."""

    polygon: Polygon
    name: str = ""


@dataclass(frozen=True, eq=False)
class OpeningShape:
    """A door or window, as a straight stretch of wall."""

    kind: OpeningKind
    start: FloatArray
    """(2,) one jamb, in the middle of the wall."""
    stop: FloatArray
    """(2,) the other jamb."""
    depth: float | None = None
    """Across the wall; None takes that of the wall it lies in."""
    base: float | None = None
    height: float | None = None


@dataclass(frozen=True, eq=False)
class Label:
    """Something written."""

    text: str
    point: FloatArray


@dataclass(frozen=True, eq=False)
class PieceShape:
    """A piece of furniture, or a fixture."""

    category: str
    center: FloatArray
    """(2,)."""
    length: float
    depth: float
    yaw_deg: float


@dataclass(frozen=True, eq=False)
class VectorDrawing:
    """One storey or sheet. All lengths in units of the file, y up."""

    rooms: Sequence[RoomShape] = ()
    walls: Sequence[Polygon] = ()
    openings: Sequence[OpeningShape] = ()
    labels: Sequence[Label] = ()
    m_per_unit: float | None = None
    """None where the file does not say."""
    name: str = ""
    """Of the storey."""
    stairs: Sequence[StairShape] = ()
    elevation: float = 0.0
    """Of the storey; it orders the storeys."""
    notes: Sequence[str] = ()
    """What a user should know of the reading."""
    paper_m_per_unit: float | None = None
    """On a sheet of paper, drawn at a scale that the file does not say."""
    extra: Mapping[str, object] = field(default_factory=dict)
    pieces: Sequence[PieceShape] = ()


def refuse_absurd(drawing: VectorDrawing, where: Path) -> None:
    """Raises PlanError for a drawing with too many shapes to compute with, or with numbers that are
    none.
    """
    polygons = [*(room.polygon for room in drawing.rooms), *drawing.walls]
    if len(polygons) + len(drawing.openings) + len(drawing.labels) > MOST_SHAPES:
        raise too_many_shapes(where)
    points = [
        *(label.point for label in drawing.labels),
        *(end for opening in drawing.openings for end in (opening.start, opening.stop)),
        *(get_coordinates(polygon) for polygon in polygons),
    ]
    sizes = [size for o in drawing.openings for size in (o.depth, o.base, o.height) if size]
    reach = np.abs(np.concatenate([*(np.ravel(point) for point in points), np.array(sizes), [0.0]]))
    if not (reach <= FARTHEST).all():
        raise PlanError(
            "has coordinates that are no numbers, or too large", where=str(where),
            expected=f"at most {FARTHEST:g} units from its origin",
        )  # fmt: skip


def too_many_shapes(where: Path) -> PlanError:
    """The error for a file with more than MOST_SHAPES."""
    return PlanError(
        f"has more than {MOST_SHAPES:,} walls, rooms and openings", where=str(where),
        expected="a floor plan", try_="one storey, or export it as PNG",
    )  # fmt: skip
