"""Printed measures: "13 m²", "3.45 x 2.90", "11'7\\" × 15'7\\"", "1375", "6帖" -> metres.

OCR confuses the marks of feet and inches (' ′ ° * and " ″ ``), and drops a decimal point now and
then; a measure that no room can have is none.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

MeasureKind = Literal["length", "size", "area"]

M_PER_FOOT, M_PER_INCH = 0.3048, 0.0254
M2_PER_SQUARE_FOOT = M_PER_FOOT**2
M2_PER_TATAMI = 1.62
"""What Japanese estate agents must count for one jō (Fair Competition Code, 1.62 m²)."""

_LENGTHS_M = (0.3, 60.0)
_SIDES_M = (0.6, 20.0)
_AREAS_M2 = (0.6, 400.0)

_MOST_APART = 0.06
"""Of each other may be two units' words for one size: feet are printed to the inch or the half."""

_NUMBER = r"(\d+(?:[.,]\d+)?)"
_UNIT = r"(?:\s*(mm|cm|m|feet|ft\.?|f)(?![a-wyz2]))?"
_FOOT = r"['’′`´]"
_AFTER_INCH = r"(?:[\"”″°*'’′`´]{0,2})"
_INCHES = rf"(\d{{1,2}})(?:\s*[½¼¾])?\s*(?:in\.?|{_AFTER_INCH})"
_FEET = rf"(\d{{1,2}})\s*(?:{_FOOT}|ft\.?)\s*-?\s*(?:{_INCHES})?"
# OCR takes the mark of feet for one of degrees, or loses it: then one side decides the other.
_FEET_SIDE = rf"(\d{{1,2}})\s*(?:{_FOOT}|°|ft\.?)\s*-?\s*(?:{_INCHES})?"
_BARE_SIDE = r"(\d{2,4})[\"”″*]?"
_BY = r"\s*[x×*✕±]\s*"
_BEGIN, _END = r"(?<![\d.,'’′])", r"(?![\d'’′])"

_SQUARE_M = re.compile(
    rf"{_NUMBER}\s*(?:m2|m\^2|sqm|sq\.?\s*m(?:et(?:re|er)s?)?|qm|kvm|平米|平方米|㎡)(?![a-z])"
)
_SQUARE_FEET = re.compile(rf"{_NUMBER}\s*(?:sq\.?\s*(?:ft|feet)|sqft|ft2|sf)(?![a-z])")
_TATAMI = re.compile(rf"{_NUMBER}\s*(?:帖|畳|疊|j[oō]?(?![a-z])|tatami|mats?)")
_METRIC_SIZE = re.compile(rf"{_BEGIN}{_NUMBER}{_UNIT}{_BY}{_NUMBER}{_UNIT}{_END}")
_FEET_SIZE = re.compile(rf"{_BEGIN}{_FEET_SIDE}{_BY}{_FEET_SIDE}{_END}")
_HALF_FEET_SIZES = (
    re.compile(rf"{_BEGIN}{_FEET_SIDE}{_BY}{_BARE_SIDE}{_END}"),
    re.compile(rf"{_BEGIN}{_BARE_SIDE}{_BY}{_FEET_SIDE}{_END}"),
)
_METRIC_LENGTH = re.compile(rf"^{_NUMBER}{_UNIT}$")
_FEET_LENGTH = re.compile(rf"^{_FEET}$")
_PARTS = re.compile(r"[()\[\]|/]|(?<=[m\d])\s*[=,]\s+")
_FACTORS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "f": M_PER_FOOT}


@dataclass(frozen=True)
class Measure:
    """A printed measure, in metres or square metres."""

    kind: MeasureKind
    values: tuple[float, ...]
    """One length, both sides of a room, or one area."""
    is_sure: bool = True
    """False where the unit is guessed: of a bare number from how large it is."""
    is_metric: bool = True
    """False of feet and inches, and of tatami."""

    def says_same(self, other: Measure) -> bool:
        """Whether the other is this one in another unit."""
        if self.kind != other.kind or self.is_metric == other.is_metric:
            return False
        pairs = zip(sorted(self.values), sorted(other.values), strict=True)
        return all(abs(math.log(a / b)) < _MOST_APART for a, b in pairs)


def parse_measure(text: str) -> Measure | None:
    """The measure in a line of text; None if it holds none that a dwelling can have.

    A size in two units is one, and sure where these agree.
    """
    folded = unicodedata.normalize("NFKC", text.replace("²", "2")).casefold().strip()
    parts = [part.strip() for part in _PARTS.split(folded) if part.strip()]
    if len(parts) > 1 and (measures := [m for part in parts if (m := _parse(part)) is not None]):
        return distinct(measures)[0]
    return _parse(folded)


def distinct(measures: Sequence[Measure]) -> list[Measure]:
    """The measures of one room, each said once: what is printed in two units is one measure.

    Where both a size and a guess at one are printed, the guess is none.
    """
    kept: list[Measure] = []
    for measure in sorted(measures, key=lambda m: (not m.is_sure, not m.is_metric)):
        is_guess = not measure.is_sure and measure.kind == "size"
        if is_guess and any(m.is_sure and m.kind == "size" for m in kept):
            continue
        if not any(measure.says_same(other) for other in kept):
            kept.append(measure)
    return kept


def _parse(text: str) -> Measure | None:
    for parse in (_area, _feet_size, _metric_size, _feet_length, _metric_length):
        measure = parse(text)
        if measure is not None:
            return measure
    return None


def _area(text: str) -> Measure | None:
    areas = [
        (match, m2)
        for pattern, m2 in (
            (_SQUARE_M, 1.0),
            (_SQUARE_FEET, M2_PER_SQUARE_FOOT),
            (_TATAMI, M2_PER_TATAMI),
        )
        if (match := pattern.search(text))
    ]
    if not areas:
        return None
    match, m2 = areas[0]
    return _plausible("area", (_value(match[1]) * m2,), _AREAS_M2, is_metric=m2 == 1.0)


def _feet_size(text: str) -> Measure | None:
    if match := _FEET_SIZE.search(text):
        sides = _feet_m(match[1], match[2]), _feet_m(match[3], match[4])
        return _plausible("size", sides, _SIDES_M, is_metric=False)
    first, second = (pattern.search(text) for pattern in _HALF_FEET_SIZES)
    if first and (bare_m := _unmarked_feet_m(first[3])):
        sides = _feet_m(first[1], first[2]), bare_m
    elif second and (bare_m := _unmarked_feet_m(second[1])):
        sides = bare_m, _feet_m(second[2], second[3])
    else:
        return None
    return _plausible("size", sides, _SIDES_M, is_sure=False, is_metric=False)


def _unmarked_feet_m(digits: str) -> float | None:
    """Of feet and inches that lost their mark: 126 is 12'6", 910 is 9'10"."""
    for feet, inches in ((digits[:-1], digits[-1]), (digits[:-2], digits[-2:])):
        if feet and int(inches) < 12 and _feet_m(feet, inches) <= _SIDES_M[1]:
            return _feet_m(feet, inches)
    return None


def _metric_size(text: str) -> Measure | None:
    if not (match := _METRIC_SIZE.search(text)):
        return None
    unit = match[4] or match[2]
    factor = _factor(unit, max(_value(match[1]), _value(match[3])), f"{match[1]}{match[3]}")
    if factor is None:
        return None
    sides = _value(match[1]) * factor, _value(match[3]) * factor
    is_sure = bool(unit) or not f"{match[1]}{match[3]}".isdigit()
    is_metric = not (unit or "").startswith("f")
    return _plausible("size", sides, _SIDES_M, is_sure=is_sure, is_metric=is_metric)


def _feet_length(text: str) -> Measure | None:
    if (match := _FEET_LENGTH.match(text)) and (match[2] or "ft" in text):
        feet_m = _feet_m(match[1], match[2])
        return _plausible("length", (feet_m,), _LENGTHS_M, is_metric=False)
    return None


def _metric_length(text: str) -> Measure | None:
    if not (match := _METRIC_LENGTH.match(text)):
        return None
    factor = _factor(match[2], _value(match[1]), match[1])
    if factor is None:
        return None
    return _plausible("length", (_value(match[1]) * factor,), _LENGTHS_M, is_sure=bool(match[2]))


def _factor(unit: str | None, value: float, digits: str) -> float | None:
    """Metres per unit; of bare numbers, by how long they are and whether they have a point."""
    if unit:
        return _FACTORS["f" if unit.startswith("f") else unit]
    if "." in digits or "," in digits:
        return 1.0 if value < 60.0 else None
    if value >= 10_000:
        return 0.001
    # 1375 may be either; which one it is shows beside the other measures of the sheet.
    return 0.01 if 60.0 <= value < 1000.0 else 0.001 if value >= 1000.0 else None


def _plausible(
    kind: MeasureKind,
    values: tuple[float, ...],
    limits: tuple[float, float],
    *,
    is_sure: bool = True,
    is_metric: bool = True,
) -> Measure | None:
    fits = all(limits[0] <= value <= limits[1] for value in values)
    return Measure(kind, values, is_sure, is_metric) if fits else None


def _value(number: str) -> float:
    return float(number.replace(",", "."))


def _feet_m(feet: str, inches: str | None) -> float:
    return int(feet) * M_PER_FOOT + int(inches or 0) * M_PER_INCH
