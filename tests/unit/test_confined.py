"""A confined call gives what a plain call gives, or one error; and it leaves nothing behind."""

from __future__ import annotations

import contextlib
import ctypes
import operator
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.errors import ChordError, PlanError
from chord_usd.base.runtime.confined import Limits, _cpu_s_of, confined
from chord_usd.line.plan.vector.safe_xml import parse_xml

pytestmark = pytest.mark.usefixtures("fresh_readers")

if sys.platform != "linux":
    pytest.skip("limits and signals as Linux has them", allow_module_level=True)

WHERE = "plan.pdf"
SOON_S, MOST_CPU_S = 60.0, 5.0
"""By the clock, on however busy a machine; of a child that is to end."""
ENDLESS = (3, 10**9)
"""Powers of three: minutes in C, during which the interpreter hears no signal."""

CALLER = f"""
import signal, sys
from chord_usd.base.runtime.confined import confined
def end(number, frame):
    print("told", flush=True)
    sys.exit(7)
for number in (signal.SIGTERM, signal.SIGINT):
    signal.signal(number, end)
print("started", flush=True)
confined(pow, *{ENDLESS}, where="x")
"""

values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@settings(max_examples=8)
@given(values)
def test_a_result_comes_back_as_it_is(value: object) -> None:
    assert confined(operator.itemgetter(0), [value], where=WHERE) == value


def test_a_large_array_comes_back_whole() -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (3000, 3000, 3), np.uint8)
    assert np.array_equal(confined(np.flipud, pixels, where=WHERE), pixels[::-1])


def test_own_errors_pass_through() -> None:
    with pytest.raises(PlanError) as plain:
        parse_xml(b"<a>", WHERE, "an SVG")
    with pytest.raises(PlanError) as caught:
        confined(parse_xml, b"<a>", WHERE, "an SVG", where="elsewhere")
    assert str(caught.value) == str(plain.value)
    assert vars(caught.value) == vars(plain.value)
    assert "safe_xml.py" in str(caught.value.__cause__), "--debug tells where it came from"


def test_errors_of_the_system_about_a_file_pass_through(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        confined(os.stat, tmp_path / "none", where=WHERE)
    assert caught.value.filename == str(tmp_path / "none")


@pytest.mark.parametrize(
    ("function", "arguments", "told"),
    [
        (int, ("x",), "cannot be read (ValueError"),
        (bytearray, (2**31,), "needs more than 1024 MiB of memory"),
        (ctypes.string_at, (0,), "made its reader crash"),
        (os.abort, (), "made its reader crash"),
        (os._exit, (0,), "made its reader crash"),
        (sys.exit, (0,), "made its reader crash"),
    ],
)
def test_whatever_goes_wrong_is_one_error_of_the_class_asked_for(
    function: object, arguments: tuple[object, ...], told: str
) -> None:
    with pytest.raises(PlanError) as caught:
        confined(function, *arguments, where=WHERE, error=PlanError)  # type: ignore[arg-type]
    assert str(caught.value).startswith(f"{WHERE}: {told}")
    assert "\n" not in str(caught.value)


def test_what_computes_too_long_is_ended() -> None:
    limits = Limits(cpu_s=1)
    began = os.times().children_user
    with pytest.raises(ChordError, match="more than 1 s of processor time"):
        confined(pow, *ENDLESS, where=WHERE, limits=limits)
    assert os.times().children_user - began < 3.0


def test_time_that_others_take_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    assert all(Limits(cpu_s=cpu_s).wall_s >= 10 * cpu_s for cpu_s in (1, 30, 100))
    confined(time.sleep, 1.5, where=WHERE, limits=Limits(cpu_s=1))
    monkeypatch.setattr("chord_usd.base.runtime.confined._WALL_PER_CPU", 1.5)
    with pytest.raises(ChordError, match=r"within 1.5 s \(its reader had 0 s .* is busy\. Try"):
        confined(time.sleep, 60.0, where=WHERE, limits=Limits(cpu_s=1))


def test_the_limit_counts_from_what_the_process_starts_with() -> None:
    limits = Limits(memory_bytes=200 * 2**20)
    assert confined(bytes.count, bytes(2**20), b"\0", where=WHERE, limits=limits) == 2**20
    assert len(confined(bytearray, 150 * 2**20, where=WHERE, limits=limits)) == 150 * 2**20
    with pytest.raises(ChordError, match="200 MiB"):
        confined(bytearray, 250 * 2**20, where=WHERE, limits=limits)


def test_chatter_is_dropped(capfd: pytest.CaptureFixture[str]) -> None:
    for stream in (1, 2):
        assert confined(os.write, stream, b"chatter", where=WHERE) == 7
    confined(print, "chatter", where=WHERE)
    assert capfd.readouterr() == ("", "")


def test_nothing_is_left_open() -> None:
    before = sorted(Path("/proc/self/fd").iterdir())
    children = children_of(os.getpid())
    for function, arguments in ((abs, (-1,)), (os.abort, ()), (int, ("x",))):
        with contextlib.suppress(ChordError):
            confined(function, *arguments, where=WHERE)  # type: ignore[operator]
    assert sorted(Path("/proc/self/fd").iterdir()) == before
    assert children_of(os.getpid()) == children


def test_threads_may_call_it_at_once() -> None:
    results: list[int] = []
    threads = [
        threading.Thread(target=lambda n=n: results.append(confined(abs, -n, where=WHERE)))
        for n in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(results) == list(range(6))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
@pytest.mark.parametrize("to_group", [False, True])
def test_signals_to_the_caller_end_both(number: signal.Signals, to_group: bool) -> None:
    caller = subprocess.Popen(
        [sys.executable, "-c", CALLER], stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    assert caller.stdout is not None
    with caller:
        assert caller.stdout.readline() == "started\n"
        child = busy_child(caller.pid)
        (os.killpg if to_group and number != signal.SIGKILL else os.kill)(caller.pid, number)
        said = caller.stdout.read()
        code = caller.wait(SOON_S)
        while lives(child):  # else its own limit would end it after 30 s
            assert (_cpu_s_of(child) or 0.0) < MOST_CPU_S, "it computes on"
            time.sleep(0.01)
    assert (code, said) == ((-9, "") if number == signal.SIGKILL else (7, "told\n"))


def children_of(pid: int) -> list[int]:
    lists = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for one in lists for child in one.read_text().split()]


def lives(pid: int) -> bool:
    """Whether a process runs; one that only waits for its new parent to take note does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def busy_child(pid: int) -> int:
    """The caller's child, once it computes."""
    end = time.monotonic() + SOON_S
    while time.monotonic() < end:
        for child in children_of(pid):
            if (_cpu_s_of(child) or 0.0) > 0.3:
                return child
        time.sleep(0.01)
    raise AssertionError("the caller started no child")
