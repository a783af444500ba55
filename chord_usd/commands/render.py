"""render: stage -> pictures, through Blender Cycles."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_seed,
    add_verb,
    existing_file,
    names,
    resolution,
    stopwatch,
    tile,
    whole_number,
)


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "render", run, "make pictures of a stage with Blender Cycles")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda")
    add_output(parser, "folder for the pictures, CAMERA.png each")
    parser.add_argument(
        "--samples", type=whole_number(1), default=128, metavar="N", help="paths per pixel (128)"
    )
    parser.add_argument(
        "--resolution",
        type=resolution,
        default=(1280, 720),
        metavar="WxH",
        help="size in pixels (1280x720)",
    )
    parser.add_argument(
        "--camera",
        action="append",
        default=[],
        metavar="NAME",
        help="a camera of the stage; may be given several times (all)",
    )
    parser.add_argument(
        "--room",
        action="append",
        default=[],
        metavar="NAME",
        help="only cameras in this room; may be given several times",
    )
    parser.add_argument(
        "--passes", type=names, default=("rgb",), metavar="LIST", help="what to render (rgb)"
    )
    parser.add_argument("--engine", default="cycles", metavar="NAME", help="(cycles)")
    parser.add_argument(
        "--device", default="auto", metavar="NAME", help="auto, cpu, gpu, or a backend such as cuda"
    )
    parser.add_argument(
        "--tile", type=tile, metavar="I/N", help="only band I of N, the top one is 0"
    )
    parser.add_argument(
        "--lighting",
        default="",
        metavar="NAME",
        help="day, evening or another lighting of the stage (the one it has selected)",
    )
    add_seed(parser)
    parser.add_argument(
        "--skip-existing", action="store_true", help="keep the pictures that are already there"
    )


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.image.render import RenderOptions, render_stage

    wanted = RenderOptions(
        cameras=tuple(options.camera),
        rooms=tuple(options.room),
        resolution_px=options.resolution,
        samples=options.samples,
        seed=options.seed,
        passes=options.passes,
        engine=options.engine,
        device=options.device,
        tile=options.tile,
        skip_existing=options.skip_existing,
        lighting=options.lighting,
    )
    stage = existing_file(options.stage)
    watch = stopwatch(options)
    with watch.step("render") as progress:
        pictures = [
            str(picture) for picture in render_stage(stage, options.output, wanted, progress)
        ]
    return Outcome("\n".join(pictures), {"pictures": pictures, "seconds": watch.seconds})
