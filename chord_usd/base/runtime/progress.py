"""Progress of long steps, reported on stderr: a bar, a line per step, or JSON.

Steps take a plain callable `progress(done, total)`; a Reporter makes one for each step.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal, Protocol

from chord_usd.base.runtime import console

Progress = Callable[[int, int], None]
"""Called with how many of how many parts are done."""

Warn = Callable[[str], None]
"""Called with what a user should know, a sentence."""

ProgressStyle = Literal["auto", "bar", "lines", "json", "openjd", "none"]
PROGRESS_STYLES: tuple[ProgressStyle, ...] = ProgressStyle.__args__  # type: ignore[attr-defined]


class Reporter(Protocol):
    """Reports the state of the work to a user."""

    def announce(self, line: str) -> None:
        """Say a sentence before long work."""

    def step(self, name: str) -> Progress:
        """Begin a step; the callable takes its progress."""

    def finish(self, name: str, seconds: float) -> None:
        """The step is done."""

    def stop(self) -> None:
        """The step broke off; leave the terminal in order."""


class Stopwatch:
    """Times the steps of a job and reports each."""

    def __init__(self, reporter: Reporter | None = None) -> None:
        self.seconds: dict[str, float] = {}
        """Seconds per step; a step that ran twice counts both."""
        self._reporter = reporter or SilentReporter()

    def announce(self, line: str) -> None:
        """Say a sentence before long work; nothing where it is empty."""
        if line:
            self._reporter.announce(line)

    @contextmanager
    def step(self, name: str) -> Iterator[Progress]:
        """Time a block; yields the progress callable to hand to whatever does the work."""
        started = time.perf_counter()
        try:
            yield self._reporter.step(name)
        except BaseException:
            self._reporter.stop()
            raise
        elapsed = time.perf_counter() - started
        self.seconds[name] = round(self.seconds.get(name, 0.0) + elapsed, 3)
        self._reporter.finish(name, elapsed)


class SilentReporter:
    """Says nothing."""

    def announce(self, line: str) -> None:
        pass

    def step(self, name: str) -> Progress:
        return _ignore

    def finish(self, name: str, seconds: float) -> None:
        pass

    def stop(self) -> None:
        pass


class JsonReporter(SilentReporter):
    """One JSON object per line, such as {"step": "layout", "done": 3, "total": 20}."""

    def __init__(self) -> None:
        self._done, self._total = 0, 1

    def step(self, name: str) -> Progress:
        self._done, self._total = 0, 1
        # Reported before anything is done, so that the reader knows the step.
        _say(json.dumps({"step": name, "done": 0, "total": 1}))

        def progress(done: int, total: int) -> None:
            self._done, self._total = done, total
            _say(json.dumps({"step": name, "done": done, "total": total}))

        return progress

    def finish(self, name: str, seconds: float) -> None:
        # Steps that are one piece of work still end with done == total.
        if self._done != self._total:
            _say(json.dumps({"step": name, "done": self._total, "total": self._total}))


class JobReporter(SilentReporter):
    """Messages of Open Job Description, by which a render farm follows a task."""

    def step(self, name: str) -> Progress:
        _say(f"openjd_status: {name}")
        reported = -1.0

        def progress(done: int, total: int) -> None:
            nonlocal reported
            percent = 100.0 * done / max(total, 1)
            if percent >= reported + 1.0:
                reported = percent
                _say(f"openjd_progress: {percent:.1f}")

        return progress

    def finish(self, name: str, seconds: float) -> None:
        _say("openjd_progress: 100.0")


class LineReporter(SilentReporter):
    """One line per finished step, and one now and then while it goes on, with the time left."""

    def announce(self, line: str) -> None:
        _say(line)

    def step(self, name: str) -> Progress:
        return _lines_of(name, lambda: True)

    def finish(self, name: str, seconds: float) -> None:
        _say(f"{name}: {seconds:.1f} s")


class HeldReporter(LineReporter):
    """As LineReporter, but lines wait until the verb has ended well, so that an error stands alone.

    A verb that takes longer than HOLD_SECONDS is followed live.
    """

    def __init__(self) -> None:
        self._live_from = time.monotonic() + HOLD_SECONDS

    def step(self, name: str) -> Progress:
        self._look_at_clock()
        line = _lines_of(name, self._is_live)

        def progress(done: int, total: int) -> None:
            self._look_at_clock()
            line(done, total)

        return progress

    def finish(self, name: str, seconds: float) -> None:
        _held.append(f"{name}: {seconds:.1f} s")
        self._look_at_clock()

    def _look_at_clock(self) -> None:
        if _held and self._is_live():
            _say_held()

    def _is_live(self) -> bool:
        return time.monotonic() >= self._live_from


QUIET_SECONDS = 5.0
"""Between the lines of a step: a house takes longer, a sampler's step less."""


def _lines_of(name: str, may_say: Callable[[], bool]) -> Progress:
    """Says a line where something was done and the last line is long ago."""
    started = said = time.monotonic()
    first: int | None = None

    def progress(done: int, total: int) -> None:
        nonlocal said, first
        now = time.monotonic()
        first = done if first is None else first
        if done <= first or done >= total or now - said < QUIET_SECONDS or not may_say():
            return
        said = now
        left_s = (now - started) / (done - first) * (total - done)
        _say(f"{name}: {done} of {total}, {_duration(left_s)} left")

    return progress


def _duration(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400.0 else f"{seconds / 3600:.1f} h"


HOLD_SECONDS = 60.0
_held: list[str] = []
"""Lines of the verb that runs."""


@contextmanager
def held_lines() -> Iterator[None]:
    """Around a verb: its lines that wait are said when it ends well, and dropped when it fails."""
    _held.clear()
    try:
        yield
        _say_held()
    finally:
        _held.clear()


def _say_held() -> None:
    for line in _held:
        _say(line)
    _held.clear()


class BarReporter(SilentReporter):
    """A progress bar per step, for terminals."""

    def __init__(self) -> None:
        self._bar: Any = None

    def announce(self, line: str) -> None:
        _say(line)

    def step(self, name: str) -> Progress:
        from tqdm import tqdm

        self._bar = bar = tqdm(
            total=1, desc=name, leave=True, file=console.stderr(), bar_format=_BAR
        )

        def progress(done: int, total: int) -> None:
            bar.total, bar.n = total, done
            bar.refresh()

        return progress

    def finish(self, name: str, seconds: float) -> None:
        self._bar.n = self._bar.total
        self._bar.close()

    def stop(self) -> None:
        self._bar.close()


_BAR = "{desc:>8} {percentage:3.0f}% |{bar:30}| {n_fmt}/{total_fmt} {elapsed}"


def make_reporter(style: ProgressStyle) -> Reporter:
    """The reporter of a style; auto is a bar on a terminal, and otherwise a line per step that is
    held back as HeldReporter does."""
    if style == "auto" and console.stderr().isatty():
        style = "bar"
    reporters: dict[str, type[Any]] = {
        "auto": HeldReporter,
        "bar": BarReporter,
        "lines": LineReporter,
        "json": JsonReporter,
        "openjd": JobReporter,
        "none": SilentReporter,
    }
    return reporters[style]()


def _ignore(done: int, total: int) -> None:
    pass


def _say(line: str) -> None:
    console.stderr().write(line + "\n")
    console.stderr().flush()
