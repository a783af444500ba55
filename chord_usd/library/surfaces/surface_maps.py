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
from chord_usd.library.looks.look_noise import normal_map
from chord_usd.library.surfaces import surface_cloth, surface_mineral, surface_wood, surface_worked
from chord_usd.library.surfaces.finishes import Finish
from chord_usd.library.surfaces.surface_pattern import Pattern, TileM

MAPS_FOLDER = "Finishes"
"""Name of the folder of maps beside the components of a database."""

MAP_PX = 512
"""Side of a map unless asked otherwise."""

ROUGHNESS_RANGE = 2.0
"""What white of a roughness map stands for: twice the roughness of the finish."""

SURFACES: dict[str, Callable[[np.random.Generator, int], Pattern]] = {
    "wood": surface_wood.wood,
    "rattan": surface_wood.rattan,
    "bark": surface_wood.bark,
    "soil": surface_wood.soil,
    "leaf": surface_wood.leaf,
    "weave": surface_cloth.weave,
    "linen": surface_cloth.linen,
    "crumpled": surface_cloth.crumpled,
    "knit": surface_cloth.knit,
    "boucle": surface_cloth.boucle,
    "velvet": surface_cloth.velvet,
    "leather": surface_cloth.leather,
    "paper": surface_cloth.paper,
    "brushed": surface_mineral.brushed,
    "stone": surface_mineral.stone,
    "marble": surface_mineral.marble,
    "quartz": surface_mineral.quartz,
    "ceramic": surface_mineral.ceramic,
    "concrete": surface_mineral.concrete,
    "terracotta": surface_mineral.terracotta,
    "polished": surface_worked.polished,
    "powder": surface_worked.powder,
    "patina": surface_worked.patina,
    "glaze": surface_worked.glaze,
    "moulded": surface_worked.moulded,
    "peel": surface_worked.peel,
    "kernels": surface_worked.kernels,
}


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
    return SURFACES[surface](np.random.default_rng(seed), px)


def colour_map(finish: Finish, px: int) -> FloatArray:
    """(px, px, 3) sRGB, 0 to 255, whose mean in linear light is the colour of the finish."""
    pattern = pattern_of(finish.surface, px)
    base = np.maximum(np.array(finish.linear_rgb()), 0.002)
    darkness = -np.log(np.minimum(base, 0.98))
    luminance = float(np.exp(-np.log(base) @ np.array([-0.2126, -0.7152, -0.0722])))
    # Light that goes deeper into the material loses most of what it has least of.
    weight = np.clip(darkness / -np.log(min(luminance, 0.97)), 0.4, 2.2)
    weight = 1.0 + pattern.tinted * (weight - 1.0)
    depth = (finish.contrast * pattern.depth).astype(np.float32)
    warmth = None if pattern.warmth is None else pattern.warmth.astype(np.float32)
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
        return normal_map(pattern.height_m, pattern.tile_m) * 255.0

    return MapFiles(
        _kept(folder, f"{surface}_{tint}_{px}", lambda: colour_map(finish, px), 88),
        _kept(folder, f"{surface}_roughness_{px}", roughness, 84),
        _kept(folder, f"{surface}_normal_{px}", normal, 90),
        tile_of(surface),
    )


@lru_cache(maxsize=64)
def tile_of(surface: str) -> TileM:
    """Size of the tile of a surface in metres."""
    return pattern_of(surface, 16).tile_m


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
