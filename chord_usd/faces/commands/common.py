"""What the verbs share: option types, the common options and the outcome of a verb."""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from chord_usd.base.runtime import resident
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES, refuse_odd_file
from chord_usd.base.runtime.progress import PROGRESS_STYLES, Stopwatch, make_reporter
from chord_usd.faces.commands.paths import (
    UsageError,
    output_file,
    output_folder,
    with_suffixes,
)

if TYPE_CHECKING:
    from chord_usd.base.runtime.targets import FolderMode


@dataclass(frozen=True)
class Outcome:
    """What a verb has to say."""

    text: str | None
    """For people; one or more lines. None where the verb had standard output to itself."""
    data: Mapping[str, Any] = field(default_factory=dict)
    """For --json."""
    holds: bool = True
    """False where a check did not hold: exit code 1."""
    warnings: Sequence[str] = ()
    """Warnings about the input; printed on stderr."""


Run = Callable[[argparse.Namespace], Outcome]
Verbs = Any
"""What ArgumentParser.add_subparsers returns; argparse keeps the class private."""
Options = argparse._ActionsContainer
"""A parser, or a group of its options."""


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose mistakes are errors of one line."""

    def __init__(
        self, *, groups: Mapping[str, Sequence[str]] | None = None, **options: Any
    ) -> None:
        """groups: verbs by heading of the help page."""
        # An abbreviated option that works today is ambiguous the day a new option arrives.
        options.setdefault("allow_abbrev", False)
        super().__init__(**options)
        self._groups = groups or {}

    def format_help(self) -> str:
        """The help page, verbs under their headings."""
        verbs = next((a for a in self._actions if isinstance(a, _SubParsers)), None)
        if not self._groups or verbs is None:
            return super().format_help()
        lines = [self.format_usage(), self.description or ""]
        helps = {row.dest: row.help or "" for row in verbs._choices_actions}
        width = max(map(len, helps))
        for heading, names in self._groups.items():
            rows = [f"  {name:<{width}}  {helps[name]}" for name in names if name in helps]
            lines += ["", heading, *rows]
        return "\n".join([*lines, "", self.epilog or "", ""])

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            near = _did_you_mean(str(value), choices)
            listed = near or f"choose from {', '.join(choices)}"
            raise argparse.ArgumentError(action, f"there is no {_shown(str(value))}: {listed}")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse's; an option that the verb lacks is an error that names the nearest."""
        parsed, extras = super().parse_known_args(args, namespace)
        is_leaf = not any(isinstance(action, _SubParsers) for action in self._actions)
        unknown = next((word for word in extras if word.startswith("--")), None)
        if is_leaf and unknown:
            word = unknown.partition("=")[0]
            near = _did_you_mean(word, [w for w in self._option_string_actions if len(w) > 2])
            self.error(f"there is no option {_shown(word)}" + (f": {near}" if near else ""))
        return parsed, extras

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> Any:
        # argparse drops a "--" that is an option's value, and gives it a list without any.
        if action.option_strings and arg_strings == ["--"]:
            self.error(f"argument {'/'.join(action.option_strings)}: expected one argument")
        return super()._get_values(action, arg_strings)  # type: ignore[misc]

    def error(self, message: str) -> NoReturn:
        raise UsageError(message.replace("\n", " "), try_=f"<help={self.prog}>")


_SubParsers = argparse._SubParsersAction


def _did_you_mean(word: str, known: Sequence[str]) -> str:
    near = get_close_matches(word, known, n=2)
    return f"did you mean {' or '.join(near)}?" if near else ""


class _PrintSchema(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print the schema of the verb and leave, as --help does."""
        import json

        from chord_usd.faces.commands.results import schema_of

        schema = schema_of(parser.prog.partition(" ")[2])
        sys.stdout.write(json.dumps(schema, indent=1) + "\n")
        parser.exit()


def add_verb(verbs: Verbs, name: str, run: Run, summary: str, **options: Any) -> Parser:
    """A verb with the options that all verbs have."""
    parser: Parser = verbs.add_parser(
        name, help=summary, description=f"{summary[0].upper()}{summary[1:]}.", **options
    )
    parser.set_defaults(run=run, parser=parser)
    common = parser.add_argument_group("reporting")
    common.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    common.add_argument(
        "--json-schema", action=_PrintSchema, nargs=0, help="print the schema of that object"
    )
    common.add_argument(
        "--progress",
        choices=PROGRESS_STYLES,
        default="auto",
        help="how progress is printed on stderr",
    )
    common.add_argument(
        "-v", "--verbose", dest="progress", action="store_const", const="lines",
        help="as --progress lines",
    )  # fmt: skip
    common.add_argument(
        "-q", "--quiet", action="store_true", help="print errors only, no progress and no summary"
    )
    common.add_argument("--debug", action="store_true", help="show the traceback of an error")
    if parser.prog.split()[1] in resident.VERBS:
        common.add_argument(
            resident.OPTION,
            action="store_true",
            help="use no process that waits with the program loaded, and start none",
        )
    return parser


def add_group(verbs: Verbs, name: str, summary: str) -> Verbs:
    """A verb that has verbs of its own."""
    parser = verbs.add_parser(name, help=summary, description=f"{summary[0].upper()}{summary[1:]}.")
    return parser.add_subparsers(metavar="VERB", required=True, dest=f"{name}_verb")


def add_output(
    parser: Parser,
    summary: str,
    role: Callable[[str], Path] = output_file,
    *,
    suffixes: Sequence[str] = (),
    **options: Any,
) -> argparse.Action:
    """The option -o. role: what kind of output, of commands.paths. suffixes: those it may have,
    by default any."""
    options = {"required": True, "metavar": "PATH", **options}
    output = parser.add_argument("-o", "--output", type=role, help=summary, **options)
    with_suffixes(output, suffixes)
    return output


def add_stage_output(parser: Parser) -> None:
    """The option -o of a stage."""
    summary = "the stage: house.usda, .usd, .usdc, or .usdz for one file"
    add_output(parser, summary, suffixes=STAGE_SUFFIXES)


def add_output_folder(parser: Parser, summary: str) -> None:
    """The options -o and --overwrite of a folder that is one output."""
    add_output(parser, f"{summary}, new or empty", output_folder)
    parser.add_argument(
        "--overwrite", action="store_true",
        help="replace what chord-usd wrote into the folder before, and nothing else",
    )  # fmt: skip


def folder_mode(options: argparse.Namespace) -> FolderMode:
    """What --overwrite asks for, for runtime.files."""
    return "replace" if options.overwrite else "new"


def add_view(parser: Options) -> None:
    """The option --view."""
    parser.add_argument(
        "--view", type=output_file, metavar="GLB",
        help="also write the house as a .glb with small pictures, for viewers",
    )  # fmt: skip


def stopwatch(options: argparse.Namespace) -> Stopwatch:
    """A stopwatch that reports as --progress and --quiet ask."""
    return Stopwatch(make_reporter("none" if options.quiet else options.progress))


def existing_file(path: Path) -> Path:
    """The path, if there is a file that can be read to its end. Raises UsageError."""
    refuse_odd_file(path, UsageError)
    return path


def whole_number(least: int, most: int) -> Callable[[str], int]:
    """An option type: an integer from least to most, both included."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{_shown(text)} is not a whole number") from None
        if value < least:
            raise argparse.ArgumentTypeError(f"{_shown(text)} is less than {least}")
        if value > most:
            raise argparse.ArgumentTypeError(f"{_shown(text)} is more than {most}")
        return value

    return parse


def real_number(least: float, most: float, unit: str = "") -> Callable[[str], float]:
    """An option type: a number from least to most, both included."""
    return lambda text: _within(text, least, most, unit)


def _shown(text: str) -> str:
    return repr(text if len(text) <= 30 else f"{text[:30]}…")


def positive(text: str) -> float:
    """An option type: a number above zero, between a millionth and a million."""
    return _within(text, 1e-6, 1e6)


def share(text: str) -> float:
    """An option type: a part of a whole, above 0 and up to 1."""
    return _within(text, 1e-6, 1.0)


def _within(text: str, least: float, most: float, unit: str = "") -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{_shown(text)} is not a number") from None
    if not math.isfinite(value) or value <= 0.0:
        raise argparse.ArgumentTypeError(f"{_shown(text)} is not above zero")
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"{_shown(text)} is not from {least:g} to {most:g}{unit}")
    return value


def resolution(text: str) -> tuple[int, int]:
    """An option type: WIDTHxHEIGHT in pixels; RenderOptions knows how many can be rendered."""
    match = re.fullmatch(r"(\d{1,9})x(\d{1,9})", text)
    if not match or "0" in match.groups():
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, such as 1280x720")
    return int(match[1]), int(match[2])


def size_m(text: str) -> tuple[float, float, float]:
    """An option type: LENGTHxWIDTHxHEIGHT in metres."""
    sides = text.split("x")
    if len(sides) != 3:
        raise argparse.ArgumentTypeError(f"{text!r} is not LxWxH in metres, such as 1.6x2.0x0.9")
    return positive(sides[0]), positive(sides[1]), positive(sides[2])


def tile(text: str) -> tuple[int, int]:
    """An option type: I/N, the I-th of N, counted from 0."""
    match = re.fullmatch(r"(\d{1,5})/(\d{1,5})", text)
    if not match or int(match[1]) >= int(match[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is not I/N with I from 0 to N-1, such as 0/4")
    return int(match[1]), int(match[2])


def frames(text: str) -> tuple[int, int]:
    """An option type: A-B, from one number to another, both included; or one number."""
    match = re.fullmatch(r"(\d{1,5})(?:-(\d{1,5}))?", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not A-B, such as 0-9")
    return int(match[1]), int(match[2] or match[1])


def names(text: str) -> tuple[str, ...]:
    """An option type: names with commas between them, at least one."""
    listed = tuple(name for part in text.split(",") if (name := part.strip()))
    if not listed:
        raise argparse.ArgumentTypeError("is empty")
    return listed
