"""Takes one job on standard input, renders it, and reports progress on standard output.

One JSON object per line: `{"device": "CPU"}` once, `{"progress": {"camera": …, "done": samples,
"total": samples}}` and `{"taken": camera, "exposure_ev": …,
"cpu_s": …}`. Whatever Blender itself prints goes
to standard error. bpy must be imported and used on the main thread: elsewhere it crashes at exit.

Exit codes: 0 all is taken; 1 Blender failed; 3 the wanted device is not there; 4 a texture cannot
be read.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from chord_usd.line.image.job import EXIT_NO_DEVICE, EXIT_UNREADABLE, read_job
from chord_usd.line.image.worker.devices import DeviceMissingError
from chord_usd.line.image.worker.scene import UnreadableError
from chord_usd.line.image.worker.shoot import develop, shoot


def main() -> int:
    """Read the job, render it, return the exit code."""
    report = _claim_stdout()
    job = read_job(sys.stdin.read())
    _end_with_parent()
    try:
        if job.cameras:
            shoot(job, report)
        for negative in job.negatives:
            develop(negative)
    except DeviceMissingError as error:
        sys.stderr.write(f"{error}\n")
        return EXIT_NO_DEVICE
    except UnreadableError as error:
        sys.stderr.write(f"{error}\n")
        return EXIT_UNREADABLE
    return 0


def _claim_stdout() -> Callable[[dict[str, Any]], None]:
    """Keep standard output for reports; Blender's own prints go to standard error."""
    lines = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)

    def report(message: dict[str, Any]) -> None:
        lines.write(json.dumps(message) + "\n")

    return report


def _end_with_parent() -> None:
    """Stop when the process that started this one is gone: a render holds a machine for hours."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(143)

    threading.Thread(target=watch, daemon=True).start()


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.exit(code)
