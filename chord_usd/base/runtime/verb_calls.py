"""A verb, run for an agent or a page: in a process of its own, with progress, ended at will.

A process costs a second or more for each call, and gives what tools in one process lack: a signal
ends a call without half-written output, two houses are worked on at once, a crash is one error.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import anyio
from anyio.abc import ByteReceiveStream, Process
from anyio.streams.text import TextReceiveStream

from chord_usd.base.errors import ChordError, WordedError
from chord_usd.base.runtime import resident
from chord_usd.base.runtime.locations import ROOT_VARIABLE
from chord_usd.base.terms import VARIABLE

END_S = 10.0
"""How long a verb may take to end after the signal; Blender is the slowest."""

LONGEST_WORD_BYTES = 2**16
"""Of one word of a command line; Linux takes twice as much."""

ReportProgress = Callable[[str, int, int], Awaitable[None]]
"""Takes the name of a step, and how many of how many parts of it are done."""


@dataclass(frozen=True)
class Answer:
    """What a verb has answered."""

    data: dict[str, Any]
    """As --json has it."""
    holds: bool
    """False for exit code 1."""


def require_words(words: Sequence[str]) -> None:
    """Raises ChordError for words that no process can be started with."""
    for word in words:
        if "\0" in word or any("\ud800" <= character <= "\udfff" for character in word):
            what, expected = "holds half a character, or none (NUL)", "text"
        elif len(word.encode()) > LONGEST_WORD_BYTES:
            what, expected = "is too long", f"at most {LONGEST_WORD_BYTES} bytes"
        else:
            continue
        shown = word.encode("utf-8", "backslashreplace").decode()
        raise ChordError(what, where=shown[:40], expected=expected)


async def run_verb(
    words: Sequence[str], root: Path, report: ReportProgress, surface: str = "agent"
) -> Answer:
    """One command line, run in root, which is all of the disk that stages may refer to.

    surface: whose terms messages are worded in. Raises ChordError with the verb's own sentence.
    """
    require_words(words)
    # -P: no file in the root replaces a module.
    command = [sys.executable, "-P", "-m", "chord_usd", *words, "--json", "--progress", "json"]
    process = await anyio.open_process(
        command,
        stdin=subprocess.DEVNULL,
        cwd=root,
        env={**os.environ, ROOT_VARIABLE: str(root), resident.VARIABLE: "0", VARIABLE: surface},
    )
    assert process.stdout is not None
    assert process.stderr is not None
    answer: list[str] = []
    said: list[str] = []
    try:
        async with anyio.create_task_group() as both:
            both.start_soon(_read, process.stdout, answer)
            both.start_soon(_follow, process.stderr, report, said)
        code = await process.wait()
    except BaseException:
        await _end(process)
        raise
    finally:
        with anyio.CancelScope(shield=True):
            await process.aclose()
    return answer_of(words[0], code, "".join(answer), said)


def answer_of(verb: str, code: int, answer: str, said: Sequence[str]) -> Answer:
    """The answer of a verb that ended with a code. Raises its error, as it was worded there."""
    if code not in (0, 1):
        errors = [line.removeprefix("error: ") for line in said if line.startswith("error: ")]
        worded = [json.loads(line)["error"] for line in said if line.startswith('{"error"')]
        sentence = errors[-1] if errors else f"{verb} broke off (code {code})"
        raise WordedError({"sentence": sentence, **(worded[-1] if worded else {})})
    return Answer(json.loads(answer), code == 0)


async def _read(stream: ByteReceiveStream, into: list[str]) -> None:
    async for part in TextReceiveStream(stream, errors="replace"):
        into.append(part)


async def _follow(stream: ByteReceiveStream, report: ReportProgress, said: list[str]) -> None:
    """Report progress; other lines go to said."""
    rest = ""
    async for part in TextReceiveStream(stream, errors="replace"):
        *lines, rest = (rest + part).split("\n")
        for line in lines:
            if line.startswith('{"step"'):
                step = json.loads(line)
                await report(step["step"], step["done"], step["total"])
            else:
                said.append(line)


async def _end(process: Process) -> None:
    """End a verb in order, as Ctrl-C does, and otherwise at once."""
    if process.returncode is not None:
        return
    process.terminate()
    with anyio.CancelScope(shield=True), anyio.move_on_after(END_S):
        await process.wait()
    if process.returncode is None:
        process.kill()
