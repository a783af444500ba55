"""Assets that a scene file names by their path: which of them may be used."""

from __future__ import annotations

import os
from collections.abc import Sequence, Set
from dataclasses import replace
from pathlib import Path

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.asset_stages import EXPECTED, try_assets
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.base.runtime.locations import absolute, cache_folder, is_cached
from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.types import Asset, Item, SceneGraph
from chord_usd.library.database import INDEX_NAME, AssetDatabase, embedded_assets

_EXPECTED = "a USD layer in the scene's folder, or in a folder of further meshes"


def with_found_assets(
    graph: SceneGraph, scene: Path, folders: Sequence[Path], database: AssetDatabase
) -> SceneGraph:
    """The graph with the assets that are on this machine; items whose asset is lost have none.

    scene: the file that names the assets; relative paths start from its folder. folders: those
    that the user vouches for; the cache of the shipped assets is one more, and what another user's
    cache holds is taken from ours. Raises AssetError for an asset elsewhere, or one that is no USD
    layer: a scene may come from anyone, and what it names is copied beside the house.
    """
    home = absolute(scene).parent
    allowed = [*(folder.resolve() for folder in (home, *folders, cache_folder()))]
    named = {asset.usd_path: asset for asset in graph.assets()}
    shipped = {asset.id for asset in embedded_assets()}
    places: dict[Path, Path] = {}
    for path, asset in sorted(named.items()):
        place = _locate(path, home, allowed) or _same_here(asset, shipped, database)
        if place is None:
            continue
        if not _is_inside(place, allowed) or is_cached(place):
            place = _same_here(asset, shipped, database) or place
        _require_inside(place, scene, allowed)
        places[path] = place
    _require_layers([place for place in places.values() if not is_cached(place)])
    items, dressing = (
        tuple(_with_assets(item, places) for item in all_) for all_ in (graph.items, graph.dressing)
    )
    return replace(graph, items=items, dressing=dressing)


def _with_assets(item: Item, places: dict[Path, Path]) -> Item:
    place = places.get(item.asset.usd_path) if item.asset else None
    asset = replace(item.asset, usd_path=place) if item.asset and place else None
    children = tuple(_with_assets(child, places) for child in item.children)
    return replace(item, asset=asset, children=children)


def _locate(path: Path, home: Path, allowed: Sequence[Path]) -> Path | None:
    """Where the path leads to: from the scene's folder or the cache, else from the current one into
    a folder that is allowed. None where nothing is there."""
    try:
        for start in (home, cache_folder()):
            if os.path.lexists(start / path):
                return Path(os.path.abspath(start / path))  # noqa: PTH100 (not through links)
        here = absolute(path)
        return here if here.is_file() and _is_inside(here, allowed) else None
    except (OSError, ValueError):  # too long, or not a path at all
        return None


def _same_here(asset: Asset, shipped: Set[str], database: AssetDatabase) -> Path | None:
    """Where the shipped asset of this name is drawn for this user; None for what is not shipped."""
    if asset.id not in shipped or asset.usd_path.parts[-2:] != (asset.id, f"{asset.id}.usda"):
        return None
    return database.named(asset.id).usd_path


def _require_inside(place: Path, scene: Path, allowed: Sequence[Path]) -> None:
    if not _is_inside(place, allowed):
        raise AssetError(
            f"names the asset {place}",
            where=str(scene),
            expected=_EXPECTED,
            try_=(
                f"<asset_folders={_database_of(place)}>",
                "a copy of the asset's folder beside the scene",
            ),
        )
    if not place.is_file() or place.suffix not in STAGE_SUFFIXES:
        raise AssetError(
            f"names the asset {place}, which is no USD file", where=str(scene), expected=_EXPECTED
        )


def _database_of(place: Path) -> Path | str:
    """The folder that --assets takes for an asset, where it lies in one."""
    return next(
        (folder for folder in place.resolve().parents if (folder / INDEX_NAME).is_file()),
        "DATABASE",
    )


def _require_layers(places: Sequence[Path]) -> None:
    """Try what this program has not drawn itself, all in one process."""
    try_assets(places)
    for place in places:
        if not open_layer(place).defaultPrim:
            raise AssetError("has no default prim", where=str(place), expected=EXPECTED)


def _is_inside(place: Path, folders: Sequence[Path]) -> bool:
    """Whether a file lies in one of the folders; links count as what they lead to."""
    real = place.resolve()
    return any(real.is_relative_to(folder) for folder in folders)
