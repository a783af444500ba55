"""benchmarks/RESULTS.md: one section per benchmark, each with the machine it was measured on."""

from __future__ import annotations

import os
import platform
import re
import subprocess
from datetime import date
from importlib.metadata import version
from pathlib import Path

from chord_usd.base.runtime.files import write_atomic

RESULTS = Path(__file__).with_name("RESULTS.md")
_TITLE = "# Benchmarks\n\nMade by the scripts in this folder; run them again on your machine.\n"


def write_section(title: str, rows: list[tuple[str, str]], note: str = "") -> str:
    """Replace the section of this title; returns its text."""
    table = "\n".join(f"| {name} | {value} |" for name, value in rows)
    text = f"## {title}\n\n{machine()}\n\n{measured()}\n\n| | |\n|---|---|\n{table}\n"
    if note:
        text += f"\n{note}\n"
    old = RESULTS.read_text() if RESULTS.exists() else _TITLE
    section = re.compile(rf"^## {re.escape(title)}\n.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)
    if section.search(old):
        new = section.sub(lambda _: text + "\n", old)
    else:
        new = f"{old.rstrip()}\n\n{text}"
    write_atomic(RESULTS, new.rstrip() + "\n")
    return text


def measured() -> str:
    """When, and at which commit; a + marks a tree with changes that are not in it."""
    commit = subprocess.run(
        ["git", "describe", "--always", "--exclude=*", "--dirty=+"],
        cwd=RESULTS.parent, capture_output=True, text=True, check=False,
    ).stdout.strip()  # fmt: skip
    return f"Measured {date.today().isoformat()} at {commit or 'an unknown commit'}."


def machine() -> str:
    """One line on the machine and the versions that matter."""
    cpu = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text())
    total = re.search(r"MemTotal:\s*(\d+) kB", Path("/proc/meminfo").read_text())
    gib = int(total[1]) / 2**20 if total else 0.0
    return (
        f"{cpu[1] if cpu else platform.processor()}, {os.cpu_count()} cores, {gib:.0f} GiB, "
        f"{platform.system()}, Python {platform.python_version()}, torch {version('torch')}, "
        f"usd-core {version('usd-core')}; load before the run {os.getloadavg()[0]:.1f}"
    )
