"""Command lines that a worker runs: the same files, words, codes and signals as without it."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime import resident
from chord_usd.base.terms import wording_for

pytestmark = pytest.mark.long

PLAN = Path(__file__).parents[1] / "fixtures" / "furnished_house.json"
READ = ("plan", "read", "plan.json", "-o")
SOON_S = 60.0

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def sockets(tmp_path: Path) -> Iterator[Path]:
    """A folder of sockets for this test alone; workers that still wait are ended."""
    folder = tmp_path / "run"
    folder.mkdir(mode=0o700)
    yield folder
    for worker in workers(folder):
        with contextlib.suppress(ProcessLookupError):  # it has ended by itself
            os.kill(worker, signal.SIGTERM)


@pytest.fixture
def work(tmp_path: Path) -> Path:
    folder = tmp_path / "work"
    folder.mkdir()
    shutil.copy(PLAN, folder / "plan.json")
    return folder


@pytest.fixture
def run(sockets: Path, work: Path) -> Run:
    def call(*words: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command(*words), cwd=work, env=environment(sockets, **more),
            capture_output=True, text=True, timeout=SOON_S, check=False,
        )  # fmt: skip

    return call


def command(*words: str) -> list[str]:
    return [sys.executable, "-P", "-m", "chord_usd", *words, "--progress", "none"]


def environment(sockets: Path, **more: str) -> dict[str, str]:
    return {**os.environ, resident.VARIABLE: "1", "XDG_RUNTIME_DIR": str(sockets), **more}


def workers(sockets: Path) -> list[int]:
    """Processes that load or wait for a command line of these sockets."""
    marks = (b"chord_usd.faces.worker", f"XDG_RUNTIME_DIR={sockets}".encode())
    running = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            words = (place / "cmdline").read_bytes().split(b"\0")
            given = (place / "environ").read_bytes().split(b"\0")
        except OSError:
            continue
        if marks[0] in words and marks[1] in given:
            running.append(int(place.name))
    return running


def waiting(sockets: Path) -> int:
    """The worker that takes the next command line, once it waits."""
    end = time.monotonic() + SOON_S
    while time.monotonic() < end:
        if any(place.is_socket() for place in sockets.iterdir()) and (running := workers(sockets)):
            return running[0]
        time.sleep(0.05)
    raise AssertionError("no worker came")


def is_over(process: int) -> bool:
    end = time.monotonic() + SOON_S
    while time.monotonic() < end:
        try:
            state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            return True
        if state == "Z":
            return True
        time.sleep(0.05)
    return False


def test_a_worker_runs_the_next_command_as_a_new_process_would(
    run: Run, sockets: Path, work: Path
) -> None:
    first = run(*READ, "a.json")
    worker = waiting(sockets)
    second = run(*READ, "b.json")
    assert is_over(worker)
    assert waiting(sockets) != worker
    assert (second.returncode, second.stderr) == (first.returncode, first.stderr)
    assert second.stdout == first.stdout.replace("a.json", "b.json")
    assert (work / "a.json").read_bytes() == (work / "b.json").read_bytes()


def test_errors_and_codes_come_from_the_worker(run: Run, sockets: Path) -> None:
    run(*READ, "a.json")
    worker = waiting(sockets)
    refused = run("plan", "read", "nowhere.json", "-o", "b.json")
    assert is_over(worker)
    assert refused.returncode == 2
    assert refused.stderr.startswith("error: ")
    assert "nowhere.json" in refused.stderr
    # The guard of a worker outlives it by a moment.
    assert all(is_over(process) for process in workers(sockets))


@pytest.mark.parametrize("more", [{"OMP_NUM_THREADS": "1"}, {"LC_ALL": "C"}])
def test_a_worker_of_another_environment_serves_nobody(
    more: dict[str, str], run: Run, sockets: Path, work: Path
) -> None:
    run(*READ, "a.json", OMP_NUM_THREADS="2")
    worker = waiting(sockets)
    assert run(*READ, "b.json", **more).returncode == 0
    assert is_over(worker)
    assert (work / "b.json").is_file()


def test_no_worker_is_used_or_started_where_it_is_not_wanted(run: Run, sockets: Path) -> None:
    assert run(*READ, "a.json", "--no-worker").returncode == 0
    assert run(*READ, "b.json", **{resident.VARIABLE: "0"}).returncode == 0
    assert not workers(sockets)
    assert not list(sockets.iterdir())


def test_a_folder_that_others_enter_is_not_used(run: Run, sockets: Path) -> None:
    sockets.chmod(0o755)
    assert run(*READ, "a.json").returncode == 0
    assert not workers(sockets)


def test_a_worker_that_is_killed_while_it_waits_is_replaced(
    run: Run, sockets: Path, work: Path
) -> None:
    run(*READ, "a.json")
    worker = waiting(sockets)
    os.kill(worker, signal.SIGKILL)
    assert is_over(worker)
    assert run(*READ, "b.json").returncode == 0
    assert (work / "b.json").is_file()
    assert waiting(sockets) != worker


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_signals_of_a_command_line_end_its_worker(
    how: signal.Signals, run: Run, sockets: Path, work: Path
) -> None:
    run(*READ, "a.json")
    worker = waiting(sockets)
    words = ("generate", "plan.json", "--steps", "1000", "-o", "house.usda")
    with subprocess.Popen(
        [*command(*words)[:-1], "json"], cwd=work, env=environment(sockets),
        stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stderr
        next(line for line in process.stderr if '"layout"' in line)
        process.send_signal(how)
        said = process.stderr.read()
        code = process.wait(SOON_S)
    assert is_over(worker)
    assert code == (-how if how == signal.SIGKILL else 128 + how)
    assert "Traceback" not in said
    assert sorted(place.name for place in work.iterdir()) == ["a.json", "plan.json"]


@pytest.mark.parametrize(("verb", "is_refused"), [("generate", False), ("edit", True)])
def test_a_worker_that_is_killed_at_work(
    verb: str, is_refused: bool, sockets: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A verb that leaves its input as it is runs again here; an edit might be made twice."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(sockets))
    monkeypatch.setenv(resident.VARIABLE, "1")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as door:
        door.bind(str(resident.address()))
        door.listen()

        def take_and_die() -> None:
            link, _ = door.accept()
            _, streams, _, _ = socket.recv_fds(link, 4, 3)
            link.sendall(resident.READY)
            while not link.recv(2**16).endswith(resident.GO):
                pass
            link.close()
            for stream in streams:
                os.close(stream)

        worker = threading.Thread(target=take_and_die)
        worker.start()
        if is_refused:
            said = pytest.raises(ChordError, match=r"killed.*--no-worker")
            with wording_for("command"), said:
                resident.run([verb, "house.usda"])
        else:
            assert resident.run([verb, "plan.json"]) is None
        worker.join(SOON_S)
