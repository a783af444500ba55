"""How long it takes from a plan that is dropped on the page to the furnished house in 3-D.

    python benchmarks/page_speed.py [PLAN] [--runs N] [--wait SECONDS]

Each run has a server of its own, as after a start of the machine; the browser is headless Chromium
that draws without a graphics card. --wait: how long somebody looks at the page before the drop.
Processor time is that of the server and all that it started, and of the browser.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import sync_playwright
from results import write_section

ROOT = Path(__file__).parents[1]
CHROMIUM = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
LONGEST_MS = 300_000
DROP = """([bytes, name]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(bytes)], name));
    const drop = new DragEvent("drop", { dataTransfer: transfer });
    document.querySelector(".drop").dispatchEvent(drop);
}"""


@dataclass(frozen=True)
class Run:
    """One drop."""

    usable_s: float
    read_s: float
    furnished_s: float
    seen_s: float
    server_cpu_s: float
    browser_cpu_s: float


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plan", type=Path, nargs="?", default=ROOT / "examples/two_bedrooms.png")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--wait", type=float, default=5.0)
    options = parser.parse_args()
    runs = [measured(options.plan, options.wait) for _ in range(options.runs)]

    def of(name: str) -> str:
        values = sorted(getattr(run, name) for run in runs)
        return f"{statistics.median(values):.1f} s ({values[0]:.1f} to {values[-1]:.1f})"

    rows = [
        ("plan", f"{options.plan.name}, dropped {options.wait:g} s after the page was there"),
        ("request to usable page", of("usable_s")),
        ("drop to reading", of("read_s")),
        ("drop to furnished house", of("furnished_s")),
        ("drop to its 3-D view", of("seen_s")),
        ("processor time of server and verbs", of("server_cpu_s")),
        ("processor time of the browser", of("browser_cpu_s")),
    ]
    note = f"Medians of {options.runs} runs, the least and the most in brackets."
    sys.stdout.write(write_section("page", rows, note))


def measured(plan: Path, wait_s: float) -> Run:
    """One run, until the house is seen; its certificate is still being made then."""
    with (
        tempfile.TemporaryDirectory() as root,
        served(Path(root)) as (server, address),
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(CHROMIUM)
        )
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.set_default_timeout(LONGEST_MS)
        started = time.perf_counter()
        page.goto(address)
        page.get_by_role("button", name="Choose a file").wait_for()
        usable_s = time.perf_counter() - started
        time.sleep(wait_s)
        server_cpu_s, browser_cpu_s = cpu_s(server), cpu_s(os.getpid()) - cpu_s(server)
        dropped = time.perf_counter()
        page.evaluate(DROP, [list(plan.read_bytes()), plan.name])
        page.locator("svg .floor").first.wait_for()
        read_s = time.perf_counter() - dropped
        page.wait_for_url("**/house")
        furnished_s = time.perf_counter() - dropped
        page.locator("canvas[data-calls]").wait_for()
        seen_s = time.perf_counter() - dropped
        server_cpu_s = cpu_s(server) - server_cpu_s
        browser_cpu_s = cpu_s(os.getpid()) - cpu_s(server) - browser_cpu_s
        browser.close()
    return Run(usable_s, read_s, furnished_s, seen_s, server_cpu_s, browser_cpu_s)


@contextmanager
def served(root: Path) -> Iterator[tuple[int, str]]:
    """A server on a folder: its process and its address."""
    command = [sys.executable, "-m", "chord_usd", "serve", "--root", str(root), "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout
        try:
            yield server.pid, server.stdout.readline().strip()
        finally:
            server.terminate()


def cpu_s(process: int) -> float:
    """Processor time of a process, of those that it started and of those that have ended."""
    try:
        told = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    except OSError:
        return 0.0
    # Others than the main thread start processes, too.
    for task in Path(f"/proc/{process}/task").iterdir():
        if task.name != str(process):
            try:
                children += (task / "children").read_text().split()
            except OSError:
                continue
    own = sum(map(int, told[11:15])) / os.sysconf("SC_CLK_TCK")
    return own + sum(cpu_s(int(child)) for child in children)


if __name__ == "__main__":
    main()
