"""What of a plan is lost when its house is written as IFC or DXF and read again.

    python benchmarks/exchange_round_trip.py [--count 50] [--flats FILE.jsonl.gz] [--authored]

Procedural plans of the test split, and as many real flats where a file of them is given
(chord_usd.workshop.data.flats). Each becomes a stage without furniture, the stage a file, and the
file a plan again, which is compared with the first. --authored: whole stages, not only what a plan
is read from, which takes twice as long.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # tests

from results import write_section  # noqa: E402

from chord_usd.base.runtime.stages import open_known  # noqa: E402
from chord_usd.line.plan.vector.assemble import assemble  # noqa: E402
from chord_usd.line.plan.vector.formats import read_drawings  # noqa: E402
from chord_usd.line.stage.author.author_stage import author_stage  # noqa: E402
from chord_usd.line.stage.export.exchange.dxf_drawing import write_dxf  # noqa: E402
from chord_usd.line.stage.export.exchange.ifc_model import write_ifc  # noqa: E402
from chord_usd.workshop.evaluation.cases import Case, flat_cases, procedural_cases  # noqa: E402
from tests.bare_stage import write_bare_stage  # noqa: E402
from tests.plan_alike import Likeness, likeness  # noqa: E402

WRITERS = {"ifc": write_ifc, "dxf": write_dxf}
TOLERANCE_M = 0.01


def main() -> int:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50, metavar="N", help="plans of each kind")
    parser.add_argument("--flats", type=Path, metavar="FILE", help="real flats, .jsonl.gz")
    parser.add_argument(
        "--only", choices=tuple(WRITERS), action="append", help="may be given twice"
    )
    parser.add_argument("--authored", action="store_true", help="stages as generate writes them")
    options = parser.parse_args()
    cases = list(procedural_cases("test", options.count).cases)
    if options.flats:
        cases += flat_cases(options.flats, "test", options.count).cases
    found: dict[str, list[Likeness]] = defaultdict(list)
    for case in cases:
        for package, alike in round_trips(case, options.only or list(WRITERS), options.authored):
            found[package].append(alike)
            if not alike.holds(TOLERANCE_M):
                sys.stderr.write(f"{case.id} as {package}: {alike}\n")
    flats = len(cases) - options.count
    rows = [("plans", f"{options.count} procedural, {flats} flats")]
    rows += [(package, told(alikes)) for package, alikes in found.items()]
    sys.stdout.write(write_section("exchange: plans that come back", rows, note(options)))
    return 0 if all(one.holds(TOLERANCE_M) for row in found.values() for one in row) else 1


def round_trips(case: Case, packages: list[str], authored: bool) -> list[tuple[str, Likeness]]:
    """The plan after each format."""
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "house.usda"
        if authored:
            author_stage(case.plan.scene(), path)
        else:
            write_bare_stage(case.plan, path)
        # What is our own needs no process of its own, to be read in.
        stage = open_known(path)
        rows = []
        for package in packages:
            file = path.with_suffix(f".{package}")
            WRITERS[package](stage, file)
            (drawing,) = read_drawings(file)
            rows.append((package, likeness(assemble(drawing, str(file)), case.plan)))
        return rows


def told(alikes: list[Likeness]) -> str:
    """One line of the table."""
    count = len(alikes)
    rooms, openings = (sum(getattr(one, key) for one in alikes) for key in ("rooms", "openings"))
    corner_m, opening_m = (
        max(getattr(one, k) for one in alikes) for k in ("corner_m", "opening_m")
    )
    same = sum(one.holds(TOLERANCE_M) for one in alikes)
    return (
        f"{same} of {count} the same within {TOLERANCE_M * 100:g} cm; rooms equal in number and "
        f"kind {rooms}, doors, windows and passages in number {openings}; farthest corner of a "
        f"room {corner_m * 1000:.2f} mm, of an opening {opening_m * 1000:.2f} mm"
    )


def note(options: argparse.Namespace) -> str:
    """How to run it again."""
    flats = " --flats FILE" if options.flats else ""
    return f"`python benchmarks/exchange_round_trip.py --count {options.count}{flats}`."


if __name__ == "__main__":
    sys.exit(main())
