"""The command line: a verb per step of the line.

Exit codes: 0 done; 1 ran, and a check did not hold; 2 the input or the command line is unusable,
told in one `error:` line on stderr; 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import traceback
import warnings
from collections.abc import Sequence
from typing import NoReturn

from chord_usd import __version__
from chord_usd.commands import (
    assets,
    batch,
    check,
    dataset,
    describe,
    diff,
    evaluate,
    export,
    farm,
    generate,
    graph,
    layout,
    plan,
    regenerate,
    render,
    stage,
    train,
)
from chord_usd.commands.common import Outcome, Parser, UsageError
from chord_usd.errors import ChordError
from chord_usd.progress import held_lines
from chord_usd.runtime import console
from chord_usd.runtime.offline import stay_offline

VERBS = (
    generate, plan, layout, graph, stage, render, batch, farm, check, describe, regenerate, export,
    diff, dataset, train, evaluate, assets,
)  # fmt: skip
"""In the order of the line, then the workshop."""

DONE, NOT_HELD, UNUSABLE, INTERRUPTED = 0, 1, 2, 130
TERMINATED = 143


class Interrupted(KeyboardInterrupt):
    """Ctrl-C.

    CPython 3.11 dies of SIGINT in place of returning our exit code when a KeyboardInterrupt, of
    that very type, once left an `exec` of source text: the way every dataclass is made.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line; returns the exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in words
    stay_offline()
    # Both end by way of the exception handlers, so that a stopped job leaves no half-written
    # output. Who started us with Ctrl-C ignored keeps it ignored.
    signal.signal(signal.SIGTERM, _terminate)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    try:
        options = build_parser().parse_args(words)
        outcome = _run(options)
        _tell(outcome, as_json=options.json)
        return DONE if outcome.holds else NOT_HELD
    except KeyboardInterrupt as error:
        sys.stderr.write(f"error: interrupted, {str(error) or 'nothing was written'}\n")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read stdout has seen enough; keep the interpreter from flushing into the pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        if debug:
            traceback.print_exc()
        sys.stderr.write(f"error: {_sentence(error)}\n")
        return UNUSABLE


def build_parser() -> Parser:
    """The whole command line."""
    parser = Parser(
        prog="chord-usd",
        description="A floor plan picture becomes a furnished, hierarchical OpenUSD house.",
        epilog="chord-usd VERB --help tells more of a verb.",
    )
    parser.add_argument("--version", action="version", version=f"chord-usd {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True, dest="verb")
    for verb in VERBS:
        verb.add(verbs)
    return parser


def _run(options: argparse.Namespace) -> Outcome:
    if not options.debug:
        warnings.simplefilter("ignore")
    with console.reserved(debug=options.debug), held_lines():
        outcome: Outcome = options.run(options)
    return outcome


def _tell(outcome: Outcome, *, as_json: bool) -> None:
    if not as_json:
        sys.stderr.writelines(f"warning: {warning}\n" for warning in outcome.warnings)
    text = json.dumps(outcome.data) if as_json else outcome.text
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _sentence(error: Exception) -> str:
    """One line that says what, where, expected and what to try."""
    if isinstance(error, ChordError):
        sentence = str(error)
    elif isinstance(error, OSError) and error.filename:
        reason = (error.strerror or "cannot be opened").lower()
        sentence = str(UsageError(reason, where=str(error.filename), try_="check the path"))
    elif isinstance(error, MemoryError):
        sentence = "out of memory. Try: a machine with more memory, or a smaller job"
    else:
        sentence = (
            f"unexpected {type(error).__name__}: {error}. "
            "Try: the same command with --debug, and report what it shows"
        )
    return " ".join(sentence.split())


def _terminate(signum: int, frame: object) -> NoReturn:
    raise SystemExit(TERMINATED)


def _interrupt(signum: int, frame: object) -> NoReturn:
    raise Interrupted


if __name__ == "__main__":
    sys.exit(main())
