"""export: stage -> another package of the house."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    folder_mode,
    stopwatch,
)
from chord_usd.faces.commands.paths import output_package

if TYPE_CHECKING:
    from chord_usd.faces.commands.results import Exported

PACKAGES = {
    "web": "a flat .usdz for viewers in a browser",
    "ar": "such a .usdz for AR Quick Look",
    "gltf": "a .glb",
    "ifc": "a building in IFC4",
    "dxf": "a plan for CAD",
    "ros": "a folder with an occupancy grid, rooms, doors and free poses for robots",
    "robot": "a .json of what opens and its handles, supports, things to grasp, poses, tasks",
    "mujoco": "a folder with an MJCF model, its meshes and textures",
    "urdf": "a folder with a URDF model and its meshes",
    "sdf": "a folder with an SDF model and its meshes",
    "habitat": "a folder with a scene data set of Habitat",
    "blend": "a file of Blender with its pictures in it",
    "materialx": "a folder with the house, its materials in MaterialX, too",
}


UNITLESS, PHOTOMETRIC = "unitless", "photometric"

BLEND = "blend"
"""The package that Blender writes."""


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "export", run, "write a stage as a package for other programs")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "--for",
        dest="package",
        choices=tuple(PACKAGES),
        required=True,
        help="; ".join(f"{name}: {what}" for name, what in PACKAGES.items()),
    )
    add_output(parser, "the package, a file or a folder, new or empty", output_package)
    parser.add_argument(
        "--lights", choices=(UNITLESS, PHOTOMETRIC),
        help="of a .glb: for viewers with a fixed exposure, or in candela and lux (unitless)",
    )  # fmt: skip
    parser.add_argument(
        "--overwrite", action="store_true",
        help="replace what chord-usd wrote into the folder before, and nothing else",
    )  # fmt: skip


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.line.stage.export.export_stage import export_stage

    output: Path = options.output
    if options.lights and options.package != "gltf":
        raise UsageError(
            f"--lights is of no use for a {options.package} package", where=str(output),
            expected="--lights beside --for gltf", try_="the same without --lights",
        )  # fmt: skip
    with stopwatch(options).step("export"):
        stage = existing_file(options.stage)
        if options.package == BLEND:
            _export_blend(stage, output)
        else:
            photometric = options.lights == PHOTOMETRIC
            mode = folder_mode(options)
            export_stage(stage, output, options.package, mode, photometric=photometric)
    files = output.rglob("*") if output.is_dir() else [output]
    size = sum(file.stat().st_size for file in files if file.is_file())
    data: Exported = {"package": str(output), "for": options.package, "bytes": size}
    return Outcome(f"{output}: {size / 1e6:.1f} MB", data)


def _export_blend(stage: Path, output: Path) -> None:
    from chord_usd.base.runtime.files import deliver
    from chord_usd.base.runtime.stages import own_files
    from chord_usd.line.image.blender import write_blend

    if output.suffix != ".blend":
        raise UsageError(
            f"{output.suffix or 'no suffix'} is not the suffix of a Blender file",
            where=str(output), expected=".blend", try_=f"-o {output.stem}.blend",
        )  # fmt: skip
    own_files(stage)
    with deliver() as delivery:
        write_blend(stage, delivery.place(output))
