"""Ctrl-C and SIGTERM: soon, in order, and with a true line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.confined import _cpu_s_of

VERB = """
import hashlib, os, signal, sys, time
from pathlib import Path
from chord_usd import cli
from chord_usd.faces.commands import describe
from chord_usd.base.runtime.files import deliver, write_atomic

def run(options):
    out = Path(sys.argv[-1])
{body}

describe.run = run
sys.argv[1:1] = ["describe"]
sys.exit(cli.main())
"""

AT_WORK = """
    with deliver() as delivery:
        delivery.place(out / "house.usda").write_text("half of it")
        print("ready", file=sys.__stderr__, flush=True)
        {work}
"""
LONG_IN_C = "hashlib.pbkdf2_hmac('sha512', b'', b'', 60_000_000)"
WORK_S = 60
IN_PYTHON = f"time.sleep({WORK_S})"
WITHOUT_PYTHON = "sum(range(10**11))"
HIDDEN_BY_A_LIBRARY = f"""
        try:
            time.sleep({WORK_S})
        except BaseException:
            raise ImportError("a library failed to import")
"""
AFTER_AN_OUTPUT = """
    write_atomic(out / "house.usda", "all of it")
    print("ready", file=sys.__stderr__, flush=True)
    time.sleep(60)
"""


def interrupted(body: str, how: signal.Signals, folder: Path) -> tuple[int, str, float]:
    """Exit code, standard error after "ready", and the processor time it took to end.

    On a busy machine the clock says little; but what sleeps for WORK_S is not waited for.
    """
    folder.mkdir()
    command = [sys.executable, "-c", VERB.format(body=body), str(folder)]
    # Its own standard error is taken while a verb runs, so what says "ready" is another one.
    reading, writing = os.pipe()
    ready = body.replace("file=sys.__stderr__", f"file=os.fdopen({writing}, 'w')")
    command[2] = VERB.format(body=ready)
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, pass_fds=[writing]
    ) as process:
        os.close(writing)
        assert os.read(reading, 5) == b"ready"
        os.close(reading)
        time.sleep(0.3)  # until the work that follows has begun
        had_s, started = _cpu_s_of(process.pid) or 0.0, time.monotonic()
        process.send_signal(how)
        assert process.stderr
        told = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert time.monotonic() - started < 0.8 * WORK_S
    return process.returncode, told, used.ru_utime + used.ru_stime - had_s


@pytest.mark.parametrize("work", [IN_PYTHON, LONG_IN_C, HIDDEN_BY_A_LIBRARY])
@pytest.mark.parametrize(
    ("how", "code", "word"),
    [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")],
)
def test_a_verb_ends_soon_and_leaves_nothing(
    work: str, how: signal.Signals, code: int, word: str, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    ended = interrupted(AT_WORK.format(work=work), how, out)
    assert ended[:2] == (code, f"error: {word}, nothing was written\n")
    assert ended[2] < 2.0 + interrupts.STUBBORN_S * (work == LONG_IN_C)
    assert list(out.iterdir()) == []


def test_a_library_that_lets_no_thread_run_is_ended_too(tmp_path: Path) -> None:
    code, _, took_s = interrupted(
        AT_WORK.format(work=WITHOUT_PYTHON), signal.SIGTERM, tmp_path / "o"
    )
    assert code == -signal.SIGKILL
    assert took_s < 12.0
    assert not (tmp_path / "o" / "house.usda").exists()


def test_what_was_written_is_told(tmp_path: Path) -> None:
    out = tmp_path / "out"
    code, told, _ = interrupted(AFTER_AN_OUTPUT, signal.SIGINT, out)
    assert code == 130
    assert told == f"error: interrupted, after {out / 'house.usda'} was written\n"
    assert (out / "house.usda").read_text() == "all of it"


def test_an_interrupt_waits_while_outputs_take_their_places(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    monkeypatch.setattr(interrupts, "_came", [])
    done = False
    try:
        interrupts.obey()
        with pytest.raises(interrupts.Terminated), interrupts.held():
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.05)
            done = True
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert done
    assert interrupts.came() is interrupts.Terminated
