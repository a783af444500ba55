"""Blender as a process: start it, hand it a job, follow it, end it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import chord_usd
from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.line.image.job import EXIT_NO_DEVICE, EXIT_UNREADABLE, Job, write_job

STOP_SECONDS = 0.8
"""How long Blender has to end after SIGTERM."""

_FOREIGN_VARIABLES = ("PYTHONHOME", "PYTHONPATH", "PYTHONSTARTUP", "PXR_PLUGINPATH_NAME")
"""What could bring another Python's modules, or another USD's plug-ins, into Blender."""


def run_blender(job: Job, on_message: Callable[[dict[str, Any]], None]) -> None:
    """Run one job in a Blender of its own; on_message gets each line it reports.

    Leaving early, by Ctrl-C or any other exception, ends the process. Raises RenderError with the
    last thing Blender said.
    """
    with (
        scratch_folder() as home,
        tempfile.TemporaryFile("w+", dir=home) as said,
        _started(home, said) as process,
    ):
        assert process.stdin is not None
        assert process.stdout is not None
        with process.stdin as job_file:
            job_file.write(write_job(job))
        for line in process.stdout:
            # While bpy is imported, it may warn before the worker has claimed standard output.
            if line.startswith("{"):
                on_message(json.loads(line))
        code = process.wait()
        if code != 0:
            said.seek(0)
            raise _failure(code, said.read())


def write_blend(stage: Path, target: Path) -> None:
    """Write a stage as a Blender file with its pictures in it. Raises RenderError."""
    words = (".blend_file", str(absolute(stage)), str(absolute(target)))
    with (
        scratch_folder() as home,
        tempfile.TemporaryFile("w+", dir=home) as said,
        _started(home, said, *words) as process,
    ):
        process.communicate()
        if process.returncode != 0 or not target.is_file():
            said.seek(0)
            raise _failure(process.returncode or 1, said.read())


@contextmanager
def _started(
    home: Path, said: TextIO, module: str = "", *words: str
) -> Iterator[subprocess.Popen[str]]:
    """A Blender that runs a module of the worker's."""
    environment = {k: v for k, v in os.environ.items() if k not in _FOREIGN_VARIABLES}
    environment.update(
        # The package may have been found by a path that only this process knows.
        PYTHONPATH=str(Path(chord_usd.__file__).parent.parent),
        # A file in the working folder must not pass for a module.
        PYTHONSAFEPATH="1",
        # Preferences and add-ons of an installed Blender must not change the pictures.
        BLENDER_USER_RESOURCES=str(home),
    )
    process = subprocess.Popen(
        [sys.executable, "-m", f"chord_usd.line.image.worker{module}", *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=said,
        env=environment,
        text=True,
        # A render ignores the SIGINT of Ctrl-C, which would reach it through the terminal's
        # group; it stops at SIGTERM, which we send.
        start_new_session=True,
    )
    try:
        yield process
    finally:
        _end(process)


def _end(process: subprocess.Popen[str]) -> None:
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(STOP_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _failure(code: int, said: str) -> RenderError:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    last = lines[-1] if lines else "it said nothing"
    if code == EXIT_NO_DEVICE:
        return RenderError(last, where="<device>", expected="a device of this machine", try_="cpu")
    if code == EXIT_UNREADABLE:
        return RenderError(last, expected="pictures that Blender reads", try_="<allow_missing>")
    if code < 0:
        return RenderError(
            f"Blender was ended by signal {-code}; its last words: {last}",
            try_="fewer pixels or samples, if memory ran out",
        )
    return RenderError(f"Blender could not render: {last}", try_="<check>")
