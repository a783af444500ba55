"""What programs that nobody here wrote say of stages: NVIDIA's validator, a physics engine.

    python benchmarks/stage_outside.py HOUSE.usda ... --validator .../bin/nvidia_usd_validate
    python benchmarks/stage_outside.py HOUSE.usda ... --still .../bin/python simcheck.py

Both want environments of their own: `pip install 'usd-validation-nvidia[usd]'`, and
`pip install 'newton[importers,sim]'` for a script that exits 0 if every body of a stage stays where
it is for two seconds.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from results import write_section

RULES = {
    "default rules": ("--disable-rule", "IndexedPrimvarChecker"),
    "atomic_asset": ("--no-init-rules", "--capability", "com.nvidia.usd.atomic_asset"),
}
"""What the validator is asked, by the name of the row."""

_LINES_SHOWN = 12


def main() -> None:
    """Asks, and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stages", type=Path, nargs="+")
    parser.add_argument("--validator", type=Path, metavar="PROGRAM")
    parser.add_argument("--still", type=Path, nargs=2, metavar=("PYTHON", "SCRIPT"))
    parser.add_argument("--kind", default="houses", help="what the stages are (houses)")
    options = parser.parse_args()
    rows = []
    if options.validator:
        for name, rules in RULES.items():
            rows.append((name, told(options.stages, [options.validator, *rules])))
        title = f"stages: NVIDIA's validator, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options.stages)))
    if options.still:
        rows = [("stand still for two seconds", told(options.stages, options.still))]
        title = f"stages: physics, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options.stages)))


def told(stages: Sequence[Path], command: Sequence[Path | str]) -> str:
    """Runs the command on every stage; how many it passes."""
    passed = 0
    for stage in stages:
        run = subprocess.run(
            [*map(str, command), str(stage)], capture_output=True, text=True, check=False
        )
        passed += run.returncode == 0
        lines = (run.stdout + run.stderr).strip().splitlines()
        sys.stderr.write(f"{stage}: {run.returncode}\n")
        if run.returncode:
            sys.stderr.write("\n".join(lines[-_LINES_SHOWN:]) + "\n")
        sys.stderr.flush()
    return f"{passed} of {len(stages)} pass"


def _note(stages: Sequence[Path]) -> str:
    return f"{stages[0].name} to {stages[-1].name}."


if __name__ == "__main__":
    main()
