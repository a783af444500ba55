"""What a page asks for, one after the other: a queue that outlives the browser, not the server.

One job at a time: a verb uses all cores by itself. A job's file says how it stands, so that a
server that was killed in the middle can say so when it starts again.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
from collections import deque
from collections.abc import Awaitable, Callable
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.files import write_atomic

MOST_WAITING = 100
MOST_KEPT = 200
"""Jobs that are done are remembered so long."""


class BusyError(ChordError):
    """Too much is asked for at once."""


State = Literal["queued", "running", "done", "failed", "cancelled", "ended"]
"""ended: the server ended while it was queued or running."""

OVER = ("done", "failed", "cancelled", "ended")


@dataclass
class Job:
    """One thing that was asked for."""

    house: str
    kind: str
    given: dict[str, Any]
    id: str = field(default_factory=lambda: secrets.token_hex(6))
    made: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="milliseconds"))
    state: State = "queued"
    step: str = ""
    done: int = 0
    total: int = 1
    error: str = ""
    code: str = ""
    """Of the error (ChordError.code)."""
    answer: dict[str, Any] = field(default_factory=dict)

    def told(self) -> dict[str, Any]:
        """For the page and for the job's file."""
        return asdict(self)


Work = Callable[[Job], Awaitable[dict[str, Any]]]
"""Does a job; returns its answer. Raises ChordError."""


class JobQueue:
    """Jobs of all houses, in the order in which they were asked for."""

    def __init__(self, folder: Path, work: Work) -> None:
        self._folder, self._work = folder, work
        self._jobs: dict[str, Job] = {}
        self._waiting: deque[Job] = deque()
        self._more = asyncio.Event()
        self._current: tuple[Job, asyncio.Task[None]] | None = None
        self._loop: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Take up what an earlier server left, and begin."""
        self._folder.mkdir(exist_ok=True)
        for file in self._folder.glob("*.json"):
            with contextlib.suppress(OSError, ValueError, TypeError):
                job = Job(**json.loads(file.read_text()))
                if job.state not in OVER:
                    job.state, job.error = "ended", "the server ended before this was done"
                    self._keep(job)
                self._jobs[job.id] = job
        self._jobs = dict(sorted(self._jobs.items(), key=lambda pair: pair[1].made))
        self._loop = asyncio.create_task(self._run())

    async def stop(self) -> None:
        """End the job at work, in order; it and those that wait are said to have ended."""
        for job in [*self._waiting, *([self._current[0]] if self._current else [])]:
            job.state, job.error = "ended", "the server was ended"
            self._keep(job)
        tasks = [self._current[1] if self._current else None, self._loop]
        for task in filter(None, tasks):
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task

    def require_place(self) -> None:
        """Raises BusyError where too many jobs wait."""
        if len(self._waiting) >= MOST_WAITING:
            raise BusyError(f"{MOST_WAITING} jobs are waiting", try_="again when some are done")

    def submit(
        self, house: str, kind: str, given: dict[str, Any], *, is_follow_up: bool = False
    ) -> Job:
        """Put a job at the end. Raises BusyError where too many wait.

        is_follow_up: of a job that is at work, which always finds a place.
        """
        if not is_follow_up:
            self.require_place()
        job = Job(house, kind, given)
        self._jobs[job.id] = job
        self._keep(job)
        self._waiting.append(job)
        self._more.set()
        self._forget()
        return job

    def of(self, house: str) -> list[Job]:
        """Jobs of a house, the earliest first."""
        return [job for job in self._jobs.values() if job.house == house]

    def get(self, job_id: str) -> Job | None:
        return self._jobs.get(job_id)

    def ahead_of(self, job: Job) -> int:
        """How many jobs are done before this one is begun."""
        if job not in self._waiting:
            return 0
        return self._waiting.index(job) + (self._current is not None)

    def cancel(self, job: Job) -> None:
        """Take a job off the queue, or end what it runs; nothing half-written stays."""
        if job in self._waiting:
            self._waiting.remove(job)
            job.state = "cancelled"
            self._keep(job)
        elif self._current and self._current[0] is job:
            job.state = "cancelled"
            self._current[1].cancel()

    def cancel_of(self, house: str) -> None:
        """Cancel all jobs of a house."""
        for job in self.of(house):
            self.cancel(job)

    async def _run(self) -> None:
        while True:
            await self._more.wait()
            if not self._waiting:
                self._more.clear()
                continue
            job = self._waiting.popleft()
            task = asyncio.create_task(self._do(job))
            self._current = job, task
            try:
                await asyncio.wait([task])
            finally:
                self._current = None

    async def _do(self, job: Job) -> None:
        job.state = "running"
        self._keep(job)
        try:
            job.answer = await self._work(job)
            job.state = "done"
        except asyncio.CancelledError:
            if job.state == "running":
                job.state = "cancelled"
        except ChordError as error:
            job.state, job.error, job.code = "failed", error.sentence("page"), error.code
        except Exception as error:  # one job's bug must not end the queue
            job.state, job.error = "failed", f"unexpected {type(error).__name__}: {error}"[:600]
        self._keep(job)

    def _keep(self, job: Job) -> None:
        # On a full disk the job still runs; only its memory is lost.
        with contextlib.suppress(ChordError, OSError):
            write_atomic(self._folder / f"{job.id}.json", json.dumps(job.told()))

    def _forget(self) -> None:
        over = [job for job in self._jobs.values() if job.state in OVER]
        for job in over[: max(len(self._jobs) - MOST_KEPT, 0)]:
            del self._jobs[job.id]
            (self._folder / f"{job.id}.json").unlink(missing_ok=True)
