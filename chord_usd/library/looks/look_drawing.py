"""Draws the maps of a look and writes its package, once the cache lacks it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import AssetError
from chord_usd.base.scene.credits import AUTHOR, LICENCE
from chord_usd.base.scene.look_families import Family
from chord_usd.base.scene.looks import LOOK_FILE
from chord_usd.library.looks import look_coats, look_tiles, look_wood
from chord_usd.library.looks.look_library import BASE_PX, look_key
from chord_usd.library.looks.look_package import map_file, write_material
from chord_usd.library.looks.look_wood import Maps
from chord_usd.library.textures.fields import Raster, normal_map

DRAWINGS: dict[str, Callable[..., Maps]] = {
    "planks": look_wood.planks,
    "herringbone": look_wood.laid_herringbone,
    "chevron": look_wood.laid_chevron,
    "parquet": look_wood.parquet,
    "laminate": look_wood.laminate,
    "panelling": look_wood.panelling,
    "wainscot": look_wood.wainscot,
    "stone_tile": look_tiles.stone_tile,
    "mosaic": look_tiles.mosaic,
    "glazed": look_tiles.glazed,
    "marble": look_tiles.marble,
    "terrazzo": look_tiles.terrazzo,
    "brick": look_tiles.brick,
    "plaster": look_coats.plaster,
    "limewash": look_coats.limewash,
    "concrete": look_coats.concrete,
    "carpet": look_coats.carpet,
    "tatami": look_coats.tatami,
    "wallpaper": look_coats.wallpaper,
}
"""Functions (rng, px, **parameters) by the name that families have them under."""


def draw_look(family: Family, settings: Mapping[str, object], px: int = BASE_PX) -> Maps:
    """The maps of a look. Raises AssetError for broken parameters."""
    chosen = family.settings(settings)
    if family.drawing not in DRAWINGS:
        raise AssetError(
            f"the family {family.name} has the drawing '{family.drawing}'",
            expected=f"one of {', '.join(DRAWINGS)}",
        )
    # The same grain whatever the size of the maps.
    seed = int.from_bytes(hashlib.sha256(look_key(family, chosen)).digest()[:8], "big")
    maps = DRAWINGS[family.drawing](np.random.default_rng(seed), px, **chosen)
    height = np.ascontiguousarray(maps.height_m, dtype=np.float32)
    rough = np.clip(maps.roughness, 0.04, 1.0).astype(np.float32)
    return replace(maps, rgb=np.clip(maps.rgb, 0.0, 255.0), roughness=rough, height_m=height)


def write_look(
    name: str,
    family: Family,
    settings: Mapping[str, object],
    px: int,
    kinds: Sequence[str],
    folder: Path,
) -> Path:
    """Write one look package; the same bytes every time with the same Pillow."""
    maps = draw_look(family, settings, px)
    package = folder / name
    (package / "maps").mkdir(parents=True, exist_ok=True)
    _save_maps(maps, lambda kind: package / "maps" / map_file(name, kind))
    tile_m = (round(maps.ground.tile_m[0], 6), round(maps.ground.tile_m[1], 6))
    entry = {
        "name": name,
        "label": family.label,
        "surface": family.surface,
        "kinds": list(kinds),
        "tile_m": list(tile_m),
        "standing": maps.standing,
        "licence": LICENCE,
        "author": AUTHOR,
        "family": family.name,
        "parameters": family.settings(settings),
    }
    about = {"label": family.label, "licence": LICENCE, "author": AUTHOR}
    write_material(package / f"{name}.usda", tile_m, 0.0, about)
    (package / LOOK_FILE).write_text(json.dumps(entry, indent=1) + "\n", encoding="utf-8")
    return package


def _save_maps(maps: Maps, place: Callable[[str], Path]) -> None:
    _save(maps.rgb, place("base_color"), quality=86)
    _save(_halved(maps.roughness) * 255.0, place("roughness"), quality=80)
    # Full chroma: the three channels of a normal are one vector, not a colour.
    normals = normal_map(_halved(maps.height_m), maps.ground.tile_m) * 255.0
    _save(normals, place("normal"), quality=88, subsampling=0)


def _halved(field: Raster) -> Raster:
    side = field.shape[0] // 2
    half: Raster = field.reshape(side, 2, side, 2).mean(axis=(1, 3))
    return half


def _save(values: Raster, path: Path, **options: Any) -> None:
    from PIL import Image

    pixels = (np.clip(values, 0.0, 255.0) + 0.5).astype(np.uint8)
    Image.fromarray(pixels).save(path, **options)
