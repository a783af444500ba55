"""The command line: a verb per step of the line.

Exit codes: 0 done; 1 ran, and a check did not hold; 2 the input or the command line is unusable,
printed as one `error:` line on stderr; 130 interrupted (Ctrl-C); 143 terminated (SIGTERM).
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import traceback
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from chord_usd import __version__
from chord_usd.base.errors import ChordError
from chord_usd.base.runtime import interrupts
from chord_usd.base.terms import VARIABLE, surface, wording_for

if TYPE_CHECKING:
    from chord_usd.faces.commands.common import Outcome, Parser
from chord_usd.base.runtime import console, resident
from chord_usd.base.runtime.extras import missing_extra
from chord_usd.base.runtime.locations import keep_caches, untrained_in_use, working_folder
from chord_usd.base.runtime.offline import stay_offline
from chord_usd.base.runtime.progress import held_lines

GROUPS = {
    "make a house": ("generate", "render", "serve"),
    "look at a house and change it": (
        "check", "describe", "diff", "edit", "regenerate", "undo", "redo", "history", "export",
    ),
    "one step at a time": ("plan", "layout", "graph", "stage"),
    "many houses, many machines": ("batch", "farm", "mcp"),
    "meshes and materials": ("assets", "looks"),
    "data, training and scores": ("dataset", "train", "evaluate"),
    "this program": ("completion",),
}  # fmt: skip
"""Modules of chord_usd.faces.commands, by purpose, as the help page lists them."""

VERBS = tuple(verb for group in GROUPS.values() for verb in group)

DONE, NOT_HELD, UNUSABLE = 0, 1, 2

LONGEST_ERROR = 600
"""Characters of the error line; some libraries say their all."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line; returns the exit code."""
    with wording_for(surface() if VARIABLE in os.environ else "command"):
        return _main(arguments)


def _main(arguments: Sequence[str] | None) -> int:
    words = list(sys.argv[1:] if arguments is None else arguments)
    stay_offline()
    keep_caches()
    # Before anything that takes time: a stopped job leaves no half-written output and no traceback.
    interrupts.obey()
    if arguments is None:
        interrupts.watch()
    try:
        return _answer(words, is_guest=True) if arguments is not None else _by_worker_or_here(words)
    except KeyboardInterrupt as caught:
        reason = interrupts.came() or interrupts.Interrupted
        sys.stderr.write(interrupts.message(reason, str(caught)))
        return reason.code
    except BrokenPipeError:
        # Whoever read stdout has seen enough; keep the interpreter from flushing into the pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        if hidden := interrupts.came():  # some libraries make errors of their own of it
            sys.stderr.write(interrupts.message(hidden))
            return hidden.code
        if "--debug" in words:
            traceback.print_exc()
        fields = _fields_of(error)
        if surface() in ("page", "agent", "panel") and "--progress" in words:
            sys.stderr.write(json.dumps({"error": fields}) + "\n")
        sys.stderr.write(f"error: {fields['sentence']}\n")
        return UNUSABLE
    finally:
        if arguments is None:
            interrupts.ignore()


def _by_worker_or_here(words: Sequence[str]) -> int:
    environment = {**os.environ}
    code = resident.run(words)
    if code is None:
        code = _answer(words)
    resident.start_next(words, code, environment)
    return code


def _answer(words: Sequence[str], *, is_guest: bool = False) -> int:
    """is_guest: the process does more than this command line."""
    from chord_usd.faces.commands.paths import check_paths

    options = build_parser(words).parse_args(words)
    options.is_guest = is_guest
    working_folder()
    check_paths(options.parser, options)
    outcome = _run(options)
    if not options.quiet:
        _tell(outcome, as_json=options.json)
    return DONE if outcome.holds else NOT_HELD


def build_parser(words: Sequence[str] = ()) -> Parser:
    """The whole command line; of words that begin with a verb, what that verb needs."""
    from chord_usd.faces.commands.common import Parser

    parser = Parser(
        prog="chord-usd",
        description="A floor plan picture becomes a furnished, hierarchical OpenUSD house.",
        epilog="chord-usd VERB --help lists the options of a verb.",
        groups=GROUPS,
    )
    parser.add_argument("--version", action="version", version=f"chord-usd {__version__}")
    parser.set_defaults(command_line=build_parser)
    verbs = parser.add_subparsers(metavar="VERB", required=True, dest="verb")
    for verb in words[:1] if words and words[0] in VERBS else VERBS:
        import_module(f"chord_usd.faces.commands.{verb}").add(verbs)
    return parser


def _run(options: argparse.Namespace) -> Outcome:
    if options.debug:
        import logging

        logging.getLogger(__package__).setLevel(logging.DEBUG)
    else:
        warnings.simplefilter("ignore")
    with console.reserved(debug=options.debug), held_lines():
        try:
            outcome: Outcome = options.run(options)
        except ChordError:
            raise
        except Exception as error:
            from chord_usd.base.runtime.machine import machine_error

            plain = machine_error(error, str(getattr(options, "output", None) or ""))
            if plain is None:
                raise
            raise plain from error
    return outcome


def _tell(outcome: Outcome, *, as_json: bool) -> None:
    if not as_json:
        sys.stderr.writelines(f"warning: {warning}\n" for warning in outcome.warnings)
    sys.stderr.writelines(f"warning: {warning}\n" for warning in untrained_in_use())
    if outcome.text is None:
        return
    text = json.dumps(outcome.data) if as_json else outcome.text
    # A locale without "m²" is no reason to fail after all is done.
    encoding = sys.stdout.encoding or "utf-8"
    sys.stdout.write(text.encode(encoding, "backslashreplace").decode(encoding) + "\n")
    sys.stdout.flush()


def _fields_of(error: Exception) -> dict[str, Any]:
    """An error as JSON; its sentence, of one line, says what, where, expected and what to try."""
    if isinstance(error, ImportError):
        error = missing_extra(error, "this verb") or error
    if isinstance(error, OSError) and error.filename:
        reason = (error.strerror or "cannot be opened").lower()
        error = ChordError(reason, where=str(error.filename), try_="check the path")
    elif not isinstance(error, ChordError):
        what = f"unexpected {type(error).__name__}: {_short(str(error))}"
        error = ChordError(what, try_="<debug>")
    fields = error.as_json()
    # Users know nothing of the hidden folders in which their outputs are made.
    fields["sentence"] = _short(_HIDDEN.sub("", " ".join(fields["sentence"].split())))
    return fields


_HIDDEN = re.compile(r"\.chord-usd-\w+/(?:new/)?")


def _short(sentence: str) -> str:
    if len(sentence) <= LONGEST_ERROR:
        return sentence
    half = LONGEST_ERROR // 2
    return f"{sentence[:half]} [...] {sentence[-half:]}"


if __name__ == "__main__":
    sys.exit(main())
