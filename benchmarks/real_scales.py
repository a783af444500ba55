"""How near the scales of real plans come to what is printed on them, measured by hand.

    python benchmarks/real_scales.py FOLDER

FOLDER holds what `chord-usd plan read FILE -o FOLDER/STEM.json` made of the files named there.
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

NEAR, FAR = 0.05, 0.15


def main(folder: Path) -> None:
    """Print a line a file, and how many are near, and far without a warning."""
    with Path(__file__).with_suffix(".tsv").open(newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    lines, near, silent, read = [], 0, 0, 0
    for row in rows:
        path = folder / f"{Path(row['file']).stem}.json"
        if not path.exists():
            lines.append(f"{row['file']}: not read")
            continue
        plan = json.loads(path.read_text())
        off = float(plan["scale"]["mPerPx"]) / float(row["m_per_px"]) - 1
        is_told = any("--scale" in warning for warning in plan.get("warnings", ()))
        read += 1
        near += abs(off) <= NEAR
        silent += abs(off) > FAR and not is_told
        witness = plan["scale"]["witness"]
        lines.append(f"{row['file']}: {off:+.1%} by {witness}{', warned' if is_told else ''}")
    lines.append(f"within {NEAR:.0%}: {near} of {read}; over {FAR:.0%} without a warning: {silent}")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
