"""What every vector format is read into before it becomes a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from shapely.geometry import Polygon

from chord_usd.types import FloatArray, OpeningKind


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
    notes: Sequence[str] = ()
    """What a user should know of the reading."""
    extra: Mapping[str, object] = field(default_factory=dict)
