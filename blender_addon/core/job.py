"""One run of chord-usd beside Blender: started, watched, cancelled."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import IO, Any

from .program import clean_environment

CANCEL_GRACE_S = 5.0
"""How long a cancelled program may take to clean up after itself."""

DONE, CHECK_FAILED, INTERRUPTED = 0, 1, 130
"""The program's exit codes; all others are failures that it has put into words."""


@dataclass(frozen=True)
class Progress:
    """Where the program stands."""

    step: str
    done: int
    total: int

    @property
    def share(self) -> float:
        """Of this step, 0 to 1."""
        return min(1.0, self.done / self.total) if self.total > 0 else 0.0


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    data: dict[str, Any] | None
    """What the program reports, where it ran to its end."""
    error: str = ""
    """Why it did not, in one sentence."""
    cancelled: bool = False


@dataclass
class Job:
    """A running program. poll() is cheap: a timer may call it many times a second."""

    command: Sequence[str]
    progress: Progress | None = None
    outcome: Outcome | None = None
    _process: subprocess.Popen[str] | None = field(default=None, repr=False)
    _lines: queue.Queue[str] = field(default_factory=queue.Queue, repr=False)
    _said: list[str] = field(default_factory=list, repr=False)
    _answer: list[str] = field(default_factory=list, repr=False)
    _threads: list[threading.Thread] = field(default_factory=list, repr=False)
    _cancelled: bool = False

    def start(self) -> None:
        """Start the program; a program that cannot be started ends at once with an error."""
        # Its own process group, so that cancelling reaches the programs that it starts, too.
        own_group: dict[str, Any] = (
            {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
            if sys.platform == "win32"
            else {"start_new_session": True}
        )
        try:
            self._process = subprocess.Popen(
                list(self.command),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                errors="replace",
                env=clean_environment(os.environ),
                **own_group,
            )
        except OSError as error:
            reason = error.strerror or type(error).__name__
            self.outcome = Outcome(None, f"{self.command[0]} cannot be started: {reason}")
            return
        self._follow(self._process.stderr, self._lines.put)
        self._follow(self._process.stdout, self._answer.append)

    def poll(self) -> bool:
        """Take in what was said since; True while the program runs."""
        self._take_in()
        if self.outcome is not None or self._process is None:
            return False
        if self._process.poll() is None:
            return True
        for thread in self._threads:
            thread.join()
        self._take_in()
        self.outcome = self._ended(self._process.returncode)
        return False

    def cancel(self) -> None:
        """Ask the program to stop, as Ctrl-C does: it leaves nothing half-written behind."""
        self._cancelled = True
        if self._process is None or self._process.poll() is not None:
            return
        self._signal(getattr(signal, "CTRL_BREAK_EVENT", signal.SIGINT))
        reaper = threading.Timer(CANCEL_GRACE_S, self._kill)
        reaper.daemon = True
        reaper.start()

    def wait(self, timeout_s: float) -> Outcome:
        """For scripts and tests: poll until the end. Raises TimeoutError."""
        if self._process is not None:
            try:
                self._process.wait(timeout_s)
            except subprocess.TimeoutExpired as error:
                raise TimeoutError(f"still running after {timeout_s} s") from error
        self.poll()
        assert self.outcome is not None
        return self.outcome

    def _follow(self, stream: IO[str] | None, take: Callable[[str], None]) -> None:
        def read() -> None:
            for line in stream or ():
                take(line)

        thread = threading.Thread(target=read, daemon=True)
        thread.start()
        self._threads.append(thread)

    def _take_in(self) -> None:
        while not self._lines.empty():
            self._take(self._lines.get())

    def _take(self, line: str) -> None:
        text = line.strip()
        if not text:
            return
        try:
            message = json.loads(text)
            self.progress = Progress(
                str(message["step"]), int(message["done"]), int(message["total"])
            )
        except (ValueError, KeyError, TypeError):
            self._said.append(text)

    def _ended(self, code: int) -> Outcome:
        if self._cancelled:
            return Outcome(None, cancelled=True)
        if code in (DONE, CHECK_FAILED):
            report = last_report(self._answer)
            if report is None:
                return Outcome(None, "the program ended without a report")
            return Outcome(report)
        if code == INTERRUPTED:
            return Outcome(None, "the program was interrupted from outside")
        if code < 0:
            return Outcome(None, f"the program was killed (signal {-code})")
        return Outcome(None, plain_error(self._said) or f"the program failed (exit code {code})")

    def _signal(self, number: int) -> None:
        assert self._process is not None
        try:
            if sys.platform == "win32":
                self._process.send_signal(number)
            else:
                os.killpg(self._process.pid, number)
        except ProcessLookupError:
            pass

    def _kill(self) -> None:
        if self._process is not None and self._process.poll() is None:
            self._signal(getattr(signal, "SIGKILL", signal.SIGTERM))


def last_report(lines: Sequence[str]) -> dict[str, Any] | None:
    """The last line that is a JSON object; Blender says other things before and after it."""
    for line in reversed(lines):
        try:
            report = json.loads(line)
        except ValueError:
            continue
        if isinstance(report, dict):
            return report
    return None


def plain_error(lines: Sequence[str]) -> str:
    """The program's own last `error:` line without that word; the last line where there is none."""
    for line in reversed(lines):
        if line.startswith("error:"):
            return line.removeprefix("error:").strip()
    return lines[-1] if lines else ""
