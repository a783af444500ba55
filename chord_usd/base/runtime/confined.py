"""Work on bytes from strangers in a process of its own, with limits.

A parser may be made to eat all memory, to never end, or to crash; in a process of its own that is
one error. While a parser runs in C it also hears no signal; whoever waits for it does.

That process is a fresh interpreter, not a fork: ONNX Runtime, OpenCV and USD keep threads, whose
locks a fork copies as they happen to be, so that a forked reader would now and then hang for ever.
A fresh one starts with numpy in 0.1 s, does the same whoever calls it, and
starts from the same memory, which is what the limit counts from.

This contains accidents and bombs. It is no sandbox: the process has the user's rights.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from typing import Any, NoReturn, TypeVar, TypeVarTuple

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.sent_values import packed, unpacked

Result = TypeVar("Result")
Arguments = TypeVarTuple("Arguments")

_CHILD = (
    "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); "
    "from chord_usd.base.runtime.confined import serve; serve()"
)
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""Threads that wait for work count as memory, and parsers give them none."""

_PIPE_BYTES = 2**15
"""What a pipe takes in at once on all systems."""

_SIMPLER = "a smaller or simpler file"
_PR_SET_PDEATHSIG = 1


_WALL_PER_CPU = 20.0
"""On a busy machine a process gets a small share of a core, and its file is as good."""


@dataclass(frozen=True)
class Limits:
    """What a confined function may use. Enforced on Linux; elsewhere only wall_s is."""

    memory_bytes: int = 2**30
    """Of address space, above what the process has once the function's module is imported."""
    cpu_s: int = 30
    """Of all its threads together."""

    @property
    def wall_s(self) -> float:
        """Seconds from the start of the process; only a process that waits for others meets it."""
        return _WALL_PER_CPU * self.cpu_s


DEFAULT = Limits()


class ConfinedTraceback(Exception):  # noqa: N818 (a cause to show with --debug, never raised)
    """Where in the confined process an error came from."""


def confined(
    function: Callable[[*Arguments], Result],
    *arguments: *Arguments,
    where: str,
    limits: Limits = DEFAULT,
    error: type[ChordError] = ChordError,
    meanwhile: Callable[[], object] | None = None,
) -> Result:
    """function(*arguments), computed in a process of its own.

    function: importable by its name; it and its arguments are pickled, and the process, which read
    a stranger's file since, answers in values that call no code (sent_values.py). Arrays
    of the result cannot be written to. What the function prints is dropped. where: the file, for
    messages. meanwhile: called here while that process works, to import what comes next, say.

    Raises the ChordError, or the OSError about a file, that the function raised; and `error` for
    any other exception, for a limit passed and for a crash. Whatever signal handlers raise here
    ends the process and passes through. The process dies with its caller.
    """
    parts = (list(sys.path), (os.getpid(), limits), (function, arguments))
    payload = b"".join(pickle.dumps(part) for part in parts)
    try:
        code, answer = _run(payload, limits.wall_s, meanwhile)
    except _Starved as starved:
        _refuse_busy(starved.cpu_s, limits, where, error)
    if code != 0 or not answer:
        _refuse_dead(code, limits, where, error)
    try:
        kind, value, trace = unpacked(answer)
    except Exception as problem:  # whatever a damaged process may have sent
        raise error("cannot be read (its reader's answer is damaged)", where=where) from problem
    cause = ConfinedTraceback(trace)
    if kind == "result":
        result: Result = value
        return result
    if kind == "raised" and isinstance(value, ChordError):
        raise value from cause
    if kind == "system":
        raise OSError(*value) from cause
    if kind == "memory":
        _refuse_large(limits, where, error, cause)
    raise error(f"cannot be read ({value})", where=where) from cause


def _run(
    payload: bytes, wall_s: float, meanwhile: Callable[[], object] | None
) -> tuple[int, bytes]:
    """Exit code and answer of a child. Raises _Starved; leaves no child behind."""
    # -I: neither the current folder nor PYTHONPATH comes before what the caller imports from.
    with subprocess.Popen(
        [sys.executable, "-I", "-c", _CHILD],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **_ONE_THREAD},
    ) as process:
        try:
            if meanwhile and process.stdin and len(payload) <= _PIPE_BYTES:
                with suppress(BrokenPipeError):  # the exit code reports it
                    process.stdin.write(payload)
                    process.stdin.flush()
                payload = b""
                meanwhile()
            answer, _ = process.communicate(payload, timeout=wall_s)
        except subprocess.TimeoutExpired:
            cpu_s = _cpu_s_of(process.pid)
            process.kill()
            raise _Starved(cpu_s) from None
        except BaseException:
            process.kill()
            raise
    return process.returncode, answer


class _Starved(Exception):  # noqa: N818 (caught at once)
    """A child that met the limit of wall time."""

    def __init__(self, cpu_s: float | None) -> None:
        self.cpu_s = cpu_s
        """Processor time that it had; None where the system does not say."""


def _cpu_s_of(pid: int) -> float | None:
    """Processor time of a process so far, where Linux's files say it."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:  # noqa: PTH123 (as in _limit)
            user, system = file.read().rsplit(")", 1)[1].split()[11:13]
    except OSError:
        return None
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def _refuse_slow(seconds: float, where: str, error: type[ChordError]) -> NoReturn:
    raise error(
        f"takes more than {seconds:g} s of processor time to read", where=where, try_=_SIMPLER
    ) from None


def _refuse_busy(
    cpu_s: float | None, limits: Limits, where: str, error: type[ChordError]
) -> NoReturn:
    had = "" if cpu_s is None else f" (its reader had {cpu_s:.0f} s of processor time)"
    raise error(
        f"was not read within {limits.wall_s:g} s{had}: the machine or its disk is busy",
        where=where, try_="again when less runs beside it, or a smaller file",
    ) from None  # fmt: skip


def _refuse_large(
    limits: Limits, where: str, error: type[ChordError], cause: Exception
) -> NoReturn:
    raise error(
        f"needs more than {limits.memory_bytes // 2**20} MiB of memory to read",
        where=where, try_=_SIMPLER,
    ) from cause  # fmt: skip


def _refuse_dead(code: int, limits: Limits, where: str, error: type[ChordError]) -> NoReturn:
    if hasattr(signal, "SIGXCPU") and code == -signal.SIGXCPU:
        _refuse_slow(limits.cpu_s, where, error)
    # Parsers in C++ abort when they get no memory, and so look like any other crash.
    raise error(
        f"made its reader crash, or needs more than {limits.memory_bytes // 2**20} MiB of memory"
        f" to read (exit code {code})",
        where=where, try_=_SIMPLER,
    )  # fmt: skip


# The child ----------------------------------------------------------------------------------------


def serve() -> None:
    """The child: one call from stdin, one answer to stdout."""
    parent_pid, limits = pickle.load(sys.stdin.buffer)
    _die_with(parent_pid)
    # Ctrl-C reaches the whole group; the caller decides what becomes of it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with os.fdopen(os.dup(1), "wb") as out:
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        function, arguments = pickle.load(sys.stdin.buffer)
        soften = _limit(limits)
        answer = _outcome(function, arguments)
        soften()
        out.writelines(packed(answer))
    # Destructors and exit handlers of parsers have nothing to add, and may crash.
    os._exit(0)


def _outcome(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[str, Any, str]:
    try:
        return "result", function(*arguments), ""
    except MemoryError:
        return "memory", None, ""
    except RecursionError:
        return "broken", "nested too deeply", traceback.format_exc(-9)
    except ChordError as error:
        return "raised", error, traceback.format_exc()
    except Exception as error:
        trace = traceback.format_exc()
        if "bad_alloc" in str(error):  # as libraries in C++ say it
            return "memory", None, trace
        if isinstance(error, OSError) and error.filename and error.errno:
            return "system", (error.errno, error.strerror, str(error.filename)), trace
        return "broken", f"{type(error).__name__}: {error}"[:300], trace


def _die_with(parent_pid: int) -> None:
    """Have the kernel end this process with its parent, also where that is killed."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent_pid:
        os._exit(1)


def _limit(limits: Limits) -> Callable[[], None]:
    """Set the limits; what is returned takes that of memory away, to send the answer."""
    if sys.platform != "linux":
        return lambda: None
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _lower(resource.RLIMIT_CPU, limits.cpu_s)
    with open("/proc/self/statm", "rb") as file:  # noqa: PTH123 (pathlib would be one more import)
        pages = int(file.read().split()[0])
    highest = _lower(resource.RLIMIT_AS, pages * resource.getpagesize() + limits.memory_bytes)
    return lambda: resource.setrlimit(resource.RLIMIT_AS, highest)


def _lower(kind: int, most: int) -> tuple[int, int]:
    """Lower a soft limit, never raise it; returns what it was."""
    import resource

    soft, hard = before = resource.getrlimit(kind)
    least = min([most, *(v for v in (soft, hard) if v != resource.RLIM_INFINITY)])
    resource.setrlimit(kind, (least, hard))
    return before


# Every format that is decoded: its reader, the library calls that it makes, and its --------------

# Decoders of pictures, meshes, drawings and stages are the parts of a program that strangers' bytes
# break. They run in a process of their own (confined.py), by the name of their row here and
# not otherwise; tests/unit/test_decoders.py looks for calls elsewhere.


@dataclass(frozen=True)
class Decoder:
    """A row of the table."""

    reader: str
    """module:function below chord_usd; nothing else names the function."""
    calls: dict[str, str]
    """Modules below chord_usd, each with the decoders of libraries that it calls."""
    limits: Limits = DEFAULT


_VECTOR = {
    "line.plan.vector.dxf": "ezdxf.recover.readfile",
    "line.plan.vector.ifc": "ifcopenshell.open",
    "line.plan.vector.safe_xml": "xml.etree.ElementTree.XMLPullParser",
}

DECODERS = {
    "plan picture": Decoder("line.plan.picture:_read", {"line.plan.picture": "PIL.Image.open"}),
    "layout raster": Decoder(
        "base.raster.raster_files:_open", {"base.raster.raster_files": "PIL.Image.open"}
    ),
    "PDF page": Decoder(
        "line.plan.vector.pdf:_read_page", {"line.plan.vector.pdf": "pypdfium2.PdfDocument"}
    ),
    "SVG page": Decoder(
        "line.plan.vector.svg_page:_read_page", {"line.plan.vector.svg_page": "PIL.Image.open"}
    ),
    "vector plan": Decoder("line.plan.vector.formats:_read_plan", _VECTOR),
    "vector storeys": Decoder("line.plan.vector.formats:_read_storeys", _VECTOR),
    "backdrop": Decoder("line.plan.vector.backdrop:_backdrop", _VECTOR),
    "sky": Decoder(
        "base.raster.hdri:_developed", {"base.raster.hdri": "OpenEXR.InputFile cv2.imread"}
    ),
    "mesh": Decoder(
        "library.libraries.meshes:_read_here",
        {"library.libraries.meshes": "trimesh.load PIL.Image.open"},
        Limits(cpu_s=100),
    ),
    "stages": Decoder(
        "base.runtime.stages:_try_all",
        {"base.runtime.stages": "pxr.Usd.Stage.Open pxr.Sdf.Layer.FindOrOpen"},
        Limits(cpu_s=40),
    ),
}


def decode(
    name: str,
    *arguments: object,
    where: str,
    error: type[ChordError] = ChordError,
    meanwhile: Callable[[], object] | None = None,
) -> Any:
    """What the reader of a row makes of its arguments, in a process with the row's limits.

    where, error, meanwhile: as confined has them. Raises what confined raises.
    """
    row = DECODERS[name]
    module, _, function = row.reader.partition(":")
    reader = getattr(import_module(f"chord_usd.{module}"), function)
    return confined(
        reader, *arguments, where=where, limits=row.limits, error=error, meanwhile=meanwhile
    )
