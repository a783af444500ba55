"""Typed access to parsed JSON, with errors that name the file, the element and the key."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError, Steps
from chord_usd.base.scene.units import cm_from_m, m_from_cm

LARGEST_LENGTH_M = 1000.0
"""A file with longer ones is not in centimetres, or broken."""

SMALLEST_SIZE_M = 1e-5
"""Thinner than paper: nothing that one could see or that a mesh could be made of."""

LARGEST_TURN_DEG = 1e6
"""Angles are taken modulo 360; from here on too little is left behind the point to do that."""

LONGEST_TEXT = 4096
"""As long as a path may be."""

_SHOWN = 60
"""Characters of a text that a message repeats."""


class Names:
    """The ids of one kind of element: refuses doubles and too many, makes up missing ones."""

    def __init__(self, what: str, most: int) -> None:
        self._what, self._most, self._taken = what, most, set[str]()
        self._counts = Counter[str]()

    def take(self, element: Element, given: str | None, default: str = "") -> str:
        if given is None:
            self._counts[default] += 1
            while f"{default}_{self._counts[default]}" in self._taken:
                self._counts[default] += 1
            given = f"{default}_{self._counts[default]}"
        elif given in self._taken:
            raise element.error(
                f"the id '{shown(given)}' is taken by another {self._what}",
                expected="an id of its own",
            )
        self._taken.add(given)
        if len(self._taken) > self._most:
            raise element.error("is one too many", expected=f"at most {self._most} in one house")
        return given


class Element:
    """One JSON object, the words for it in messages, and typed access to its keys."""

    def __init__(self, data: object, where: str, error: type[ChordError]) -> None:
        self._where, self._error = where, error
        if not isinstance(data, dict):
            raise self.error(f"is {_type_name(data)}", expected="a JSON object")
        self._data: dict[str, Any] = data

    def error(self, what: str, expected: str = "", try_: Steps = "") -> ChordError:
        return self._error(what, where=self._where, expected=expected, try_=try_)

    def keys(self) -> set[str]:
        """All of its keys."""
        return set(self._data)

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
        return self._usable(key, str(self._typed(key, (str,), "a text")))

    def path(self, key: str) -> Path:
        value = self.text(key)
        if not value.isprintable():
            raise self.error(f"{key} holds a control character", expected="a path")
        return Path(value)

    def texts(self, key: str) -> tuple[str, ...]:
        values = self._typed(key, (list,), "a list of texts")
        if not all(isinstance(value, str) for value in values):
            raise self.error(f"{key} holds something else than texts", expected="a list of texts")
        return tuple(self._usable(key, value) for value in values)

    def choice(self, key: str, allowed: Sequence[Any]) -> Any:
        value = self.text(key)
        if value not in allowed:
            raise self.error(
                f"unknown {key} '{shown(value)}'", expected=f"one of {', '.join(allowed)}"
            )
        return value

    def whole(self, key: str) -> int:
        value = int(self._typed(key, (int,), "a whole number"))
        if abs(value) >= 2**63:
            raise self.error(f"{key} has {len(str(abs(value)))} digits", expected="64 bits at most")
        return value

    def number(self, key: str) -> float:
        return self._finite(key, self._typed(key, (int, float), "a number"))

    def size(self, key: str) -> float:
        """A positive length in centimetres."""
        value = self.number(key)
        if not SMALLEST_SIZE_M <= m_from_cm(value) <= LARGEST_LENGTH_M:
            low, high = cm_from_m(SMALLEST_SIZE_M), cm_from_m(LARGEST_LENGTH_M)
            expected = f"a positive number of centimetres, {low:g} to {high:.0f}"
            raise self.error(f"{key} is {value:g}", expected=expected)
        return value

    def angle(self, key: str) -> float:
        """Degrees, in [-360, 360]; what was in there stays as it stands."""
        value = self.number(key)
        if abs(value) > LARGEST_TURN_DEG:
            raise self.error(f"{key} is {value:g}", expected="degrees, such as 0 to 360")
        return value if abs(value) <= 360.0 else math.fmod(value, 360.0)

    def numbers(self, key: str, count: int) -> list[float]:
        values = self._typed(key, (list,), f"a list of {count} numbers")
        return self._row(key, values, count)

    def points(self, most: int, key: str = "wallPoints") -> list[list[float]]:
        rows = self._list(key, "a list of [x, y] points", most)
        return [self._row(f"{key}[{index}]", row, 2) for index, row in enumerate(rows)]

    def element(self, key: str) -> Element:
        self._typed(key, (dict,), "a JSON object")
        return Element(self._data[key], f"{self._where}: {key}", self._error)

    def elements(self, key: str, what: str, most: int, name_key: str = "id") -> list[Element]:
        """The objects of a list, each called by what it is and its id (or its place)."""
        rows = self._list(key, "a list", most)
        made = []
        for index, row in enumerate(rows):
            name = row.get(name_key) if isinstance(row, dict) else None
            called = f"'{shown(name)}'" if isinstance(name, str) else f"{index + 1}"
            made.append(Element(row, f"{self._where}: {what} {called}", self._error))
        return made

    def _list(self, key: str, expected: str, most: int) -> list[Any]:
        rows: list[Any] = self._typed(key, (list,), expected)
        if len(rows) > most:
            raise self.error(f"{key} holds {len(rows)}", expected=f"at most {most}")
        return rows

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

    def _usable(self, key: str, value: str) -> str:
        """The text, if it is no longer than anything that one would say or call something."""
        if len(value) > LONGEST_TEXT:
            raise self.error(
                f"{key} has {len(value)} characters", expected=f"at most {LONGEST_TEXT}"
            )
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


def shown(text: str) -> str:
    """A text as a message repeats it: shortened where it is long."""
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


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
