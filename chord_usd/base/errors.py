"""Errors a user can act on. The command line turns each into one `error:` line and exit code 2."""

from __future__ import annotations


class ChordError(Exception):
    """Something the user gave, or the machine holds, cannot be used.

    what: what is wrong; where: file, element or option; expected: what would be right;
    try_: the next step. Empty parts are left out of the sentence.
    """

    def __init__(self, what: str, *, where: str = "", expected: str = "", try_: str = "") -> None:
        self.what, self.where, self.expected, self.try_ = what, where, expected, try_
        super().__init__(self._sentence())

    def _sentence(self) -> str:
        parts = [self.what]
        if self.where:
            parts[0] = f"{self.where}: {self.what}"
        if self.expected:
            parts.append(f"expected {self.expected}")
        sentence = "; ".join(parts)
        return visible(f"{sentence}. Try: {self.try_}" if self.try_ else sentence)


class PlanError(ChordError):
    """The floor plan (picture or JSON) cannot be read as a plan."""


class SceneError(ChordError):
    """A scene graph or CHOrD JSON file breaks its own rules."""


class CheckpointError(ChordError):
    """Weights are missing, damaged or made by another version."""


class AssetError(ChordError):
    """The mesh database or the material library cannot serve a request."""


class StageError(ChordError):
    """A USD stage cannot be opened, written or trusted."""


class RenderError(ChordError):
    """Blender could not make the picture."""


class OutputError(ChordError):
    """The result cannot be written where it was asked for."""


class DiskFullError(OutputError):
    """There is no space for the result, nor for any other beside it."""


class MissingExtraError(ChordError):
    """An optional package is not installed; the message names the extra to install."""


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
