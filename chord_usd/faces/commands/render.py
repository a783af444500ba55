"""render: stage -> pictures, through Blender Cycles."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd import __version__
from chord_usd.base.scene.label_sets import LABEL_SETS, OWN
from chord_usd.faces.commands.common import (
    Options,
    Outcome,
    Parser,
    UsageError,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    frames,
    names,
    resolution,
    stopwatch,
    tile,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_place, sky

if TYPE_CHECKING:
    from chord_usd.faces.commands.results import Rendered
    from chord_usd.line.image.options import RenderOptions

QUALITIES = ("draft", "good", "final")
"""As image.options has them, which may not be imported for a help page."""


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "render", run, "make pictures of a stage with Blender Cycles")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda, or any USD stage")
    add_output(parser, "folder for the pictures: CAMERA.png, other passes beside it", output_place)
    add_what(parser)
    add_how(parser)
    _add_missing(parser)
    _add_parts(parser)


def add_what(parser: Parser) -> None:
    """The options that say which pictures."""
    group = parser.add_argument_group("what to render")
    group.add_argument(
        "--camera", action="extend", type=names, default=[], metavar="NAMES",
        help="cameras of the stage, with commas; may be given several times (all)",
    )  # fmt: skip
    group.add_argument(
        "--room", action="append", default=[], metavar="NAME",
        help="only cameras in this room, such as 'Bedroom 1'; may be given several times",
    )  # fmt: skip
    group.add_argument(
        "--walkthrough", type=whole_number(1, 10_000), default=0, metavar="N",
        help="instead of the stage's cameras, N views along a walk through the doors",
    )  # fmt: skip
    group.add_argument(
        "--turntable", default="", metavar="ROOM",
        help="instead of the stage's cameras, views around a room that stands alone and open",
    )  # fmt: skip
    group.add_argument(
        "--frames", type=whole_number(1, 10_000), default=36, metavar="N",
        help="views of a turntable (36)",
    )  # fmt: skip
    group.add_argument(
        "--frame", type=frames, metavar="A-B",
        help="of a walk or turntable only the views A to B, the first is 0 (all)",
    )  # fmt: skip
    group.add_argument(
        "--roof", default="", metavar="NAME",
        help="gable, hip, flat or none: a roof that the stage has (the one it has selected)",
    )  # fmt: skip
    add_look(group)


def add_look(group: Options) -> None:
    """The options of any picture, whatever it shows."""
    group.add_argument(
        "--resolution", type=resolution, metavar="WxH",
        help="size in pixels (1280x720, for drafts 640x360)",
    )  # fmt: skip
    group.add_argument(
        "--passes", type=names, default=("rgb",), metavar="LIST",
        help="some of rgb,depth,normal,instance,semantic,layers (rgb)",
    )  # fmt: skip
    group.add_argument(
        "--room-names", action="store_true",
        help="write names and areas of rooms on pictures from straight above (Top)",
    )  # fmt: skip
    group.add_argument(
        "--label-set", choices=LABEL_SETS, default=OWN,
        help="whose names and ids coco.json of the instance pass has (chord: our own)",
    )  # fmt: skip
    group.add_argument(
        "--lighting", default="", metavar="NAME",
        help="day, evening or another lighting of the stage (the one it has selected)",
    )  # fmt: skip
    group.add_argument(
        "--sky", type=sky, default="", metavar="NAME",
        help="another sky than the stage's: morning, noon, overcast, evening, night, or an HDRI",
    )  # fmt: skip
    group.add_argument(
        "--quality", choices=QUALITIES, default="good", help="draft, good or final (good)"
    )
    group.add_argument(
        "--denoiser", choices=("openimagedenoise", "optix", "none"), default="openimagedenoise",
        help="what cleans whole pictures (openimagedenoise)",
    )  # fmt: skip
    group.add_argument(
        "--samples", type=whole_number(1, 65_536), metavar="N",
        help="paths per pixel, at most (8, 128 or 1024, by the quality)",
    )  # fmt: skip


def look_of(options: argparse.Namespace) -> dict[str, Any]:
    """What add_look has read, as fields of RenderOptions."""
    from chord_usd.line.image.options import QUALITIES

    return {
        "resolution_px": _resolution_px(options),
        "quality": QUALITIES[options.quality],
        "samples": options.samples,
        "denoiser": options.denoiser,
        "passes": options.passes,
        "label_set": options.label_set,
        "room_names": options.room_names,
        "lighting": options.lighting,
        "sky": options.sky,
    }


def _resolution_px(options: argparse.Namespace) -> tuple[int, int]:
    """Width and height: as asked for, or as the quality has them."""
    from chord_usd.line.image.options import usual_px

    return options.resolution or usual_px(options.quality)


def add_how(parser: Parser) -> None:
    """The options that say where and how."""
    group = parser.add_argument_group("how")
    group.add_argument(
        "--engine", default="cycles", metavar="NAME",
        help="cycles, or web: rooms drawn by three.js in Chromium, in seconds, for data sets "
        "(cycles)",
    )  # fmt: skip
    group.add_argument(
        "--device", default="auto", metavar="NAME",
        help="auto, cpu, gpu, or a backend such as cuda (auto: a GPU if there is one)",
    )  # fmt: skip
    add_options(group, seed="of the noise (0)")
    group.add_argument(
        "--skip-existing", action="store_true",
        help="keep what is there already, if it is whole and was made with the same options",
    )  # fmt: skip


def _add_missing(parser: Parser) -> None:
    """Not for farms: thousands of tasks would paint plain colours, and nobody would look."""
    group = parser.add_argument_group("stages that are not whole")
    group.add_argument(
        "--allow-missing", action="store_true",
        help="paint plain colours where the stage lacks files, instead of refusing it",
    )  # fmt: skip


def _add_parts(parser: Parser) -> None:
    group = parser.add_argument_group("parts, for render farms")
    group.add_argument(
        "--tile", type=tile, metavar="I/N", help="only band I of N, the top one is 0, as an EXR"
    )
    group.add_argument(
        "--sample-block", type=tile, metavar="I/N", help="only share I of N of the samples"
    )
    group.add_argument(
        "--merge", action="store_true",
        help="make the pictures of the parts in the folder; give the options they were made with",
    )  # fmt: skip
    group.add_argument(
        "--require-version", metavar="VERSION",
        help="refuse to render with another version of chord-usd than this",
    )  # fmt: skip


def name_rooms(options: argparse.Namespace) -> None:
    """Let --room and --turntable have the names of prims. Raises StageError."""
    from chord_usd.line.pipeline.named_room import named_room

    options.room = [named_room(options.stage, said) for said in options.room]
    if options.turntable:
        options.turntable = named_room(options.stage, options.turntable)


def render_options(options: argparse.Namespace) -> RenderOptions:
    """What add_what and add_how have read. Raises RenderError."""
    from chord_usd.line.image.options import RenderOptions

    return RenderOptions(
        **look_of(options),
        cameras=tuple(options.camera),
        rooms=tuple(options.room),
        walkthrough=options.walkthrough,
        turntable=options.turntable,
        frames=options.frames,
        frame=options.frame,
        roof=options.roof,
        seed=options.seed,
        engine=options.engine,
        device=options.device,
        skip_existing=options.skip_existing,
    )


def words_of(options: argparse.Namespace) -> list[str]:
    """The same options as words of a command line, cameras and rooms left out."""
    width_px, height_px = _resolution_px(options)
    words = {
        "--resolution": f"{width_px}x{height_px}",
        "--passes": ",".join(options.passes),
        "--label-set": options.label_set,
        "--quality": options.quality,
        "--samples": options.samples,
        "--denoiser": options.denoiser,
        "--seed": options.seed,
        "--engine": options.engine,
        "--device": options.device,
        "--lighting": options.lighting,
        "--sky": options.sky,
        "--roof": options.roof,
        "--walkthrough": options.walkthrough or None,
        "--turntable": options.turntable,
        "--frames": options.frames if options.turntable else None,
    }
    given = [str(word) for pair in words.items() for word in pair if pair[1] not in (None, "")]
    return [*given, "--room-names"] if options.room_names else given


def named_files(options: argparse.Namespace) -> dict[str, Path]:
    """Files besides the stage that options name, by the option. Raises ChordError."""
    from chord_usd.base.scene.skies import sky_named

    sky = sky_named(options.sky).file
    return {"sky": sky} if sky else {}


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """A command line of chord-usd that begins with render. Raises UsageError."""
    parser = Parser()
    add(parser.add_subparsers())
    return parser.parse_args(words)


def picture_options(options: argparse.Namespace) -> RenderOptions:
    """All options of the verb. Raises RenderError."""
    from dataclasses import replace

    return replace(
        render_options(options),
        tile=options.tile,
        sample_block=options.sample_block,
        merge=options.merge,
        allow_missing=options.allow_missing,
    )


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.line.image.render import render_stage
    from chord_usd.line.stage.export.gltf import write_drawn

    if options.require_version not in (None, __version__):
        raise UsageError(
            f"this is chord-usd {__version__}",
            where="--require-version",
            expected=f"{options.require_version}, which made the job",
            try_=f"pip install . in a clone of chord-usd {options.require_version}",
        )
    stage = existing_file(options.stage)
    name_rooms(options)
    wanted = picture_options(options)
    watch = stopwatch(options)
    with watch.step("render") as progress:
        rendered = render_stage(stage, options.output, wanted, progress, write_drawn)
    pictures = [str(path) for path in rendered.pictures]
    data: Rendered = {
        "pictures": pictures,
        "files": [str(path) for path in rendered.files],
        "rendered": rendered.rendered,
        "device": rendered.device,
        "seconds": watch.seconds,
    }
    text = "\n".join([*pictures, *([f"rendered on {rendered.device}"] if rendered.device else [])])
    return Outcome(text, data, warnings=rendered.warnings)
