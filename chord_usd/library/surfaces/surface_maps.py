"""Maps of finishes: the colour of each, relief and roughness of what it is made of, as files.

The files lie in one folder beside the assets and are named after their content, so that whatever
is of the same oak shares them, here and wherever they are copied.
"""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.surfaces import surface_cloth, surface_mineral, surface_wood, surface_worked
from chord_usd.library.surfaces.finishes import Finish
from chord_usd.library.surfaces.surface_pattern import Pattern
from chord_usd.library.textures.fields import Ground, normal_map

TileM = tuple[float, float]

MAPS_FOLDER = "Finishes"
"""Name of the folder of maps beside the components of a database."""

MAP_PX = 512
"""Side of a map unless asked otherwise."""

ROUGHNESS_RANGE = 2.0
"""What white of a roughness map stands for: twice the roughness of the finish."""

SURFACES: dict[str, tuple[TileM, Callable[[np.random.Generator, Ground], Pattern]]] = {
    "wood": ((1.3, 0.72), surface_wood.wood),
    "rattan": ((0.096, 0.096), surface_wood.rattan),
    "bark": ((0.16, 0.12), surface_wood.bark),
    "soil": ((0.2, 0.2), surface_wood.soil),
    "leaf": ((0.12, 0.06), surface_wood.leaf),
    "weave": ((0.208, 0.208), surface_cloth.weave),
    "linen": ((0.2, 0.2), surface_cloth.linen),
    "crumpled": ((0.9, 0.9), surface_cloth.crumpled),
    "knit": ((0.192, 0.192), surface_cloth.knit),
    "boucle": ((0.24, 0.24), surface_cloth.boucle),
    "velvet": ((0.5, 0.5), surface_cloth.velvet),
    "leather": ((0.3, 0.3), surface_cloth.leather),
    "paper": ((0.2, 0.2), surface_cloth.paper),
    "brushed": ((0.5, 0.25), surface_mineral.brushed),
    "stone": ((0.9, 0.9), surface_mineral.stone),
    "marble": ((1.3, 1.3), surface_mineral.marble),
    "quartz": ((0.4, 0.4), surface_mineral.quartz),
    "ceramic": ((0.25, 0.25), surface_mineral.ceramic),
    "concrete": ((1.0, 1.0), surface_mineral.concrete),
    "terracotta": ((0.3, 0.3), surface_mineral.terracotta),
    "polished": ((0.4, 0.4), surface_worked.polished),
    "powder": ((0.16, 0.16), surface_worked.powder),
    "patina": ((0.25, 0.25), surface_worked.patina),
    "glaze": ((0.3, 0.3), surface_worked.glaze),
    "moulded": ((0.12, 0.12), surface_worked.moulded),
    "peel": ((0.08, 0.08), surface_worked.peel),
    "kernels": ((0.12, 0.12), surface_worked.kernels),
}
"""Size of the tile in metres, along the grain first, and what draws it."""


def _encoded(linear: FloatArray) -> FloatArray:
    """sRGB, 0 to 255, of linear light."""
    low, high = 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, low, high) * 255.0


_SRGB = _encoded(np.linspace(0.0, 1.0, 1 << 14))
"""A table: powers of a quarter of a million pixels take longer than all the rest."""


@dataclass(frozen=True)
class MapFiles:
    """Names of the files of a finish in the folder of maps, and the size of their tile."""

    colour: str
    roughness: str
    normal: str
    tile_m: TileM


def has_maps(finish: Finish) -> bool:
    """Whether a finish is drawn, and not one even colour or a picture."""
    return finish.surface != "plain" and finish.texture is None


@lru_cache(maxsize=64)
def pattern_of(surface: str, px: int) -> Pattern:
    """The tile of a surface, px wide and high; the same every time."""
    # A seed of its own, so that adding a surface leaves the others as they are.
    seed = int.from_bytes(hashlib.sha256(surface.encode()).digest()[:8], "big")
    tile_m, draw = SURFACES[surface]
    return draw(np.random.default_rng(seed), Ground(px, tile_m))


def colour_map(finish: Finish, px: int) -> FloatArray:
    """(px, px, 3) sRGB, 0 to 255, whose mean in linear light is the colour of the finish."""
    pattern = pattern_of(finish.surface, px)
    base = np.maximum(np.array(finish.linear_rgb()), 0.002)
    darkness = -np.log(np.minimum(base, 0.98))
    luminance = float(np.exp(-np.log(base) @ np.array([-0.2126, -0.7152, -0.0722])))
    # Light that goes deeper into the material loses most of what it has least of.
    weight = np.clip(darkness / -np.log(min(luminance, 0.97)), 0.4, 2.2)
    weight = 1.0 + pattern.tinted * (weight - 1.0)
    depth, warmth = finish.contrast * pattern.depth, pattern.warmth
    channels = []
    for mean, share, warmed in zip(base.tolist(), weight.tolist(), (1.0, 0.0, -1.4), strict=True):
        linear = mean * np.exp(-1.6 * share * depth)
        if warmth is not None and warmed:
            linear *= 1.0 + warmed * warmth
        for _ in range(3):  # again, since what is cut off at white is missing in the mean
            linear *= mean / linear.mean()
            np.clip(linear, 0.0, 1.0, out=linear)
        channels.append(_SRGB[np.rint(linear * (len(_SRGB) - 1)).astype(np.uint16)])
    return np.stack(channels, axis=-1)


def map_files(finish: Finish, folder: Path, px: int = MAP_PX) -> MapFiles:
    """The maps of a finish in folder; those that are not there are drawn. Raises OSError."""
    red, green, blue = finish.rgb
    surface = finish.surface
    tint = f"{red:02x}{green:02x}{blue:02x}" + (
        f"_{round(100 * finish.contrast)}" if finish.contrast != 1.0 else ""
    )

    def roughness() -> FloatArray:
        return pattern_of(surface, px).roughness * (255.0 / ROUGHNESS_RANGE)

    def normal() -> FloatArray:
        pattern = pattern_of(surface, px)
        return normal_map(pattern.height_m, pattern.ground.tile_m) * 255.0

    return MapFiles(
        _kept(folder, f"{surface}_{tint}_{px}", lambda: colour_map(finish, px), 88),
        _kept(folder, f"{surface}_roughness_{px}", roughness, 84),
        _kept(folder, f"{surface}_normal_{px}", normal, 90),
        SURFACES[surface][0],
    )


def _kept(folder: Path, name: str, draw: Callable[[], FloatArray], quality: int) -> str:
    """Name of the file that begins so, drawn if none is there."""
    known = _KNOWN.get((folder, name))
    if known and (folder / known).is_file():
        return known
    there = sorted(folder.glob(f"{name}_*.jpg"))
    file_name = there[0].name if there else _drawn(folder, name, draw, quality)
    _KNOWN[folder, name] = file_name
    return file_name


_KNOWN: dict[tuple[Path, str], str] = {}
"""Files found before: a folder of hundreds is searched once for each."""


def _drawn(folder: Path, name: str, draw: Callable[[], FloatArray], quality: int) -> str:
    data = _jpeg(draw(), quality)
    file = folder / f"{name}_{hashlib.sha256(data).hexdigest()[:12]}.jpg"
    folder.mkdir(parents=True, exist_ok=True)
    # Another process may be drawing the same: each has a file of its own until it is whole.
    scratch = folder / f".{file.name}.{os.getpid()}"
    scratch.write_bytes(data)
    scratch.replace(file)
    return file.name


def _jpeg(values: FloatArray, quality: int) -> bytes:
    from PIL import Image

    pixels = np.clip(np.round(values), 0, 255).astype(np.uint8)
    buffer = io.BytesIO()
    # Full chroma where the channels are one vector, or the colour is that of single threads.
    Image.fromarray(pixels).save(buffer, "JPEG", quality=quality, subsampling=0)
    return buffer.getvalue()
