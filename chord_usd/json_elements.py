"""Typed access to parsed JSON, with errors that name the file, the element and the key."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

from chord_usd.errors import ChordError
from chord_usd.units import m_from_cm

LARGEST_LENGTH_M = 1000.0
"""A file with longer ones is not in centimetres, or broken."""


class Names:
    """The ids of one kind of element: refuses doubles, makes up missing ones."""

    def __init__(self, what: str) -> None:
        self._what, self._taken = what, set[str]()

    def take(self, element: Element, given: str | None, default: str = "") -> str:
        if given is None:
            count = 1
            while f"{default}_{count}" in self._taken:
                count += 1
            given = f"{default}_{count}"
        elif given in self._taken:
            raise element.error(
                f"the id '{given}' is taken by another {self._what}", expected="an id of its own"
            )
        self._taken.add(given)
        return given


class Element:
    """One JSON object, the words for it in messages, and typed access to its keys."""

    def __init__(self, data: object, where: str, error: type[ChordError]) -> None:
        self._where, self._error = where, error
        if not isinstance(data, dict):
            raise self.error(f"is {_type_name(data)}", expected="a JSON object")
        self._data: dict[str, Any] = data

    def error(self, what: str, expected: str = "", try_: str = "") -> ChordError:
        return self._error(what, where=self._where, expected=expected, try_=try_)

    def has(self, key: str) -> bool:
        return self._data.get(key) is not None

    def raw(self) -> dict[str, Any]:
        """Everything, as it stands. Refuses numbers that are not finite."""
        return self.rest(())

    def rest(self, known: Iterable[str]) -> dict[str, Any]:
        """What is not under a known key. Refuses numbers that are not finite."""
        rest = {key: value for key, value in self._data.items() if key not in set(known)}
        for key, value in rest.items():
            if not _is_finite(value):
                raise self.error(f"{key} holds NaN or Infinity", expected="finite numbers")
        return rest

    def text(self, key: str) -> str:
        return str(self._typed(key, (str,), "a text"))

    def texts(self, key: str) -> tuple[str, ...]:
        values = self._typed(key, (list,), "a list of texts")
        if not all(isinstance(value, str) for value in values):
            raise self.error(f"{key} holds something else than texts", expected="a list of texts")
        return tuple(values)

    def choice(self, key: str, allowed: Sequence[Any]) -> Any:
        value = self.text(key)
        if value not in allowed:
            raise self.error(f"unknown {key} '{value}'", expected=f"one of {', '.join(allowed)}")
        return value

    def whole(self, key: str) -> int:
        return int(self._typed(key, (int,), "a whole number"))

    def number(self, key: str) -> float:
        return self._finite(key, self._typed(key, (int, float), "a number"))

    def size(self, key: str) -> float:
        """A positive length in centimetres."""
        value = self.number(key)
        if not 0 < m_from_cm(value) <= LARGEST_LENGTH_M:
            raise self.error(f"{key} is {value:g}", expected="a positive number of centimetres")
        return value

    def numbers(self, key: str, count: int) -> list[float]:
        values = self._typed(key, (list,), f"a list of {count} numbers")
        return self._row(key, values, count)

    def points(self, key: str = "wallPoints") -> list[list[float]]:
        rows = self._typed(key, (list,), "a list of [x, y] points")
        return [self._row(f"{key}[{index}]", row, 2) for index, row in enumerate(rows)]

    def element(self, key: str) -> Element:
        self._typed(key, (dict,), "a JSON object")
        return Element(self._data[key], f"{self._where}: {key}", self._error)

    def elements(self, key: str, what: str, name_key: str = "id") -> list[Element]:
        """The objects of a list, each called by what it is and its id (or its place)."""
        rows = self._typed(key, (list,), "a list")
        made = []
        for index, row in enumerate(rows):
            name = row.get(name_key) if isinstance(row, dict) else None
            called = f"'{name}'" if isinstance(name, str) else f"{index + 1}"
            made.append(Element(row, f"{self._where}: {what} {called}", self._error))
        return made

    def _typed(self, key: str, types: tuple[type, ...], expected: str) -> Any:
        if key not in self._data:
            near = get_close_matches(key, [str(given) for given in self._data], n=1, cutoff=0.75)
            hint = f"rename '{near[0]}' to '{key}'" if near else ""
            raise self.error(f"{key} is missing", expected=expected, try_=hint)
        value = self._data[key]
        # JSON's true is a Python int.
        if not isinstance(value, types) or isinstance(value, bool):
            raise self.error(f"{key} is {_type_name(value)}", expected=expected)
        return value

    def _row(self, key: str, values: object, count: int) -> list[float]:
        if not isinstance(values, list) or len(values) != count:
            raise self.error(f"{key} is not a list of {count}", expected=f"{count} numbers")
        return [self._coordinate(key, value) for value in values]

    def _coordinate(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(f"{key} holds {_type_name(value)}", expected="numbers")
        number = self._finite(key, value)
        if abs(m_from_cm(number)) > LARGEST_LENGTH_M:
            raise self.error(f"{key} is {number:g} cm away", expected="centimetres")
        return number

    def _finite(self, key: str, value: float) -> float:
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self.error(f"{key} is {number}", expected="a finite number")
        return number


def _type_name(value: object) -> str:
    if value is None:
        return "null"
    names: dict[type, str] = {
        str: "a text", bool: "true or false", int: "a number", float: "a number",
        list: "a list", dict: "an object",
    }  # fmt: skip
    return names.get(type(value), type(value).__name__)


def _is_finite(value: object) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return all(_is_finite(part) for part in value.values())
    return not isinstance(value, list) or all(_is_finite(part) for part in value)
