"""assets: the mesh database."""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver, output_folder
from chord_usd.base.scene.styles import MIXED
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_group,
    add_output,
    add_output_folder,
    add_verb,
    folder_mode,
    size_m,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file, output_place

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Stopwatch
    from chord_usd.base.scene.types import Asset
    from chord_usd.library.database import AssetDatabase

_HIDDEN = shutil.ignore_patterns(".*")

PICTURE_PX = 128
"""Side of the picture of one mesh, as lists of them show it."""


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "assets", "the meshes that layouts are furnished with")
    listing = add_verb(group, "list", run_list, "list the meshes of the database")
    listing.add_argument("--category", metavar="NAME", help="only this category")
    add_options(listing, unset=("style",), style="only forms that suit this style")
    add_options(listing, "asset_folders")
    _add_sheet(listing, "also draw a picture of each")
    _add_nearest(group)
    _add_export(group)
    grasps = add_verb(group, "grasps", run_grasps, "try where a gripper holds small things")
    grasps.add_argument(
        "ids", nargs="*", metavar="ID", help="which; without any, all that are small"
    )
    add_options(grasps, "asset_folders")
    show = add_verb(group, "show", run_show, "show one mesh: size, licence, files")
    show.add_argument("id", metavar="ID", help="as chord-usd assets list prints it")
    add_options(show, "asset_folders")
    _add_sheet(show, "also draw it in all of its colours")
    adding = add_verb(group, "add", run_add, "convert a library of models for --assets")
    adding.add_argument(
        "library",
        type=Path,
        metavar="PATH",
        help="a folder with manifest.json, 3D-FUTURE's folder, or a Sweet Home 3D library (.sh3f)",
    )
    add_output(
        adding, "the folder for --assets; models are added to those that it holds", output_place
    )
    adding.add_argument(
        "--triangles",
        type=whole_number(100, 10_000_000),
        default=20_000,
        metavar="N",
        help="meshes with more are reduced to it (20000)",
    )
    adding.add_argument(
        "--tag", dest="tags", action="append", default=[], metavar="TAG",
        help="what sets the models apart in their category, such as swivels; repeatable",
    )  # fmt: skip
    build = add_verb(group, "build", run_build, "build the parametric furniture as USD components")
    add_output_folder(build, "folder for the components")
    build.add_argument(
        "--pictures", action="store_true", help="also draw a picture of each into PATH/pictures"
    )


def _add_nearest(group: Verbs) -> None:
    parser = add_verb(group, "nearest", run_nearest, "list the meshes that come next to a size")
    parser.add_argument("category", metavar="CATEGORY", help="such as bed")
    parser.add_argument(
        "--size", type=size_m, required=True, metavar="LxWxH", help="in metres, such as 1.6x2.0x0.9"
    )
    parser.add_argument(
        "--count", type=whole_number(1, 100_000), default=8, metavar="N", help="at most so many (8)"
    )
    parser.add_argument(
        "--pictures", type=output_place, metavar="DIR", help="also draw a picture of each, ID.png"
    )
    add_options(parser, "asset_folders")


def _add_export(group: Verbs) -> None:
    parser = add_verb(group, "export", run_export, "write meshes as packages for simulators")
    parser.add_argument("ids", nargs="*", metavar="ID", help="which; without any, all there are")
    parser.add_argument(
        "--for", dest="package", choices=("simready",), required=True,
        help="simready: a folder each after NVIDIA's SimReady, profile Robotics-Prop 4.0.0",
    )  # fmt: skip
    add_output_folder(parser, "folder for the packages")
    add_options(parser, "asset_folders")


def _add_sheet(parser: argparse.ArgumentParser, summary: str) -> None:
    parser.add_argument("--sheet", type=output_file, metavar="PNG", help=summary)


def run_list(options: argparse.Namespace) -> Outcome:
    """Runs assets list."""
    from chord_usd.base.scene import palette
    from chord_usd.library.database import load_database

    if options.category:
        palette.category(options.category)
    database = load_database(options.asset_folders)
    assets = [
        a
        for a in database.assets
        if options.category in (None, a.category)
        and (options.style in (None, MIXED, *a.styles) or not a.styles)
    ]
    if options.sheet:
        _draw_sheet(database, assets, options)
    lines = [f"{a.id:<32} {a.category:<28} {_size(a)}" for a in assets]
    return Outcome("\n".join(lines), {"assets": [_described(asset) for asset in assets]})


def run_nearest(options: argparse.Namespace) -> Outcome:
    """Runs assets nearest."""
    from chord_usd.base.scene.palette import category
    from chord_usd.base.scene.types import Box
    from chord_usd.library.contact_sheet import colourways
    from chord_usd.library.database import load_database
    from chord_usd.line.graph.match import fitted_box
    from chord_usd.line.stage.export.packages import package_files

    watch = stopwatch(options)
    with watch.step("assets"):
        database = load_database(options.asset_folders)
        ranked = database.ranked(options.category, options.size, options.count)
    pictures = _draw_pictures(ranked, options.pictures, watch) if options.pictures else {}
    rows, lines = [], []
    for asset in ranked:
        room = Box((0.0, 0.0, 0.0), options.size, 0.0)
        box = fitted_box(room, asset, category(asset.category), is_guess=True)
        rows.append(
            {
                **_described(asset),
                "fits": {"center_m": list(box.center_m), "size_m": list(box.size_m)},
                "looks": {"colour": [name for name in colourways(asset) if name]},
                "picture": str(pictures.get(asset.id, "")),
                "shared": [str(file) for file in package_files(asset.usd_path).shared],
            }
        )
        lines.append(f"{asset.id:<32} {_size(asset)}")
    return Outcome("\n".join(lines), {"assets": rows})


def _draw_pictures(assets: Sequence[Asset], folder: Path, watch: Stopwatch) -> dict[str, Path]:
    """A picture of each asset in the folder; one younger than its mesh is not drawn again."""
    from PIL import Image

    from chord_usd.library.contact_sheet import draw_asset

    files = {asset.id: folder / f"{asset.id}.png" for asset in assets}
    with watch.step("pictures") as progress, deliver() as delivery:
        for done, asset in enumerate(assets):
            progress(done, len(assets))
            if not _is_younger(files[asset.id], asset.usd_path):
                target = delivery.place(files[asset.id], asked=False)
                Image.fromarray(draw_asset(asset, PICTURE_PX)).save(target, format="PNG")
        progress(len(assets), len(assets))
    return files


def _is_younger(picture: Path, mesh: Path) -> bool:
    return picture.is_file() and picture.stat().st_mtime >= mesh.stat().st_mtime


def run_show(options: argparse.Namespace) -> Outcome:
    """Runs assets show."""
    from chord_usd.library.database import load_database

    database = load_database(options.asset_folders)
    _known({asset.id: asset for asset in database.assets}, options.id)
    asset = database.named(options.id)
    if options.sheet:
        _draw_sheet(database, [asset], options, colours=True)
    data = _described(asset)
    return Outcome("\n".join(f"{key}: {value}" for key, value in data.items()), data)


def _known(assets: Mapping[str, Asset], name: str) -> Asset:
    """The asset of this id, perhaps not drawn yet. Raises UsageError."""
    from difflib import get_close_matches

    if name not in assets:
        near = get_close_matches(name, assets, n=1)
        raise UsageError(
            f"there is no mesh {name!r}",
            try_=f"chord-usd assets show {near[0]}" if near else "chord-usd assets list",
        )
    return assets[name]


def run_export(options: argparse.Namespace) -> Outcome:
    """Runs assets export."""
    from chord_usd.library.database import load_database
    from chord_usd.line.stage.export.exchange.simready import copy_prop

    database = load_database(options.asset_folders)
    known = {asset.id: asset for asset in database.assets}
    chosen = [_known(known, name).id for name in dict.fromkeys(options.ids or known)]
    watch = stopwatch(options)
    with (
        output_folder(options.output, folder_mode(options)) as folder,
        watch.step("assets") as progress,
    ):
        for done, name in enumerate(chosen):
            progress(done, len(chosen))
            copy_prop(database.named(name), folder)
        progress(len(chosen), len(chosen))
    data = {"folder": str(options.output), "assets": chosen, "seconds": watch.seconds}
    return Outcome(f"{options.output}: {counted(len(chosen), 'package')}", data)


def run_grasps(options: argparse.Namespace) -> Outcome:
    """Runs assets grasps."""
    from chord_usd.library.database import load_database
    from chord_usd.library.grasp_trials import write_grasps
    from chord_usd.library.grasps import is_graspable

    database = load_database(options.asset_folders)
    known = {asset.id: asset for asset in database.assets}
    small = [asset.id for asset in database.assets if is_graspable(asset)]
    chosen = [_known(known, name).id for name in dict.fromkeys(options.ids or small)]
    watch, results = stopwatch(options), []
    with watch.step("grasps") as progress:
        for done, name in enumerate(chosen):
            progress(done, len(chosen))
            trial = write_grasps(database.named(name))
            results.append({"id": name, "held": len(trial.held), "tried": trial.tried})
        progress(len(chosen), len(chosen))
    held = sum(bool(entry["held"]) for entry in results)
    lines = [f"{entry['id']:<32} {entry['held']} of {entry['tried']} hold" for entry in results]
    lines.append(f"{held} of {counted(len(results), 'design')} held")
    return Outcome("\n".join(lines), {"assets": results, "seconds": watch.seconds})


def run_build(options: argparse.Namespace) -> Outcome:
    """Runs assets build."""
    from chord_usd.library.database import build_assets

    watch = stopwatch(options)
    with output_folder(options.output, folder_mode(options)) as folder:
        with watch.step("assets") as progress:
            assets = build_assets(folder, progress)
        if options.pictures:
            _draw_pictures(assets, folder / "pictures", watch)
    data = {"folder": str(options.output), "assets": len(assets)}
    return Outcome(f"{options.output}: {counted(len(assets), 'component')}", data)


def run_add(options: argparse.Namespace) -> Outcome:
    """Runs assets add."""
    from chord_usd.library.libraries.add import add_library

    folder: Path = options.output
    with output_folder(folder, "add") as target, stopwatch(options).step("assets") as progress:
        if folder.is_dir():
            shutil.copytree(folder, target, dirs_exist_ok=True, ignore=_HIDDEN)
        added = add_library(
            options.library,
            target,
            most_triangles=options.triangles,
            tags=_known_tags(options.tags),
            progress=progress,
        )
    data = {
        "folder": str(folder),
        "added": [{**_described(a), "usd": f"{folder / a.id / a.id}.usda"} for a in added.assets],
        "refused": [{"id": refused.id, "why": refused.why} for refused in added.refused],
        "warnings": added.warnings,
    }
    lines = [f"{folder}: {counted(len(added.assets), 'model')} added, {len(added.refused)} refused"]
    lines += [f"  {refused.id}: {refused.why}" for refused in added.refused]
    if added.assets:
        lines.append("nothing of them opens (articulation): their meshes have no parts that move")
    return Outcome("\n".join(lines), data, warnings=added.warnings)


def _known_tags(names: Sequence[str]) -> Sequence[str]:
    """The tags; raises AssetError for one that the program does not know."""
    from chord_usd.library.database import TAGS

    for name in names:
        if name not in TAGS:
            raise AssetError(
                f"the tag '{name}' is unknown", where="--tag", expected=", ".join(sorted(TAGS))
            )
    return names


def _draw_sheet(
    database: AssetDatabase,
    assets: Sequence[Asset],
    options: argparse.Namespace,
    *,
    colours: bool = False,
) -> None:
    from chord_usd.library.contact_sheet import draw_sheet

    with deliver() as delivery, stopwatch(options).step("sheet") as progress:
        target = delivery.place(options.sheet)
        ready = [database.named(asset.id) for asset in assets]
        draw_sheet(ready, colours=colours, progress=progress).save(target, format="PNG")


def _described(asset: Asset) -> dict[str, Any]:
    return {
        "id": asset.id,
        "category": asset.category,
        "size_m": list(asset.size_m),
        "usd": str(asset.usd_path),
        "licence": asset.licence,
        "author": asset.author,
        "styles": list(asset.styles),
        "tags": list(asset.tags),
    }


def _size(asset: Asset) -> str:
    return " × ".join(f"{side:.2f}" for side in asset.size_m) + " m"
