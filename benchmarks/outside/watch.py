"""Runs of the command line under watch: what they say, what they take, what they change.

Two ways: whole(), a process of its own, as a user starts it; and Server, one process that runs many
command lines one after another, which is twenty times as fast. Both measure the same.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import select
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from chord_usd.base.runtime import resident
from chord_usd.base.runtime.targets import hash_file

CODES = (0, 1, 2)
LONGEST_S = 60.0
"""Of processor time: on a busy machine a run gets a small share of a core, and is as good."""
LONGEST_WALL_S = 300.0
"""Without an end in this time, a run waits for something that does not come."""
MOST_BYTES = 2**30

_ERROR = re.compile(r"error: [^\n]+\n")
_MEMORY = re.compile(r"^Vm(?:HWM|RSS):\s*(\d+) kB", re.MULTILINE)
_LOOK_S = 0.05
_SERVER = Path(__file__).with_name("server.py")


@dataclass(frozen=True)
class Run:
    """One command line and what came of it."""

    words: tuple[str, ...]
    code: int | None
    """None where it was stopped after LONGEST_S or LONGEST_WALL_S."""
    told: str
    """Standard error."""
    wall_s: float
    cpu_s: float
    """Of it and of the processes that it started."""
    grown_bytes: int
    """The most resident memory of one process of it, above what it had at the start."""

    def faults(self) -> list[str]:
        """What is wrong with it, in words; none for a good run, whatever it answered."""
        found = []
        if self.code is None or self.cpu_s > LONGEST_S:
            found.append(f"took {self.wall_s:.0f} s ({self.cpu_s:.0f} s of computing)")
        elif self.code not in CODES:
            found.append(f"exit code {self.code}")
        if "Traceback" in self.told:
            found.append("a traceback")
        if re.search(r"error: unexpected|\bunexpected [A-Z]\w*(?:Error|Exception)\b", self.told):
            found.append("an unexpected error")
        if self.code == 2 and not _ERROR.fullmatch(self.told):
            found.append("standard error is not one error line")
        if self.grown_bytes > MOST_BYTES:
            found.append(f"took {self.grown_bytes / 2**30:.2f} GiB")
        return found


def whole(words: Sequence[str], cwd: Path, env: Mapping[str, str]) -> Run:
    """Run a command line in a process of its own, whose memory at the start is next to nothing."""
    start = time.monotonic()
    with subprocess.Popen(
        [sys.executable, "-m", "chord_usd.cli", *words],
        cwd=cwd, env={**env, resident.VARIABLE: "0"},
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        start_new_session=True,
    ) as process:  # fmt: skip
        peaks = _Peaks(process.pid, with_itself=True)
        told = _read(process, start, peaks)
        if told is None:
            _end(process)
            return Run(tuple(words), None, "", time.monotonic() - start, peaks.cpu_s, peaks.highest)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    spent = usage.ru_utime + usage.ru_stime
    return Run(tuple(words), process.returncode, told, time.monotonic() - start, spent,
               peaks.highest)  # fmt: skip


def _read(process: subprocess.Popen[bytes], start: float, peaks: _Peaks) -> str | None:
    """All of standard error; None where it did not end in time."""
    parts: list[bytes] = []
    assert process.stderr
    while not peaks.is_over(start):
        peaks.look()
        if select.select([process.stderr], [], [], _LOOK_S)[0]:
            part = os.read(process.stderr.fileno(), 2**16)
            if not part:
                return b"".join(parts).decode("utf-8", "backslashreplace")
            parts.append(part)
    return None


class _Peaks:
    """The most resident memory of one of the processes below another, and the processor time of
    all, from /proc (Linux).

    The kernel keeps each process's peak, so that looking now and then misses only what a process
    takes in its last moment. The figure of wait4 would count what its parent had at the fork. For
    the same reason a fork counts from what it has when it is first seen.
    """

    def __init__(self, pid: int, *, with_itself: bool) -> None:
        self._pid, self._with_itself = pid, with_itself
        self._starts: dict[tuple[int, bytes], int] = {}
        self.highest = 0
        self._cpu_before_s = self._cpu_all_s = _cpu_s(pid)

    @property
    def cpu_s(self) -> float:
        """Processor time since the start, at the last look."""
        return self._cpu_all_s - self._cpu_before_s

    def is_over(self, start: float) -> bool:
        """Whether a run that began at start has had its time."""
        return self.cpu_s > LONGEST_S or time.monotonic() - start > LONGEST_WALL_S

    def look(self) -> None:
        """Look at all of them."""
        pending = [(self._pid, b"")]
        self._cpu_all_s = 0.0
        while pending:
            pid, parent = pending.pop()
            with contextlib.suppress(OSError, ValueError):
                process = Path(f"/proc/{pid}")
                command = (process / "cmdline").read_bytes()
                self._cpu_all_s += _cpu_s(pid)
                for task in (process / "task").iterdir():
                    children = (task / "children").read_text().split()
                    pending += [(int(child), command) for child in children]
                if pid != self._pid or self._with_itself:
                    self._count(pid, command, (process / "status").read_text(), command == parent)

    def _count(self, pid: int, command: bytes, status: str, is_fork: bool) -> None:
        found = _MEMORY.findall(status)
        if len(found) == 2:
            peak, now = (int(kilobytes) * 1024 for kilobytes in found)
            start = self._starts.setdefault((pid, command), now if is_fork else 0)
            self.highest = max(self.highest, peak - start)


def _cpu_s(pid: int) -> float:
    """Processor time of a process and of the children that it waited for."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def _end(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that we started, and its group, which it leads."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


class Server:
    """One process that runs command lines; started again after a crash and after many runs."""

    def __init__(self, cwd: Path, env: Mapping[str, str], most_runs: int = 500) -> None:
        self._cwd, self._env, self._most_runs = cwd, dict(env), most_runs
        self._process: subprocess.Popen[bytes] | None = None
        self._runs = 0

    def run(self, words: Sequence[str], env: Mapping[str, str] | None = None) -> Run:
        """Run a command line, or a function `call MODULE:FUNCTION PATH`. env: beside its own."""
        process = self._started()
        self._runs += 1
        assert process.stdin
        assert process.stdout
        start = time.monotonic()
        request = json.dumps({"words": list(words), "env": dict(env or {})})
        process.stdin.write(request.encode() + b"\n")
        process.stdin.flush()
        peaks = _Peaks(process.pid, with_itself=False)
        while not select.select([process.stdout], [], [], _LOOK_S)[0]:
            peaks.look()
            if peaks.is_over(start):
                self.close(kill=True)
                wall_s = time.monotonic() - start
                return Run(tuple(words), None, "", wall_s, peaks.cpu_s, peaks.highest)
        answer = process.stdout.readline()
        wall_s = time.monotonic() - start
        if not answer:
            self.close(kill=True)
            return Run(tuple(words), process.returncode, "the process crashed", wall_s, 0.0, 0)
        told = json.loads(answer)
        if self._runs >= self._most_runs:
            self.close()
        grown = max(told["grown"], peaks.highest)
        return Run(tuple(words), told["code"], told["told"], wall_s, told["cpu_s"], grown)

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            self._runs = 0
            self._process = subprocess.Popen(
                [sys.executable, str(_SERVER)], cwd=self._cwd, env=self._env,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                start_new_session=True,
            )  # fmt: skip
        return self._process

    def close(self, *, kill: bool = False) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is None:
            return
        if kill:
            _end(process)
        assert process.stdin
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            _end(process)
        assert process.stdout
        process.stdout.close()


# Files --------------------------------------------------------------------------------------------

Look = dict[str, tuple[object, ...]]


def look(folder: Path, but: Iterable[Path] = ()) -> Look:
    """Every file, folder and link below a folder, but for some places and what is in them.

    Of a file: its kind and rights, size, times, and a hash of what is in it.
    """
    left_out = set(but)
    found: Look = {}
    pending = [folder]
    while pending:
        with os.scandir(pending.pop()) as entries:
            for entry in entries:
                path = Path(entry.path)
                if path in left_out:
                    continue
                found[os.fsdecode(os.path.relpath(path, folder))] = _seen(entry)
                if entry.is_dir(follow_symlinks=False):
                    pending.append(path)
    return found


def _seen(entry: os.DirEntry[str]) -> tuple[object, ...]:
    status = entry.stat(follow_symlinks=False)
    if entry.is_symlink():
        return "link", os.readlink(entry.path)  # noqa: PTH115
    mode = stat.filemode(status.st_mode)
    if not stat.S_ISREG(status.st_mode):
        return (mode,)
    key = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
    if key not in _hashes:
        _hashes[key] = hash_file(Path(entry.path))
    return mode, status.st_size, _hashes[key]


_hashes: dict[tuple[int, ...], str] = {}
"""By inode and times: nobody can set the time of the last change of an inode by hand."""


def changes(before: Look, after: Look) -> list[str]:
    """What came, went or is another, in words."""
    return [
        f"{'made' if name not in before else 'gone' if name not in after else 'changed'}: {name!r}"
        for name in sorted(before.keys() | after.keys())
        if before.get(name) != after.get(name)
    ]
