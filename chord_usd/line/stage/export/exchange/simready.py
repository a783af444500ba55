"""Meshes of the database as props: the part of their packages that stands alone (library.prop)."""

from __future__ import annotations

import shutil
from pathlib import Path

from chord_usd.base.errors import AssetError
from chord_usd.base.scene.articulation import PROP
from chord_usd.base.scene.types import Asset
from chord_usd.line.stage.export.packages import package_files


def copy_prop(asset: Asset, folder: Path) -> Path:
    """Copy the prop of an asset into folder/asset.id; returns its root layer.

    Raises AssetError for an asset that cannot be read, points to files elsewhere, or has no prop.
    """
    package = package_files(asset.usd_path)
    files = {name: file for name, file in {**package.files, **package.linked}.items()
             if name.parts[0] == PROP}  # fmt: skip
    root = Path(PROP, asset.usd_path.name)
    if root not in files:
        raise AssetError(
            f"the package of {asset.id} holds no prop",
            where=str(asset.usd_path),
            expected=f"{PROP}/{asset.usd_path.name} in it",
            try_="<assets add>",
        )
    for name, file in files.items():
        place = folder / asset.id / name
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
    return folder / asset.id / root
