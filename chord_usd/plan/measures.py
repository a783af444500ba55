"""Printed measures: "13 m²", "3.45 x 2.90", "11'7\\" × 15'7\\"", "1375", "6帖" -> metres.

OCR confuses the marks of feet and inches (' ′ ° * and " ″ ``), and drops a decimal point now and
then; a measure that no room can have is none.
"""

from __future__ import annotations

import re
import unicodedata
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

_NUMBER = r"(\d+(?:[.,]\d+)?)"
_UNIT = r"\s*(mm|cm|m)?"
_FOOT = r"['’′`´]"
_AFTER_INCH = r"(?:[\"”″°*'’′`´]{0,2})"
_INCHES = rf"(\d{{1,2}})(?:\s*[½¼¾])?\s*(?:in\.?|{_AFTER_INCH})"
_FEET = rf"(\d{{1,2}})\s*(?:{_FOOT}|ft\.?)\s*-?\s*(?:{_INCHES})?"
_BY = r"\s*[x×*]\s*"

_SQUARE_M = re.compile(rf"{_NUMBER}\s*(?:m2|m\^2|sqm|sq\.?\s*m|qm|平米|平方米|㎡)(?![a-z])")
_SQUARE_FEET = re.compile(rf"{_NUMBER}\s*(?:sq\.?\s*(?:ft|feet)|sqft|ft2|sf)(?![a-z])")
_TATAMI = re.compile(rf"{_NUMBER}\s*(?:帖|畳|疊|j[oō]?(?![a-z])|tatami|mats?)")
_METRIC_SIZE = re.compile(rf"^{_NUMBER}{_UNIT}{_BY}{_NUMBER}{_UNIT}$")
_FEET_SIZE = re.compile(rf"^{_FEET}{_BY}{_FEET}$")
_METRIC_LENGTH = re.compile(rf"^{_NUMBER}{_UNIT}$")
_FEET_LENGTH = re.compile(rf"^{_FEET}$")


@dataclass(frozen=True)
class Measure:
    """A printed measure, in metres or square metres."""

    kind: MeasureKind
    values: tuple[float, ...]
    """One length, both sides of a room, or one area."""
    is_sure: bool = True
    """False for a bare number: its unit is guessed from how large it is."""


def parse_measure(text: str) -> Measure | None:
    """The measure in a line of text; None if it holds none that a dwelling can have."""
    folded = unicodedata.normalize("NFKC", text.replace("²", "2")).casefold().strip()
    for parse in (_area, _feet_size, _metric_size, _feet_length, _metric_length):
        measure = parse(folded)
        if measure is not None:
            return measure
    return None


def _area(text: str) -> Measure | None:
    for pattern, m2 in (
        (_SQUARE_FEET, M2_PER_SQUARE_FOOT),
        (_SQUARE_M, 1.0),
        (_TATAMI, M2_PER_TATAMI),
    ):
        if match := pattern.search(text):
            return _plausible("area", (_value(match[1]) * m2,), _AREAS_M2)
    return None


def _feet_size(text: str) -> Measure | None:
    if match := _FEET_SIZE.match(text):
        sides = _feet_m(match[1], match[2]), _feet_m(match[3], match[4])
        return _plausible("size", sides, _SIDES_M)
    return None


def _metric_size(text: str) -> Measure | None:
    if not (match := _METRIC_SIZE.match(text)):
        return None
    unit = match[4] or match[2]
    factor = _factor(unit, max(_value(match[1]), _value(match[3])), f"{match[1]}{match[3]}")
    if factor is None:
        return None
    sides = _value(match[1]) * factor, _value(match[3]) * factor
    return _plausible("size", sides, _SIDES_M)


def _feet_length(text: str) -> Measure | None:
    if (match := _FEET_LENGTH.match(text)) and (match[2] or "ft" in text):
        return _plausible("length", (_feet_m(match[1], match[2]),), _LENGTHS_M)
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
        return {"m": 1.0, "cm": 0.01, "mm": 0.001}[unit]
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
) -> Measure | None:
    fits = all(limits[0] <= value <= limits[1] for value in values)
    return Measure(kind, values, is_sure) if fits else None


def _value(number: str) -> float:
    return float(number.replace(",", "."))


def _feet_m(feet: str, inches: str | None) -> float:
    return int(feet) * M_PER_FOOT + int(inches or 0) * M_PER_INCH
