"""Finding and asking the chord-usd program that does the work in its own process."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

OLDEST = (0, 1, 0)
"""The first version whose files and reports this panel understands."""

HOW_TO_GET = (
    "Install chord-usd into a Python 3.11 environment (see its README) and give the path of "
    "its chord-usd program, or of that Python, in the preferences of this extension"
)

OPTIONAL = {
    "--text": "plan a home from a text",
    "--outline": "divide an open plan into rooms",
    "--part": "take another plan of a sheet, or another storey",
    "--furniture": "furnish with pieces that are asked for",
    "--no-dressing": "leave rooms undressed",
    "--roof": "give a house a roof",
    "--dry-run": "change a house as a sentence says",
    "--to": "go along the history of a house",
}
"""Options of some verbs that not every version has, and what each is there to do."""

WISHES_FROM = "--furniture"
"""Versions with this option take wanted and unwanted pieces of a room."""

EDITS_IN_WORDS = "--dry-run"
"""Versions with this option take changes in words."""

HAS_HISTORY = "--to"
"""Versions with this option keep the history of each house."""

ANSWER_WITHIN_S = 20.0

_VERSION = re.compile(r"chord-usd (\d+)\.(\d+)\.(\d+)")

_OPTION = re.compile(r"--[a-z-]+")

_OF_BLENDER = ("PYTHONHOME", "PYTHONPATH", "PYTHONSTARTUP", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")
"""Variables by which Blender's own Python would leak into the program's."""


class ProgramError(Exception):
    """The program cannot be used; the text says why and what to do, for people."""


@dataclass(frozen=True)
class Program:
    """A chord-usd that answered."""

    command: tuple[str, ...]
    """What a command line begins with."""
    version: tuple[int, int, int]
    abilities: frozenset[str] = frozenset()
    """Those of OPTIONAL that it has."""

    @property
    def name(self) -> str:
        """The program and its version."""
        return f"chord-usd {'.'.join(map(str, self.version))}"

    @property
    def label(self) -> str:
        """As the preferences show it."""
        return f"{self.name} ({self.command[0]})"

    def has(self, row: Mapping[str, Any]) -> bool:
        """Whether this version has a row of the option table."""
        word = f"--{row['word']}"
        return word not in OPTIONAL or word in self.abilities

    def lacking(self, options: Iterable[str]) -> str:
        """What this version is too old to do of some of OPTIONAL, as a sentence; else empty."""
        missing = [OPTIONAL[option] for option in options if option not in self.abilities]
        if not missing:
            return ""
        return f"{self.name} cannot {' or '.join(missing)} yet. Update it where it is installed."

    def check_can(self, arguments: Sequence[str]) -> None:
        """Raises ProgramError for a command line that this version is too old for."""
        lacking = self.lacking(options_of(arguments))
        if lacking:
            raise ProgramError(lacking)


def options_of(arguments: Sequence[str]) -> list[str]:
    """Those of OPTIONAL that a command line uses."""
    used = {word.partition("=")[0] for word in arguments}
    return [option for option in OPTIONAL if option in used]


def find_program(preference: str) -> Program:
    """The program of the preference, or, where it is empty, the first one that answers.

    Raises ProgramError.
    """
    if preference.strip():
        return ask(command_of(Path(preference.strip()).expanduser()))
    for candidate in candidates():
        try:
            return ask(command_of(candidate))
        except ProgramError:
            continue
    raise ProgramError(f"No chord-usd was found. {HOW_TO_GET}.")


def candidates() -> list[Path]:
    """Where chord-usd usually is: on the path, in an active environment, in the user's folder."""
    name = "chord-usd.exe" if sys.platform == "win32" else "chord-usd"
    folder = "Scripts" if sys.platform == "win32" else "bin"
    paths = [Path(path) for path in [shutil.which("chord-usd")] if path]
    roots = [os.environ.get("VIRTUAL_ENV"), os.environ.get("CONDA_PREFIX")]
    homes = [Path(root) / folder for root in roots if root]
    homes += [Path.home() / ".local" / "bin", Path.home() / "chord-usd" / ".venv" / folder]
    paths += [home / name for home in homes if (home / name).is_file()]
    return list(dict.fromkeys(paths))


def command_of(path: Path) -> tuple[str, ...]:
    """The command line's beginning for a chord-usd program, a Python, or an environment's folder.

    Raises ProgramError where there is nothing that could be started.
    """
    if path.is_dir():
        inside = [path / "bin" / "chord-usd", path / "Scripts" / "chord-usd.exe"]
        existing = [file for file in inside if file.is_file()]
        if not existing:
            raise ProgramError(f"There is no chord-usd in the folder {path}. {HOW_TO_GET}.")
        return (str(existing[0]),)
    if not path.is_file():
        raise ProgramError(f"There is no file {path}. {HOW_TO_GET}.")
    if path.stem.lower().startswith("python"):
        return (str(path), "-m", "chord_usd")
    return (str(path),)


def ask(command: Sequence[str]) -> Program:
    """Ask the program for its version and abilities.

    Raises ProgramError where it does not answer as chord-usd does, or is too old.
    """
    answer = _answer(command, ["--version"])
    match = _VERSION.search(answer.stdout)
    if answer.returncode or not match:
        said = (answer.stderr.strip() or answer.stdout.strip() or "nothing").splitlines()[-1]
        raise ProgramError(f"{command[0]} is not chord-usd (it said: {said}). {HOW_TO_GET}.")
    version = int(match[1]), int(match[2]), int(match[3])
    if version < OLDEST:
        wanted = ".".join(map(str, OLDEST))
        raise ProgramError(
            f"{match[0]} is too old for this panel, which needs {wanted} or newer. Update it where "
            "it is installed."
        )
    helps = (_answer(command, [verb, "--help"]).stdout for verb in ("generate", "edit", "history"))
    options = {option for text in helps for option in _OPTION.findall(text)}
    return Program(tuple(command), version, frozenset(options.intersection(OPTIONAL)))


def _answer(command: Sequence[str], words: Sequence[str]) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            [*command, *words],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=ANSWER_WITHIN_S,
            env=clean_environment(os.environ),
            stdin=subprocess.DEVNULL,
            check=False,
        )
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ProgramError(f"{command[0]} cannot be started: {reason}. {HOW_TO_GET}.") from error
    except subprocess.TimeoutExpired as error:
        raise ProgramError(f"{command[0]} did not answer in {ANSWER_WITHIN_S:.0f} s.") from error


def clean_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment without what belongs to Blender's own Python.

    What the program says is in the panel's terms, and UTF-8, whatever the system's own encoding:
    paths have all letters.
    """
    kept = {name: value for name, value in environment.items() if name not in _OF_BLENDER}
    return {**kept, "PYTHONUTF8": "1", "CHORD_USD_SURFACE": "panel"}
