"""export: stage -> another package of the house."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    stopwatch,
)


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "export", run, "write a stage as a package for other programs")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "--for",
        dest="package",
        choices=("web", "gltf"),
        required=True,
        help="web: a flat .usdz for viewers in a browser; gltf: a .glb",
    )
    add_output(parser, "the package: .usdz for web, .glb for gltf")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.stage.export import export_stage

    with stopwatch(options).step("export"):
        export_stage(existing_file(options.stage), options.output, options.package)
    size = options.output.stat().st_size
    data = {"package": str(options.output), "for": options.package, "bytes": size}
    return Outcome(f"{options.output}: {size / 1e6:.1f} MB", data)
