"""The process behind watch.Server: requests on stdin, answers on stdout, a JSON line each."""

from __future__ import annotations

import importlib
import json
import os
import resource
import sys
import traceback
from pathlib import Path

from chord_usd.base.errors import ChordError
from chord_usd.cli import main


def serve() -> None:
    """Answer until stdin ends."""
    answers = os.fdopen(os.dup(1), "w")
    home = Path.cwd()
    for line in sys.stdin:
        request = json.loads(line)
        os.chdir(home)
        os.environ.update(request["env"])
        answer = _watched(request["words"])
        for name in request["env"]:
            os.environ.pop(name, None)
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _watched(words: list[str]) -> dict[str, object]:
    said = os.memfd_create("said")
    kept = [os.dup(number) for number in (1, 2)]
    for number in (1, 2):
        os.dup2(said, number)
    before, start = _resident(), _computed()
    try:
        code = _run(words)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)
    told = _text(said)
    return {"code": code, "told": told, "cpu_s": _computed() - start, "grown": _peak() - before}


def _run(words: list[str]) -> int:
    # What verbs print on stdout is no matter here.
    sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115
    try:
        if words[0] == "call":
            return _call(words[1], Path(words[2]))
        return main(words)
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else 2
    except BaseException:
        traceback.print_exc()
        return -1
    finally:
        sys.stdout.close()
        sys.stdout = sys.__stdout__ or sys.stderr


def _call(name: str, path: Path) -> int:
    """A reader by its name; an error of our own is a good answer."""
    module, function = name.split(":")
    try:
        getattr(importlib.import_module(module), function)(path)
    except (ChordError, FileNotFoundError) as error:
        sys.stderr.write(f"error: {' '.join(str(error).split())}\n")
        return 2
    return 0


def _text(said: int) -> str:
    size = os.lseek(said, 0, os.SEEK_END)
    text = os.pread(said, min(size, 100_000), 0).decode("utf-8", "backslashreplace")
    os.close(said)
    return text


def _resident() -> int:
    """Resident bytes, after the peak is set back to them."""
    Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _peak() -> int:
    return _status("VmHWM")


def _status(field: str) -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{field}:"):
            return int(line.split()[1]) * 1024
    return 0


def _computed() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


if __name__ == "__main__":
    # Nothing but the server's own folder may be imported by what a case puts beside it.
    sys.path[:] = [one for one in sys.path if one not in ("", str(Path(__file__).parent))]
    serve()
