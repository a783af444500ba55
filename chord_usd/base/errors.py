"""Errors a user can act on, as objects; each surface words them in its own terms (terms.py).

The command line turns each into one `error:` line and exit code 2.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from chord_usd.base.terms import either, reference_in, surface, worded

Steps = str | Sequence[str]
"""A step that helps, or several of which each does."""


class ChordError(Exception):
    """Something the user gave, or the machine holds, cannot be used.

    what: what is wrong; where: file, element or option; expected: what would be right;
    try_: what to do next; value: what was given. All but what may refer to options and steps of a
    surface (terms.py). Empty parts are left out of the sentence, as are those that refer to what
    a surface lacks.
    """

    code = "unusable"
    """The kind of error, for programs; it does not depend on wording."""

    def __init__(
        self, what: str, *, where: str = "", expected: str = "", try_: Steps = "",
        value: object = None,
    ) -> None:  # fmt: skip
        self.what, self.where, self.expected, self.try_ = what, where, expected, try_
        self.value = value
        super().__init__(what)

    def __str__(self) -> str:
        return self.sentence()

    @property
    def field(self) -> str:
        """Name of the option that holds what is wrong, as terms.tsv has it; "" for none."""
        return reference_in(self.where)

    def suggestions(self, to: str = "") -> tuple[str, ...]:
        """Next steps in the terms of a surface; "" for that of this process."""
        steps = (self.try_,) if isinstance(self.try_, str) else self.try_
        return tuple(said for step in steps if (said := worded(step, to)))

    def sentence(self, to: str = "") -> str:
        """What, where, expected and what to try, in the terms of a surface."""
        where = worded(self.where, to, is_bare=True)
        if (to or surface()) == "page":
            where = _without_file(where)
        expected, steps = worded(self.expected, to), self.suggestions(to)
        sentence = f"{where}: {self.what}" if where else self.what
        sentence += f"; expected {expected}" if expected else ""
        return visible(f"{sentence}. Try: {either(steps)}" if steps else sentence)

    def as_json(self, to: str = "") -> dict[str, Any]:
        """For other programs, as JSON: code, field, value, suggestions and the sentence."""
        value = self.value if isinstance(self.value, str | int | float | None) else str(self.value)
        return {
            "code": self.code, "field": self.field, "value": value,
            "suggestions": [*self.suggestions(to)], "sentence": self.sentence(to),
        }  # fmt: skip


class WordedError(ChordError):
    """An error of another process, which has worded it."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        super().__init__(str(fields["sentence"]), value=fields.get("value"))
        self.code = str(fields.get("code") or "unusable")
        self.fields = fields

    @property
    def field(self) -> str:
        return str(self.fields.get("field") or "")

    def suggestions(self, to: str = "") -> tuple[str, ...]:
        return tuple(self.fields.get("suggestions") or ())

    def sentence(self, to: str = "") -> str:
        return self.what


def _without_file(where: str) -> str:
    """A place without the file that it is in: a page keeps files under names of its own."""
    head, mark, rest = where.partition(": ")
    is_file = "/" in head or bool(_FILE.search(head))
    return (rest if mark else "") if is_file else where


_FILE = re.compile(r"\.[a-z][a-z0-9]{2,4}$")


class PlanError(ChordError):
    """The floor plan (picture or JSON) cannot be read as a plan."""

    code = "plan"


class SceneError(ChordError):
    """A scene graph or CHOrD JSON file breaks its own rules."""

    code = "scene"


class CheckpointError(ChordError):
    """Weights are missing, damaged or made by another version."""

    code = "checkpoint"


class AssetError(ChordError):
    """The mesh database or the material library cannot serve a request."""

    code = "asset"


class StageError(ChordError):
    """A USD stage cannot be opened, written or trusted."""

    code = "stage"


class RenderError(ChordError):
    """Blender could not make the picture."""

    code = "render"


class OutputError(ChordError):
    """The result cannot be written where it was asked for."""

    code = "output"


class DiskFullError(OutputError):
    """There is no space for the result, nor for any other beside it."""

    code = "disk_full"


class MissingExtraError(ChordError):
    """An optional package is not installed; the message names the extra to install."""

    code = "missing_extra"


def visible(text: str) -> str:
    """Text with what a terminal would obey, or nobody could see, written out: "\\x1b".

    White space stays; whoever needs one line joins it.
    """
    return "".join(
        character
        if character.isprintable() or character.isspace()
        else character.encode("unicode_escape").decode()
        for character in text
    )


def reason_of(error: OSError) -> str:
    """Why the system refused, to stand inside a sentence: "permission denied"."""
    return (error.strerror or str(error)).lower()
