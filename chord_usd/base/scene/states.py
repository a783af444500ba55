"""States of a house: which doors stand open and which lamps are on, in words.

"doors: closed; bedroom 1 lamp: off": a clause is SUBJECT: STATE, and later clauses win.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from chord_usd.base.errors import ChordError

WHERE = "<state>"

OPENED: dict[str, float] = {
    "open": 1.0, "half open": 0.5, "ajar": 1.0 / 6.0, "closed": 0.0, "shut": 0.0
}  # fmt: skip
"""States of doors, windows and leaves of furniture, each with its share of the range."""

LIT: dict[str, bool] = {"on": True, "off": False}
"""States of lamps."""

USUAL = "usual"
"""Takes a state back: leaves are closed, lamps follow the time of day."""

PASSABLE = 0.5
"""Share of its range from which a door lets people and robots through."""

MOST_CHARACTERS = 2000

_EXAMPLE = '"doors: closed; bedroom 1 lamp: off"'


@dataclass(frozen=True)
class Clause:
    """What becomes of a subject."""

    subject: str
    state: str
    """A key of OPENED or LIT, or USUAL."""

    def fits(self, *, leaf: bool) -> bool:
        """Whether leaves, or else lamps, have such a state."""
        return self.state == USUAL or (self.state in OPENED) == leaf


def read_states(text: str) -> tuple[Clause, ...]:
    """The clauses of a text. Raises ChordError."""
    if len(text) > MOST_CHARACTERS:
        raise _error(f"has {len(text)} characters", f"at most {MOST_CHARACTERS}")
    clauses = []
    for part in filter(str.strip, re.split(r"[;；\n]", text)):
        subject, colon, said = part.replace("：", ":").rpartition(":")
        state = " ".join(re.findall(r"[^\W\d_]+", said.lower()))
        if not colon or not subject.strip():
            raise _error(f"'{part.strip()}' names no state", f"SUBJECT: STATE, as in {_EXAMPLE}")
        if state not in (*OPENED, *LIT, USUAL):
            known = ", ".join((*OPENED, *LIT, USUAL))
            raise _error(f"'{said.strip()}' is no state", f"one of {known}")
        clauses.append(Clause(" ".join(subject.split()), state))
    if not clauses:
        raise _error("is empty", f"SUBJECT: STATE, as in {_EXAMPLE}")
    return tuple(clauses)


def states_said(text: str) -> str:
    """The text, once it is understood. Raises ChordError."""
    read_states(text)
    return text


def _error(what: str, expected: str) -> ChordError:
    return ChordError(what, where=WHERE, expected=expected)
