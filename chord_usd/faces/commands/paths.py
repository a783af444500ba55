"""What of a command line is read and what is written, and that the two never meet.

An option says by its type which it is: Path is read; the functions below are written. One check,
before a verb runs, goes over all of them.
"""

from __future__ import annotations

import argparse
import os
import unicodedata
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError, OutputError, reason_of
from chord_usd.base.runtime.locations import require_open
from chord_usd.base.runtime.targets import (
    check_file_target,
    check_run_folder,
    refuse_folder,
    refuse_full_disk,
)
from chord_usd.base.terms import surface, without_options


class UsageError(ChordError):
    """The command line cannot be understood."""

    code = "usage"

    def sentence(self, to: str = "") -> str:
        """As the command line says it; other surfaces have other names for its options."""
        said, to = super().sentence(to), to or surface()
        return said if to == "command" else without_options(said, to)


def output_file(text: str) -> Path:
    """An option type: a file to write; what is there under this name is replaced."""
    return Path(text)


def output_folder(text: str) -> Path:
    """An option type: a folder that is one output; it must be new or empty (--overwrite)."""
    return Path(text)


def output_place(text: str) -> Path:
    """An option type: a folder that files are added to."""
    return Path(text)


def output_run(text: str) -> Path:
    """An option type: the folder of a training run, which goes on where one stopped."""
    return Path(text)


def output_package(text: str) -> Path:
    """An option type: a file to write, or a folder that is one output, as another option says."""
    return Path(text)


def optional_input(text: str) -> Path:
    """An option type: what is read where it is there."""
    return Path(text)


def sky(text: str) -> str:
    """An option type: the name of a sky, or a picture of one, which is read."""
    return text


_OUTPUTS: tuple[Callable[[str], Path], ...] = (
    output_file, output_folder, output_place, output_run, output_package,
)  # fmt: skip

_INPUTS = (Path, optional_input)

_WHOLE_FOLDERS = (output_folder, output_package)

_SUFFIXES = {
    "PNG": (".png",), "JSON": (".json",), "GLB": (".glb",), "PICTURE": (".png", ".jpg"),
}  # fmt: skip
"""Of outputs, by the word that stands for them on the help page."""

_NOT_IN_USD = ("\\", ":SDF_FORMAT_ARGS:")
"""A separator of folders on other systems, and what parts a path from arguments."""

_LONGEST_NAME_BYTES, _LONGEST_PATH_BYTES = 255, 3900
"""Of a file or folder, and of all of a path, whose hidden folders need some more, on Linux."""

_DATA_SUFFIXES = {
    ".json", ".jsonl", ".gz", ".usd", ".usda", ".usdc", ".usdz", ".safetensors", ".onnx", ".obj",
    ".glb", ".gltf", ".npz", ".parquet",
}  # fmt: skip
"""Of files in an input folder that a verb may read; its pictures may be drawn again."""


@dataclass(frozen=True)
class Named:
    """A path of the command line."""

    option: str
    """As the user typed it, such as --preview or PLAN."""
    path: Path
    role: Callable[[str], Path]
    replaces: str = ""
    """Name of the input that this output may be: a stage that is edited in its place."""
    suffixes: tuple[str, ...] = ()
    """That an output may have; none for any."""

    @property
    def dest(self) -> Path:
        """The path with links followed and `..` taken out; it need not exist."""
        return Path(os.path.realpath(self.path))


def in_place_of(action: argparse.Action, name: str) -> None:
    """Allow an output to be the input of this name."""
    action.replaces = name  # type: ignore[attr-defined]


def named_paths(parser: argparse.ArgumentParser, options: argparse.Namespace) -> list[Named]:
    """All paths that a command line names, the inputs first."""
    return sorted(_named(parser, options), key=lambda named: named.role in _OUTPUTS)


def _named(parser: argparse.ArgumentParser, options: argparse.Namespace) -> Iterator[Named]:
    for action in parser._actions:
        role: Any = action.type
        if role not in (Path, optional_input, sky, *_OUTPUTS):
            continue
        given = getattr(options, action.dest, None)
        for path in given if isinstance(given, list | tuple) else [given]:
            if path is None or (role is sky and not Path(path).suffix):
                continue
            option = str(action.option_strings[-1] if action.option_strings else action.metavar)
            role = Path if role is sky else role
            yield Named(option, Path(path), role, getattr(action, "replaces", ""), _may_be(action))


def with_suffixes(action: argparse.Action, suffixes: Sequence[str]) -> None:
    """Say which suffixes an output may have, where its word on the help page does not."""
    action.suffixes = tuple(suffixes)  # type: ignore[attr-defined]


def _may_be(action: argparse.Action) -> tuple[str, ...]:
    named: tuple[str, ...] = getattr(action, "suffixes", ())
    return named or _SUFFIXES.get(str(action.metavar), ()) if action.type is output_file else ()


def check_paths(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Raise UsageError where an output is an input, holds one, or is another output,
    for a name that cannot be written down, for an input outside the open folders, and OutputError
    for what is no plain file, a folder that no training run may go on in, and a place where nothing
    can be written, a suffix that is none of the output's, a folder that holds something already,
    and a full disk. All that a command line names is settled before anything takes time."""
    check_named(named_paths(parser, options), overwrite=getattr(options, "overwrite", False))


def check_named(paths: Sequence[Named], *, overwrite: bool = False) -> None:
    """The same of paths that are named elsewhere than on a command line."""
    for path in paths:
        refuse_odd_name(path.option, path.path)
        if path.role in _INPUTS:
            require_open(path.path, UsageError)
        if path.role is Path:
            _require_there(path)
    inputs = [path for path in paths if path.role in _INPUTS]
    outputs = [path for path in paths if path.role not in _INPUTS]
    for output in outputs:
        for given in inputs:
            if output.replaces != given.option or not _same(output, given):
                _check_input(output, given)
        if output.role is output_file:
            check_file_target(output.path)
        _require_suffix(output)
        if output.role is output_run:
            check_run_folder(output.path)
        if output.role in _WHOLE_FOLDERS and output.path.is_dir():
            refuse_folder(output.path, "replace" if overwrite else "new")
        _refuse_read_only(output)
    for first, second in combinations(outputs, 2):
        if _same(first, second) or _is_within(second, first):
            raise UsageError(
                f"would be written twice, by {first.option} and {second.option}",
                where=str(second.path),
                expected="a path for each",
            )


def _require_there(given: Named) -> None:
    try:
        given.path.stat()
    except (FileNotFoundError, NotADirectoryError) as error:
        raise UsageError(
            "cannot be read (no such file)", where=str(given.path), try_="check the path"
        ) from error
    except OSError as error:
        raise UsageError(
            f"cannot be read ({reason_of(error)})", where=str(given.path), try_="check the path"
        ) from error


def _require_suffix(output: Named) -> None:
    if output.suffixes and output.path.suffix not in output.suffixes:
        named = ", ".join(output.suffixes)
        raise UsageError(
            f"{output.option} has {output.path.suffix or 'no suffix'}",
            where=str(output.path),
            expected=named if len(output.suffixes) == 1 else f"one of {named}",
            try_=f"{output.option} {output.path.stem}{output.suffixes[0]}",
        )


def refuse_odd_name(option: str, path: Path) -> None:
    """Raise UsageError for a path that the file system, USD or a terminal cannot say."""
    said = str(path)
    # Under an ASCII locale whatever is beyond it arrives as lone surrogates.
    if any("\ud800" <= character <= "\udfff" for character in said):
        raise UsageError(
            f"{option} is no path in UTF-8",
            where=said,
            try_="PYTHONUTF8=1, if the locale is not UTF-8",
        )
    if any(unicodedata.category(character) in ("Cc", "Zl", "Zp") for character in said):
        raise UsageError(f"{option} holds a control character", where=said, expected="a path")
    for sign in _NOT_IN_USD:
        if sign in path.as_posix():
            raise UsageError(
                f"{option} holds {sign!r}, which USD takes for something else",
                where=said,
                expected="a path without it",
            )
    if any(len(part.encode()) > _LONGEST_NAME_BYTES for part in path.parts):
        raise UsageError(
            f"{option} has a name of more than {_LONGEST_NAME_BYTES} bytes",
            where=f"{said[:40]}…",
            expected="a shorter one",
        )
    if len(said.encode()) > _LONGEST_PATH_BYTES:
        raise UsageError(
            f"{option} has more than {_LONGEST_PATH_BYTES} bytes",
            where=f"{said[:40]}…",
            expected="a shorter one",
        )


def _refuse_read_only(output: Named) -> None:
    """Say before the work what would be said after it."""
    target = output.dest
    folder = target if target.is_dir() else target.parent
    there = next(parent for parent in (folder, *folder.parents) if os.path.lexists(parent))
    if there.is_dir() and not os.access(there, os.W_OK | os.X_OK):
        raise OutputError(
            "cannot be written (permission denied)",
            where=str(output.path),
            expected="a path in a writable folder",
            try_=f"another {output.option}",
        )
    refuse_full_disk(there, output.path)


def _check_input(output: Named, given: Named) -> None:
    if output.role in (output_file, *_WHOLE_FOLDERS) and _same(output, given):
        clash = f"is both {given.option}, which is read, and {output.option}, which is written"
    elif _is_within(given, output):
        clash = f"holds {given.option}, which is read, and would be replaced by {output.option}"
    elif _overwrites_data(output, given):
        clash = f"lies in {given.option}, which is read, and would be replaced by {output.option}"
    else:
        return
    raise UsageError(
        clash, where=str(output.path), expected="another path", try_=f"another {output.option}"
    )


def _same(first: Named, second: Named) -> bool:
    try:
        return first.path.samefile(second.path)
    except OSError:
        return first.dest == second.dest


def _is_within(inner: Named, outer: Named) -> bool:
    """Whether outer is a folder that is one output, and inner lies in it."""
    return outer.role in _WHOLE_FOLDERS and inner.dest.is_relative_to(outer.dest)


def _overwrites_data(output: Named, given: Named) -> bool:
    return (
        output.role is output_file
        and output.path.suffix.lower() in _DATA_SUFFIXES
        and output.path.is_file()
        and given.path.is_dir()
        and output.dest.is_relative_to(given.dest)
    )
