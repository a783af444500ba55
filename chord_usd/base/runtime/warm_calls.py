"""Verbs that wait in one process with everything loaded, for a page: the next one begins at once.

One command line at a time, in a process that lives on (standby.py). What verb_calls says
of a process for each call still holds where it counts: to cancel ends the process, a crash is one
error, and the next call has a new one. After some time without a call it ends: an idle page takes
little memory.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Sequence
from pathlib import Path

from chord_usd.base.runtime.locations import ROOT_VARIABLE
from chord_usd.base.runtime.verb_calls import (
    END_S,
    Answer,
    ReportProgress,
    answer_of,
    require_words,
    run_verb,
)
from chord_usd.base.terms import VARIABLE

WARM = ("plan", "generate", "regenerate", "edit", "check", "assets", "export")
"""Verbs that are run here; Blender, and what is asked for seldom, gets a process of its own."""

IDLE_S = 120.0
MOST_CALLS = 50
"""Libraries keep some memory of each house."""

MOST_BYTES = 2**26
"""Of an answer, which is read when it is whole."""


class WarmVerbs:
    """Runs verbs as run_verb does, the verbs of WARM in a process that is there already."""

    def __init__(self) -> None:
        self._process: Process | None = None
        self._calls = 0
        self._busy = asyncio.Lock()
        self._idle: asyncio.TimerHandle | None = None

    async def __call__(self, words: Sequence[str], root: Path, report: ReportProgress) -> Answer:
        """One command line, run in root. Raises ChordError with the verb's own sentence."""
        require_words(words)
        if words[0] not in WARM or self._busy.locked():
            return await run_verb(words, root, report, "page")
        async with self._busy:
            process = await self._started(root)
            self._calls += 1
            try:
                code, answer, said = await _run(process, words, report)
            except BaseException:
                await self._end()
                raise
            if process.returncode is not None or self._calls >= MOST_CALLS:
                await self._end()
            self._rest()
        return answer_of(words[0], code, answer, said)

    async def warm(self, root: Path) -> None:
        """Begin to load, unless that is done: a call will soon follow."""
        if not self._busy.locked():
            async with self._busy:
                await self._started(root)
                self._rest()

    async def end(self) -> None:
        """End the process."""
        async with self._busy:
            await self._end()

    async def _started(self, root: Path) -> Process:
        if self._idle:
            self._idle.cancel()
        if self._process is None or self._process.returncode is not None:
            self._calls = 0
            # -P: no file in the root replaces a module.
            self._process = await asyncio.create_subprocess_exec(
                sys.executable, "-P", "-m", "chord_usd.faces.standby",
                stdin=PIPE, stdout=PIPE, stderr=PIPE, limit=MOST_BYTES, cwd=root,
                env={**os.environ, ROOT_VARIABLE: str(root), VARIABLE: "page"},
            )  # fmt: skip
        return self._process

    def _rest(self) -> None:
        """Wait for the next call, not for ever."""
        if self._idle:
            self._idle.cancel()

        def end() -> None:
            if not self._busy.locked():
                self._ending = asyncio.ensure_future(self.end())

        self._idle = asyncio.get_running_loop().call_later(IDLE_S, end)

    async def _end(self) -> None:
        process, self._process = self._process, None
        if self._idle:
            self._idle.cancel()
        if process is None or process.returncode is not None:
            return
        with contextlib.suppress(ProcessLookupError):
            process.terminate()
        try:
            await asyncio.wait_for(asyncio.shield(process.wait()), END_S)
        except TimeoutError:
            pass
        finally:
            if process.returncode is None:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()


async def _run(
    process: Process, words: Sequence[str], report: ReportProgress
) -> tuple[int, str, list[str]]:
    """Exit code, answer, and what was said besides progress."""
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    line = {"words": [*words, "--json", "--progress", "json"]}
    said: list[str] = []
    with contextlib.suppress(ConnectionError):
        process.stdin.write(json.dumps(line).encode() + b"\n")
        await process.stdin.drain()
    async for raw in process.stderr:
        text = raw.decode(errors="replace").rstrip("\n")
        if not text.startswith('{"step"') and not text.startswith('{"over"'):
            said.append(text)
            continue
        step = json.loads(text)
        if "over" in step:
            code = int(step["over"])
            answer = await process.stdout.readline() if code in (0, 1) else b""
            return code, answer.decode(errors="replace"), said
        await report(step["step"], step["done"], step["total"])
    code = await process.wait()
    # Whoever ends by itself in the middle has not answered.
    return code if code not in (0, 1) else -1, "", said
