"""A command line run by a process that has loaded the program already, where such a worker waits.

A worker serves one command and ends; the command line starts the next one. So each command has a
process to itself: memory, environment, crashes and random state never reach the next command. Only
a user's processes reach the socket of that user, and a worker of another version ends.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import signal
import socket
import struct
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.locations import CHECKPOINTS_VARIABLE, shipped_checkpoints

VARIABLE = "CHORD_USD_WORKER"
"""0 turns workers off."""
OPTION = "--no-worker"

VERBS = ("plan", "layout", "graph", "stage", "generate", "regenerate", "edit", "check", "export")
CHANGING = ("edit", "regenerate")
"""Verbs that may write their input: never run a second time by themselves."""

PACKAGE = Path(__file__).parents[2]
READY, STALE, GO = b"ready\n", b"stale\n", b"\0"

_DECISIVE = ("CHORD_USD_", "OMP_", "ORT_", "MKL_", "PXR_", "PYTHON", "LC_", "LD_", "XDG_")
_DECISIVE_NAMES = ("HOME", "LANG", "PATH", "TMPDIR", "TZ", "USDC_USE_ASSET")
"""Variables of the environment that are read once, while libraries load."""
_LIMITS = ("AS", "CPU", "DATA", "FSIZE", "NOFILE", "NPROC", "RSS", "STACK")
_READY_S = 10.0
"""For a worker to finish a library that it is loading, and answer."""
_LEAST_FREE_BYTES = 2 * 2**30
"""Memory that must be available for a worker to wait in some of it."""


def run(words: Sequence[str]) -> int | None:
    """Exit code of a command line that a worker ran; None where this process has to run it.

    Raises ChordError where the worker ended in the middle of a verb that changes its input.
    """
    if not serves(words):
        return None
    with contextlib.suppress(OSError, ValueError), contextlib.ExitStack() as stack:
        link = stack.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
        link.settimeout(_READY_S)
        link.connect(str(address()))
        if peer_uid(link) != os.getuid():
            return None
        _send(link, words)
        answers = stack.enter_context(link.makefile("rb"))
        if answers.readline() != READY:
            return None
        link.settimeout(None)
        stack.enter_context(_signals_forwarded(link))
        link.sendall(GO)
        code = answers.readline()
        if code:
            return int(code)
        if words[0] in CHANGING:
            raise ChordError(
                "the worker process was killed",
                where=words[0],
                try_=("a look at the house", "the command again with <no_worker>"),
            )
    return None


def serves(words: Sequence[str]) -> bool:
    """Whether a worker may run a command line: a long verb, no option or limit against it."""
    return (
        sys.platform == "linux"
        and [*words[:1]] != []
        and words[0] in VERBS
        and os.environ.get(VARIABLE) != "0"
        and not os.environ.get(CHECKPOINTS_VARIABLE)
        and not {OPTION, "--debug", "-h", "--help"} & {*words}
        and all(_is_open(number) for number in (0, 1, 2))
    )


def start_next(words: Sequence[str], code: int, environment: Mapping[str, str]) -> None:
    """Start a worker for the next command, after a command line that ended with a code, in the
    environment of the command line (libraries add to that of the process)."""
    if code not in (0, 1) or not serves(words) or _available_bytes() < _LEAST_FREE_BYTES:
        return
    import subprocess

    with contextlib.suppress(OSError):
        address()
        subprocess.Popen(
            [sys.executable, "-P", "-m", "chord_usd.faces.worker"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env=environment,
        )


def address() -> Path:
    """The socket of this installation's worker, in a folder that only its user may enter.

    Raises OSError for a folder that others may enter or own.
    """
    folder = Path(os.environ.get("XDG_RUNTIME_DIR") or f"/tmp/chord-usd-{os.getuid()}")
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if status.st_uid != os.getuid() or status.st_mode & 0o077 or folder.is_symlink():
        raise PermissionError(f"{folder} is open to other users")
    installation = f"{sys.executable}\n{PACKAGE}".encode()
    return folder / f"chord-usd-{hashlib.blake2b(installation, digest_size=8).hexdigest()}"


def version() -> str:
    """A digest of all that a process has loaded or decided before it reads a command line: sources,
    packages, networks, environment, limits, processors, namespaces."""
    import resource

    digest = hashlib.blake2b(digest_size=16)
    folders = [PACKAGE, shipped_checkpoints()]
    packages = [name for name in sys.path if name.endswith("-packages")]
    parts: list[object] = [_stamp(Path(name)) for name in packages]
    parts += [stamp for folder in folders for stamp in _stamps(folder)]
    parts += sorted((name, value) for name, value in os.environ.items() if _decides(name))
    if any(
        not Path(os.environ[name]).is_absolute() for name in os.environ if name.startswith("CHORD_")
    ):
        parts.append(Path.cwd())
    parts += [resource.getrlimit(getattr(resource, f"RLIMIT_{name}")) for name in _LIMITS]
    parts += [sorted(os.sched_getaffinity(0)), os.getpriority(os.PRIO_PROCESS, 0)]
    parts += [os.getuid(), os.getgid(), sorted(os.getgroups()), Path("/").stat().st_ino]
    parts += [Path(f"/proc/self/ns/{kind}").readlink() for kind in ("mnt", "net", "cgroup")]
    for part in parts:
        digest.update(f"{part}\n".encode(errors="surrogateescape"))
    return digest.hexdigest()


def peer_uid(link: socket.socket) -> int:
    """The user at the other end of a connection."""
    raw = link.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i"))
    return int(struct.unpack("3i", raw)[1])


def _send(link: socket.socket, words: Sequence[str]) -> None:
    mask = os.umask(0)
    os.umask(mask)
    request = {
        "version": version(), "words": [*words], "folder": str(Path.cwd()), "mask": mask,
        "environment": {**os.environ},
        "ignored": [number for number in (signal.SIGINT, signal.SIGTERM)
                    if signal.getsignal(number) is signal.SIG_IGN],
    }  # fmt: skip
    text = json.dumps(request).encode()
    socket.send_fds(link, [struct.pack("<I", len(text))], [0, 1, 2])
    link.sendall(text)


@contextlib.contextmanager
def _signals_forwarded(link: socket.socket) -> Iterator[None]:
    """While the worker runs, Ctrl-C and `kill` of this process reach it."""

    def forward(number: int, frame: object) -> None:
        with contextlib.suppress(OSError):
            link.sendall(bytes([number]))

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, forward)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _decides(name: str) -> bool:
    return name in _DECISIVE_NAMES or name.startswith(_DECISIVE)


def _stamps(folder: Path) -> Iterator[str]:
    for place, _, names in os.walk(folder):
        if not place.endswith("__pycache__"):
            for name in names:
                yield _stamp(Path(place, name))


def _stamp(path: Path) -> str:
    try:
        status = path.stat()
    except OSError:
        return f"{path} -"
    return f"{path} {status.st_mtime_ns} {0 if path.is_dir() else status.st_size}"


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


def _available_bytes() -> int:
    """Memory that the machine can give; 0 where it does not say."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    return 0
