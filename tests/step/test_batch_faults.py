"""Workers, drivers and disks that fail in the middle of a batch: nothing is lost or half done."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import batch_makers as makers
import pytest

from chord_usd.base.errors import OutputError
from chord_usd.base.runtime.targets import MANIFEST_FILE
from chord_usd.faces.batch.local import LocalEngine
from chord_usd.faces.batch.run import run_batch


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "houses"


def test_workers_may_die_without_harm_to_other_units(folder: Path) -> None:
    units = makers.units("a", "crash", "killed_once", "b")
    order = makers.order(folder)
    done = run_batch(units, order, LocalEngine(2), load=makers.troubled(folder))
    assert sorted(makers.made(folder)) == ["a", "b", "killed_once"]
    assert [result.unit.name for result in done.failures] == ["crash"]
    assert "died 3 times: SIGABRT" in done.failures[0].why
    assert sorted(path.name for path in folder.iterdir()) == [
        MANIFEST_FILE, "a", "assets", "b", "failures", "index.jsonl", "killed_once",
    ]  # fmt: skip


def test_a_disk_that_is_really_full(folder: Path) -> None:
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("may not mount a small disk")
    try:
        with pytest.raises(OutputError, match="1 of 2 houses were made"):
            makers.batch(folder, makers.units("a", "large"), makers.troubled)
        assert sorted(path.name for path in folder.iterdir()) == ["a", "assets"]
        # With space again, the rest is made.
        makers.batch(folder, makers.units("a", "b"))
        assert makers.made(folder) == ["a", "b"]
    finally:
        subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_a_batch_that_is_ended_goes_on_where_it_stopped(how: signal.Signals, folder: Path) -> None:
    """Its worker ends too, and is in the middle of a house."""
    with subprocess.Popen([sys.executable, "-c", DRIVER, str(folder)]) as driver:
        worker = wait_for(lambda: int((folder.parent / "worker.pid").read_text()))
        driver.send_signal(how)
    wait_for(lambda: not Path(f"/proc/{worker}").exists() or None)
    assert not (folder / "second").exists()
    half_written = list(folder.glob(".chord-usd-*"))
    assert len(half_written) == (1 if how == signal.SIGKILL else 0)
    done = makers.batch(folder, makers.units("first", "second"))
    assert [unit.name for unit in done.kept] == ["first"]
    assert makers.made(folder) == ["first", "second"]
    assert [path.name for path in folder.glob(".*")] == [MANIFEST_FILE]


DRIVER = f"""
import sys, signal
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parents[1])!r})
import batch_makers as makers
from chord_usd.faces.batch.local import LocalEngine
from chord_usd.faces.batch.run import run_batch
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
folder = Path(sys.argv[1])
units = makers.units("first", "second")
try:
    run_batch(units, makers.order(folder), LocalEngine(1), load=makers.slow(folder))
except KeyboardInterrupt:
    sys.exit(130)
"""


def wait_for(answer: Callable[[], Any]) -> Any:
    """What answer gives, once it gives anything."""
    for _ in range(600):
        with contextlib.suppress(OSError, ValueError):
            if (found := answer()) is not None:
                return found
        time.sleep(0.05)
    raise TimeoutError
