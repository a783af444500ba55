"""Walls moved to where printed sizes put them: one least-squares fit of all rooms together.

Coordinates of walls along an axis are knots of a map of that axis onto itself. The map keeps what
was seen, walls as thick as they are drawn, and sizes as they are printed, each as heavy as it is
precise. Because all rooms and openings go through the same map, walls stay straight and joined.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Point, Polygon

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.plan.chains import chain_lengths
from chord_usd.line.plan.measures import Measure, distinct, parse_measure
from chord_usd.line.plan.printed import HOME_M2
from chord_usd.line.plan.room_sizes import rectangles_in
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.wall_openings import WallOpening

_FITS = 0.04
"""A size that is printed and one that was read are the same within this share."""
_CHAIN_FITS = 0.03
"""So are a length of a chain and the distance between the walls at its ends."""
_MISFIT = 0.08
"""A printed size that is off by more than this share is a doubt."""
_WALL = 1.6
"""Two faces bound one wall if no farther apart than so many usual walls are thick."""
_SEEN_PX, _SEEN_SHARE, _WALL_PX = 0.5, 0.02, 0.1
"""Standard deviation of distances as seen, and of the thickness of walls."""
_PRINTED_PX, _PRINTED_SHARE = 0.5, 0.004
"""...and of those that are printed."""
_ROUNDS = 8
"""Of the fit, in which measures that contradict the others lose their weight."""
_PROPORTION = math.log(1.3)
"""Rectangles farther from a size's proportions are not it."""
_LEFT_SHARE, _LEFT_PX = 0.02, 1.5
"""A size that is off by more after the fit contradicts others."""
_LEAST_REFINED = 3
"""Sizes, areas and lengths from which on they say the scale together."""


@dataclass(frozen=True)
class Misfit:
    """A printed size that does not fit what was read there."""

    text: str
    at_px: tuple[float, float]
    read_m: tuple[float, ...]
    """The nearest size, area or length that was read."""
    kind: str
    """Size, area or length."""


@dataclass(frozen=True)
class _Span:
    """The distance between two walls along an axis, as it is printed."""

    axis: int
    low: float
    high: float
    """Where the walls are seen."""
    length_px: float
    """As it is printed, at the scale."""
    sigma_px: float
    source: int
    """Which printed measure says so."""

    @property
    def off(self) -> float:
        """Logarithm of the printed length over that seen."""
        return math.log(self.length_px / (self.high - self.low))


@dataclass(frozen=True, eq=False)
class Fit:
    """Where walls are moved to."""

    m_per_px: float
    polygons_px: list[FloatArray]
    openings: list[WallOpening]
    misfits: tuple[Misfit, ...]
    printed: int
    """How many sizes and areas are printed in the rooms."""


def fit(
    polygons_px: Sequence[FloatArray],
    openings: Sequence[WallOpening],
    texts: Sequence[Text],
    m_per_px: float,
    thickness_px: float,
    moves: bool = True,
) -> Fit:
    """The rooms and openings with walls where printed sizes put them, and sizes that do not fit.

    polygons_px: (N, 2) each. m_per_px: as printed measures say it. moves: whether so many say it
    that walls follow them.
    """
    knots = [_knots(polygons_px, axis) for axis in (0, 1)]
    printed = _printed(polygons_px, texts)
    spans, misfits = _spans_at(polygons_px, printed, texts, knots, m_per_px)
    if len({span.source for span in spans}) >= _LEAST_REFINED:
        # What all sizes say alike is the scale, and moves no wall.
        m_per_px *= math.exp(float(np.median([span.off for span in spans])))
        spans, misfits = _spans_at(polygons_px, printed, texts, knots, m_per_px)
    spans = spans if moves else []
    maps = [
        _moved(knots[axis], [s for s in spans if s.axis == axis], thickness_px) for axis in (0, 1)
    ]
    sizes = {n for n, size in enumerate(printed) if size.measure.kind == "size"}
    left = {s.source for s in spans if s.source in sizes and _is_left(s, knots, maps)}
    misfits += [_misfit(printed[n], polygons_px, m_per_px) for n in sorted(left)]

    def at(points: FloatArray) -> FloatArray:
        return np.stack([_mapped(points[..., a], knots[a], maps[a]) for a in (0, 1)], axis=-1)

    polygons = [at(polygon) for polygon in polygons_px]
    if not all(Polygon(polygon).is_valid for polygon in polygons):
        return Fit(m_per_px, list(polygons_px), list(openings), tuple(misfits), len(printed))
    moved = [replace(opening, center_px=at(opening.center_px)) for opening in openings]
    return Fit(m_per_px, polygons, moved, tuple(misfits), len(printed))


# What is printed ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Printed:
    """A size or an area printed in a room."""

    room: int
    measure: Measure
    text: Text
    sizes: int
    """How many are printed in that room."""

    @property
    def is_alone(self) -> bool:
        """Whether no other one is."""
        return self.sizes == 1


def _printed(polygons_px: Sequence[FloatArray], texts: Sequence[Text]) -> list[_Printed]:
    """Sizes of rooms, and areas of those without a size."""
    result: list[_Printed] = []
    for index, floor in enumerate(map(Polygon, polygons_px)):
        said: dict[Measure, Text] = {}
        for text in texts:
            measure = parse_measure(text.text)
            if measure and measure.kind != "length" and floor.contains(Point(*text.center_px)):
                said.setdefault(measure, text)
        kept = distinct(list(said))
        kept = [measure for measure in kept if measure.kind == "size"] or kept
        result += [_Printed(index, each, said[each], len(kept)) for each in kept]
    areas = [size for size in result if size.measure.kind == "area"]
    if len(areas) == 1 and areas[0].measure.values[0] >= HOME_M2:
        result.remove(areas[0])  # of the home
    return result


def _spans_at(
    polygons_px: Sequence[FloatArray],
    printed: Sequence[_Printed],
    texts: Sequence[Text],
    knots: Sequence[FloatArray],
    m_per_px: float,
) -> tuple[list[_Span], list[Misfit]]:
    """What sizes, areas and chains say at a scale, and those that nothing there fits."""
    spans, misfits = _spans_of_rooms(polygons_px, printed, m_per_px)
    return spans + _spans_of_chains(texts, knots, m_per_px, len(printed)), misfits


def _rectangle(
    size: _Printed, floor: Polygon, m_per_px: float
) -> tuple[tuple[float, float, float, float], tuple[tuple[float, float], ...]] | None:
    """The rectangle of a room whose sides come nearest to a size, and (printed, seen) of both axes;
    None where none is near."""
    best = _nearest(size, floor, m_per_px)
    return best[1:] if best is not None and best[0] < _FITS else None


def _nearest(
    size: _Printed, floor: Polygon, m_per_px: float
) -> tuple[float, tuple[float, float, float, float], tuple[tuple[float, float], ...]] | None:
    first, second = size.measure.values
    best = None
    near = rectangles_in(floor, size.measure.values, size.text.center_px, _PROPORTION, size.sizes)
    for bounds in (floor.bounds, *near):
        seen = bounds[2] - bounds[0], bounds[3] - bounds[1]
        for sides in ((first, second), (second, first)):
            pairs = tuple(zip(sides, seen, strict=True))
            off = max(abs(math.log(said / (span * m_per_px))) for said, span in pairs)
            if best is None or off < best[0]:
                best = off, bounds, pairs
    return best


def _spans_of_rooms(
    polygons_px: Sequence[FloatArray], printed: Sequence[_Printed], m_per_px: float
) -> tuple[list[_Span], list[Misfit]]:
    spans: list[_Span] = []
    misfits: list[Misfit] = []
    for index, size in enumerate(printed):
        floor = Polygon(polygons_px[size.room])
        if size.measure.kind == "area":
            off = 0.5 * math.log(size.measure.values[0] / (floor.area * m_per_px**2))
            rounding = 0.25 * _step(size.text.text) / size.measure.values[0]
            if size.is_alone and abs(off) > _MISFIT + rounding:
                misfits.append(_misfit(size, polygons_px, m_per_px))
            elif size.is_alone and rounding < abs(off) < _FITS:
                spans += _spans(floor.bounds, (math.exp(off),) * 2, (rounding,) * 2, index)
            continue
        result = _rectangle(size, floor, m_per_px)
        if result is not None:
            bounds, pairs = result
            ratios = tuple(said / (span * m_per_px) for said, span in pairs)
            coarse = tuple(_half_step_m(said, size.text.text) / said for said, _ in pairs)
            spans += _spans(bounds, ratios, coarse, index)
        elif size.is_alone:
            nearest = _nearest(size, floor, m_per_px)
            if nearest is not None and nearest[0] > _MISFIT and size.measure.is_sure:
                misfits.append(_misfit(size, polygons_px, m_per_px))
    return spans, misfits


def _half_step_m(length_m: float, text: str) -> float:
    """How much a printed length may be off: of "3.1 m", where OCR may have lost a digit, 5 cm."""
    printed = text.replace(",", ".")
    is_coarse = f"{length_m:.1f}" in printed and f"{length_m:.2f}" not in printed
    return 0.05 if is_coarse else 0.005


def _step(text: str) -> float:
    """What the last digit of a number counts."""
    digits = text.replace(",", ".").partition(".")[2]
    places = next((n for n, size in enumerate(digits) if not size.isdigit()), len(digits))
    return 10.0**-places


def _spans(
    bounds: Sequence[float], ratios: Sequence[float], slack: Sequence[float], source: int
) -> Iterator[_Span]:
    for axis in (0, 1):
        low, high = bounds[axis], bounds[axis + 2]
        length = (high - low) * ratios[axis]
        sigma = _PRINTED_PX + (_PRINTED_SHARE + slack[axis]) * length
        yield _Span(axis, low, high, length, sigma, source)


def _spans_of_chains(
    texts: Sequence[Text], knots: Sequence[FloatArray], m_per_px: float, source: int
) -> list[_Span]:
    """Lengths of chains that end at walls."""
    result: list[_Span] = []
    for length_m, center_px, axis in chain_lengths(texts):
        length = length_m / m_per_px
        near_px = _CHAIN_FITS * length / 2
        ends = [_near(knots[axis], center_px + side * length / 2) for side in (-1, 1)]
        if all(end is not None and abs(end[1]) <= near_px for end in ends):
            (low, _), (high, _) = (end for end in ends if end is not None)
            sigma = _PRINTED_PX + _PRINTED_SHARE * length
            result.append(_Span(axis, low, high, length, sigma, source + len(result)))
    return result


def _near(knots: FloatArray, place: float) -> tuple[float, float] | None:
    """The nearest knot, and how far it is off."""
    if len(knots) == 0:
        return None
    nearest = float(knots[np.abs(knots - place).argmin()])
    return nearest, nearest - place


# The fit -----------------------------------------------------------------------------------------


def _knots(polygons_px: Sequence[FloatArray], axis: int) -> FloatArray:
    """Where corners of rooms lie along an axis."""
    places = [np.round(polygon[:, axis], 3) for polygon in polygons_px]
    return np.unique(np.concatenate(places)) if places else np.zeros(0)


def _moved(knots: FloatArray, spans: Sequence[_Span], thickness_px: float) -> FloatArray:
    """Where the knots go: least squares, in which what contradicts the rest loses its weight."""
    if not spans or len(knots) < 2:
        return knots
    gaps = np.diff(knots)
    is_wall = gaps <= _WALL * thickness_px
    sigmas = np.where(is_wall, _WALL_PX, _SEEN_PX + _SEEN_SHARE * gaps)
    ends = np.array([[_at(knots, s.low), _at(knots, s.high)] for s in spans])
    rows = np.zeros((len(gaps) + len(spans) + 1, len(knots)))
    rows[np.arange(len(gaps)), np.arange(len(gaps))] = -1.0
    rows[np.arange(len(gaps)), np.arange(len(gaps)) + 1] = 1.0
    below = len(gaps) + np.arange(len(spans))
    rows[below, ends[:, 0]], rows[below, ends[:, 1]] = -1.0, 1.0
    rows[-1] = 1.0 / len(knots)
    wanted = np.array([*gaps, *(s.length_px for s in spans), knots.mean()])
    sigmas = np.array([*sigmas, *(s.sigma_px for s in spans), 1.0])
    weights = np.ones(len(wanted))
    result = knots
    for _ in range(_ROUNDS):
        by = weights / sigmas
        result = np.linalg.lstsq(rows * by[:, None], wanted * by, rcond=None)[0]
        off = (rows @ result - wanted)[below] / (3.0 * sigmas[below])
        weights[below] = 1.0 / (1.0 + off**2)
    return result if bool(np.all(np.diff(result) > 0.0)) else knots


def _at(knots: FloatArray, place: float) -> int:
    return int(np.abs(knots - place).argmin())


def _mapped(values: FloatArray, knots: FloatArray, moved: FloatArray) -> FloatArray:
    """Coordinates through the map, which shifts what lies beyond the outermost knots."""
    if len(knots) == 0:
        return values
    inside = np.clip(values, knots[0], knots[-1])
    return np.asarray(np.interp(inside, knots, moved) + (values - inside))


def _is_left(span: _Span, knots: Sequence[FloatArray], maps: Sequence[FloatArray]) -> bool:
    """Whether a size does not hold after the fit."""
    ends = np.array([span.low, span.high])
    low, high = _mapped(ends, knots[span.axis], maps[span.axis])
    return bool(abs(high - low - span.length_px) > _LEFT_PX + _LEFT_SHARE * span.length_px)


def _misfit(size: _Printed, polygons_px: Sequence[FloatArray], m_per_px: float) -> Misfit:
    floor = Polygon(polygons_px[size.room])
    read: tuple[float, ...] = (floor.area * m_per_px**2,)
    if size.measure.kind == "size":
        nearest = _nearest(size, floor, m_per_px)
        pairs = nearest[2] if nearest is not None else ()
        by_said = sorted(pairs, key=lambda pair: size.measure.values.index(pair[0]))
        read = tuple(span * m_per_px for _, span in by_said)
    x, y = (float(value) for value in size.text.center_px)
    return Misfit(size.text.text, (x, y), read, size.measure.kind)
