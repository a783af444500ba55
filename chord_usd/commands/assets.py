"""assets: the mesh database."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from chord_usd.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_assets,
    add_group,
    add_output,
    add_verb,
    stopwatch,
)
from chord_usd.files import output_folder

if TYPE_CHECKING:
    from chord_usd.types import Asset


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "assets", "the meshes that layouts are furnished with")
    listing = add_verb(group, "list", run_list, "list the meshes of the database")
    listing.add_argument("--category", metavar="NAME", help="only this category")
    add_assets(listing)
    show = add_verb(group, "show", run_show, "show one mesh: size, licence, files")
    show.add_argument("id", metavar="ID", help="as chord-usd assets list prints it")
    add_assets(show)
    build = add_verb(group, "build", run_build, "build the parametric furniture as USD components")
    add_output(build, "folder for the components, replaced as a whole")


def run_list(options: argparse.Namespace) -> Outcome:
    """Runs assets list."""
    from chord_usd import palette
    from chord_usd.assets.database import load_database

    if options.category:
        palette.category(options.category)
    assets = [
        asset
        for asset in load_database(options.assets).assets
        if options.category in (None, asset.category)
    ]
    lines = [f"{a.id:<32} {a.category:<28} {_size(a)}" for a in assets]
    return Outcome("\n".join(lines), {"assets": [_described(asset) for asset in assets]})


def run_show(options: argparse.Namespace) -> Outcome:
    """Runs assets show."""
    from difflib import get_close_matches

    from chord_usd.assets.database import load_database

    assets = {asset.id: asset for asset in load_database(options.assets).assets}
    if options.id not in assets:
        near = get_close_matches(options.id, assets, n=1)
        raise UsageError(
            f"there is no mesh {options.id!r}",
            try_=f"chord-usd assets show {near[0]}" if near else "chord-usd assets list",
        )
    data = _described(assets[options.id])
    return Outcome("\n".join(f"{key}: {value}" for key, value in data.items()), data)


def run_build(options: argparse.Namespace) -> Outcome:
    """Runs assets build."""
    from chord_usd.assets.database import build_assets

    with output_folder(options.output) as folder, stopwatch(options).step("assets") as progress:
        assets = build_assets(folder, progress)
    data = {"folder": str(options.output), "assets": len(assets)}
    return Outcome(f"{options.output}: {len(assets)} components", data)


def _described(asset: Asset) -> dict[str, Any]:
    return {
        "id": asset.id,
        "category": asset.category,
        "size_m": list(asset.size_m),
        "usd": str(asset.usd_path),
        "licence": asset.licence,
        "author": asset.author,
    }


def _size(asset: Asset) -> str:
    return " × ".join(f"{side:.2f}" for side in asset.size_m) + " m"
