"""How near the scales of real plans come to what is printed on them, measured by hand.

    python benchmarks/real_scales.py FOLDER

FOLDER holds the readings of the files in real_scales.tsv: `chord-usd plan read FILE -o FOLDER/STEM.json`.
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
    near = silent = read = 0
    for row in rows:
        path = folder / f"{Path(row['file']).stem}.json"
        if not path.exists():
            print(f"{row['file']}: not read")
            continue
        plan = json.loads(path.read_text())
        off = float(plan["scale"]["mPerPx"]) / float(row["m_per_px"]) - 1
        is_told = any("--scale" in warning for warning in plan.get("warnings", ()))
        read += 1
        near += abs(off) <= NEAR
        silent += abs(off) > FAR and not is_told
        witness = plan["scale"]["witness"]
        print(f"{row['file']}: {off:+.1%} by {witness}{', warned' if is_told else ''}")
    print(f"within {NEAR:.0%}: {near} of {read}; beyond {FAR:.0%} without a warning: {silent}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
