"""Slurm on this machine alone, for the tests: its daemons, ended when the test ends."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

_PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")
_STARTS_S = 60.0
_ENDS_S = 10.0

_CONFIG = """\
ClusterName=here
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=2,batch_sched_delay=0
ReturnToService=2
KillWait=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=16000
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


@contextmanager
def slurm_here() -> Iterator[dict[str, str]]:
    """The environment in which sbatch and its like reach a cluster of one node with two cores."""
    missing = [name for name in _PROGRAMS if shutil.which(name, path=_path()) is None]
    if missing or os.geteuid() != 0:
        pytest.skip(f"Slurm wants root, and the packages slurm-wlm and munge ({missing})")
    # A socket's path has 107 letters at most: not below pytest's folders.
    with tempfile.TemporaryDirectory(prefix="slurm-") as name, ExitStack() as running:
        folder = Path(name)
        environment = {**os.environ, "PATH": _path(), "SLURM_CONF": str(folder / "slurm.conf")}
        _configure(folder)
        for command in _daemons(folder):
            running.enter_context(_daemon(command, environment, folder))
        _wait_until_idle(environment, folder)
        yield environment


def _path() -> str:
    return os.pathsep.join([os.environ["PATH"], "/usr/sbin"])


def _configure(folder: Path) -> None:
    for name in ("state", "spool"):
        (folder / name).mkdir()
    with ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(2)]
        for bound in sockets:
            bound.bind(("127.0.0.1", 0))
        ports = [bound.getsockname()[1] for bound in sockets]
    host = socket.gethostname().split(".")[0]
    (folder / "slurm.conf").write_text(_CONFIG.format(host=host, folder=folder, ports=ports))
    key = folder / "munge.key"
    key.write_bytes(os.urandom(64))
    key.chmod(0o400)
    folder.chmod(0o755)


def _daemons(folder: Path) -> Iterator[list[str]]:
    places = {"key": "key-file", "socket": "socket", "pid": "pid-file", "log": "log-file",
              "seed": "seed-file"}  # fmt: skip
    options = [f"--{option}={folder}/munge.{name}" for name, option in places.items()]
    yield ["munged", "--foreground", "--force", *options]
    yield ["slurmctld", "-D"]
    yield ["slurmd", "-D"]


@contextmanager
def _daemon(command: Sequence[str], environment: dict[str, str], folder: Path) -> Iterator[None]:
    with (folder / f"{command[0]}.out").open("w") as said:
        process = subprocess.Popen(command, env=environment, stdout=said, stderr=said)
    try:
        time.sleep(0.5)
        yield
    finally:
        process.terminate()
        try:
            process.wait(_ENDS_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait_until_idle(environment: dict[str, str], folder: Path) -> None:
    deadline = time.monotonic() + _STARTS_S
    while time.monotonic() < deadline:
        command = ["sinfo", "--noheader", "--format=%T"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        if done.stdout.strip() == "idle":
            return
        time.sleep(0.5)
    said = [file.read_text()[-1000:] for file in sorted(folder.glob("*.out"))]
    raise AssertionError("\n".join(["Slurm does not start", *said]))
