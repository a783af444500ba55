"""The looks that ship in materials/: what each is made of, and how it is written.

OakPlank/look.json        what scene/looks.py reads
OakPlank/OakPlank.usda    material package
OakPlank/maps/{base_color, roughness, normal}.jpg
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.assets import look_maps as draw
from chord_usd.assets.look_maps import Boards, Maps
from chord_usd.assets.look_noise import Shape, normal_map
from chord_usd.scene.credits import AUTHOR, LICENCE
from chord_usd.scene.looks import LOOK_FILE, Surface
from chord_usd.scene.types import FloatArray, RoomKind

BASE_PX = 1024
RELIEF_PX = 512
"""Roughness and normals vary slowly enough for half the resolution."""


@dataclass(frozen=True)
class Recipe:
    """One look: what it is for and the function that draws it."""

    name: str
    label: str
    surface: Surface
    kinds: tuple[RoomKind, ...]
    tile_m: tuple[float, float]
    draw: Callable[[np.random.Generator, Shape, tuple[float, float]], Maps]
    rotation_deg: float = 0.0
    """How the pattern is usually laid."""


_DRY: tuple[RoomKind, ...] = (
    "living", "dining", "bedroom", "corridor", "study", "store", "unknown",
)  # fmt: skip
_REST: tuple[RoomKind, ...] = ("bedroom", "study", "living")
_WET: tuple[RoomKind, ...] = ("bathroom", "kitchen")
_ALL: tuple[RoomKind, ...] = (*_DRY, "kitchen")


def write_look(recipe: Recipe, folder: Path) -> Path:
    """Write one look package; the same bytes every time with the same Pillow."""
    from chord_usd.assets.look_package import write_material

    package = folder / recipe.name
    (package / "maps").mkdir(parents=True, exist_ok=True)
    # A seed of its own, so that adding a look leaves the others as they are.
    seed = int.from_bytes(hashlib.sha256(recipe.name.encode()).digest()[:8], "big")
    maps = recipe.draw(np.random.default_rng(seed), (BASE_PX, BASE_PX), recipe.tile_m)
    _save_maps(maps, recipe.tile_m, package / "maps")
    entry = {
        "name": recipe.name,
        "label": recipe.label,
        "surface": recipe.surface,
        "kinds": list(recipe.kinds),
        "tile_m": list(recipe.tile_m),
        "licence": LICENCE,
        "author": AUTHOR,
    }
    text = json.dumps(entry, indent=1) + "\n"
    (package / LOOK_FILE).write_text(text, encoding="utf-8")
    write_material(
        package / f"{recipe.name}.usda",
        recipe.tile_m,
        recipe.rotation_deg,
        {"label": recipe.label, "licence": LICENCE, "author": AUTHOR},
    )
    return package


def _save_maps(maps: Maps, tile_m: tuple[float, float], folder: Path) -> None:
    rough = _halved(maps.roughness) * 255.0
    normals = normal_map(_halved(maps.height_m), tile_m) * 255.0
    _save(maps.rgb, folder / "base_color.jpg", quality=84)
    _save(rough, folder / "roughness.jpg", quality=80)
    # Full chroma: the three channels of a normal are one vector, not a colour.
    _save(normals, folder / "normal.jpg", quality=88, subsampling=0)


def _halved(field: FloatArray) -> FloatArray:
    factor = BASE_PX // RELIEF_PX
    return field.reshape(RELIEF_PX, factor, RELIEF_PX, factor).mean(axis=(1, 3))


def _save(values: FloatArray, path: Path, **options: Any) -> None:
    from PIL import Image

    pixels = np.clip(np.round(values), 0, 255).astype(np.uint8)
    Image.fromarray(pixels).save(path, **options)


# --- recipes -----------------------------------------------------------------------------------


def _planks(
    dark: draw.Rgb, light: draw.Rgb, *, rows: int = 12, per_row: int = 2, **more: float
) -> Callable[..., Maps]:
    def make(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
        boards = draw.running_boards(rng, shape, tile_m, rows, per_row)
        return draw.wood_floor(rng, boards, dark, light, **more)

    return make


def _herringbone(
    dark: draw.Rgb, light: draw.Rgb, *, ratio: int = 5, periods: int = 2
) -> Callable[..., Maps]:
    def make(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
        boards = draw.herringbone(shape, tile_m, ratio, periods)
        return draw.wood_floor(rng, boards, dark, light, variation=0.075, gap_m=0.0012)

    return make


def _grid(
    rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float], rows: int, columns: int,
    offset: float = 0.0,
) -> Boards:  # fmt: skip
    return draw.running_boards(rng, shape, tile_m, rows, columns, offset=offset)


def _stone(
    dark: draw.Rgb, light: draw.Rgb, grout: draw.Rgb, *, count: int = 3, contrast: float = 0.16,
    roughness: float = 0.35,
) -> Callable[..., Maps]:  # fmt: skip
    def make(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
        boards = _grid(rng, shape, tile_m, count, count)
        face = draw.stone_face(rng, boards, dark, light, contrast)
        return draw.laid_tile(rng, boards, face, grout=grout, grout_m=0.003, roughness=roughness)

    return make


def _marble(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
    boards = _grid(rng, shape, tile_m, 2, 2)
    face = draw.marble_face(rng, boards, (128, 128, 132), (240, 238, 234))
    return draw.laid_tile(
        rng, boards, face, grout=(206, 203, 198), grout_m=0.0015, roughness=0.14,
        variation=0.006, cushion_m=0.0004,
    )  # fmt: skip


def _glazed(
    tone: draw.Rgb, grout: draw.Rgb, *, rows: int, columns: int, offset: float, variation: float,
    waviness_m: float, roughness: float = 0.12,
) -> Callable[..., Maps]:  # fmt: skip
    def make(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
        boards = _grid(rng, shape, tile_m, rows, columns, offset)
        face = np.broadcast_to(np.array(tone, dtype=np.float64), (*shape, 3))
        return draw.laid_tile(
            rng, boards, face, grout=grout, grout_m=0.002, roughness=roughness,
            variation=variation, waviness_m=waviness_m,
        )  # fmt: skip

    return make


def _brick(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
    boards = _grid(rng, shape, tile_m, 16, 5, 0.5)
    return draw.brickwork(rng, boards, (122, 62, 46), (176, 102, 74), (196, 187, 174))


def _concrete(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
    boards = _grid(rng, shape, tile_m, 2, 2)
    return draw.concrete(rng, boards, (138, 137, 133), (186, 185, 180))


def _panel(dark: draw.Rgb, light: draw.Rgb) -> Callable[..., Maps]:
    def make(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
        lying = draw.running_boards(rng, shape, (tile_m[1], tile_m[0]), 10, 1)
        return draw.wood_floor(
            rng, draw.stood_up(lying), dark, light, variation=0.05, gap_m=0.004, bevel_m=0.003,
            roughness=0.5,
        )  # fmt: skip

    return make


def _plaster(tone: draw.Rgb) -> Callable[..., Maps]:
    return lambda rng, shape, tile_m: draw.plaster(rng, shape, tone)


def _carpet(dark: draw.Rgb, light: draw.Rgb) -> Callable[..., Maps]:
    return lambda rng, shape, tile_m: draw.carpet(rng, shape, dark, light)


def _stripes(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
    return draw.striped_paper(rng, shape, (226, 224, 216), (198, 204, 202), (176, 160, 124), 6)


def _leaves(rng: np.random.Generator, shape: Shape, tile_m: tuple[float, float]) -> Maps:
    return draw.leafy_paper(rng, shape, (231, 227, 215), (150, 168, 142), (172, 170, 146))


RECIPES: tuple[Recipe, ...] = (
    Recipe("OakPlank", "Oak planks", "floor", _ALL, (2.0, 1.92),
           _planks((150, 110, 70), (206, 168, 122))),
    Recipe("WalnutPlank", "Walnut planks", "floor", _DRY, (2.0, 1.68),
           _planks((70, 44, 30), (126, 86, 58), variation=0.11)),
    Recipe("PalePlank", "Pale ash planks", "floor", _ALL, (2.2, 2.2),
           _planks((190, 166, 134), (226, 208, 180), rows=11, variation=0.05)),
    Recipe("GreyOakPlank", "Grey oak planks", "floor", _DRY, (2.0, 1.92),
           _planks((128, 118, 106), (182, 172, 158), variation=0.07)),
    Recipe("OakHerringbone", "Oak herringbone", "floor", _DRY, (1.8, 1.8),
           _herringbone((146, 104, 64), (200, 158, 110)), rotation_deg=45.0),
    Recipe("BeigeLaminate", "Beige three-strip laminate", "floor", _ALL, (1.8, 1.54),
           _planks((176, 148, 112), (214, 190, 156), rows=22, per_row=3, variation=0.06,
                   gap_m=0.0009, roughness=0.34)),
    Recipe("DeckPlank", "Larch decking", "floor", ("balcony",), (2.0, 1.96),
           _planks((122, 86, 58), (170, 128, 92), rows=14, per_row=1, variation=0.1, gap_m=0.004,
                   roughness=0.7, bevel_m=0.003)),
    Recipe("WhiteTile", "White stone tile", "floor", _WET, (1.8, 1.8),
           _stone((214, 212, 208), (240, 239, 236), (188, 185, 180), contrast=0.11)),
    Recipe("GreyTile", "Grey stone tile", "floor", (*_WET, "balcony", "corridor"), (1.8, 1.8),
           _stone((118, 118, 118), (166, 165, 163), (104, 103, 102))),
    Recipe("BeigeTile", "Beige stone tile", "floor", (*_WET, "balcony", "dining", "corridor"),
           (1.8, 1.8), _stone((190, 172, 146), (226, 211, 188), (176, 164, 146))),
    Recipe("Terrazzo", "Terrazzo", "floor", (*_WET, "corridor", "balcony", "dining"), (1.2, 1.2),
           lambda rng, shape, tile_m: draw.terrazzo(rng, shape)),
    Recipe("Marble", "White marble slabs", "both", ("bathroom",), (1.6, 1.6), _marble),
    Recipe("GreyCarpet", "Grey loop carpet", "floor", ("bedroom", "study"), (0.8, 0.8),
           _carpet((104, 106, 110), (158, 160, 163))),
    Recipe("SandCarpet", "Sand loop carpet", "floor", ("bedroom",), (0.8, 0.8),
           _carpet((158, 142, 120), (208, 194, 172))),
    Recipe("WhitePlaster", "White plaster", "wall", (*_ALL, "balcony"), (1.5, 1.5),
           _plaster((240, 239, 235))),
    Recipe("WarmPlaster", "Warm plaster", "wall", _ALL, (1.5, 1.5), _plaster((236, 227, 211))),
    Recipe("CoolPlaster", "Cool plaster", "wall", (*_REST, "corridor", "dining"), (1.5, 1.5),
           _plaster((213, 221, 226))),
    Recipe("SagePlaster", "Sage plaster", "wall", _REST, (1.5, 1.5), _plaster((199, 208, 190))),
    Recipe("StripedPaper", "Striped wallpaper", "wall", ("bedroom", "dining", "living"),
           (1.06, 1.06), _stripes),
    Recipe("LeafPaper", "Leaf wallpaper", "wall", ("bedroom", "living"), (0.64, 0.64), _leaves),
    Recipe("RedBrick", "Red brick", "wall", ("balcony", "living", "study"), (1.25, 1.2), _brick),
    Recipe("Concrete", "Fair-faced concrete", "both", ("balcony", "corridor", "study", "store"),
           (2.4, 2.4), _concrete),
    Recipe("OakPanel", "Oak panelling", "wall", ("living", "study", "dining"), (1.5, 2.7),
           _panel((158, 116, 74), (202, 162, 114))),
    Recipe("MetroTile", "White metro tile", "wall", _WET, (1.2, 1.2),
           _glazed((240, 240, 237), (172, 170, 166), rows=16, columns=8, offset=0.5,
                   variation=0.012, waviness_m=0.00004)),
    Recipe("GlazedTile", "Green glazed tile", "wall", _WET, (1.0, 1.0),
           _glazed((172, 192, 180), (214, 211, 203), rows=10, columns=10, offset=0.0,
                   variation=0.055, waviness_m=0.00009)),
    Recipe("LargeWallTile", "Light grey wall tile", "wall", _WET, (1.8, 1.8),
           _stone((206, 205, 201), (228, 227, 224), (196, 194, 190), contrast=0.08,
                  roughness=0.28)),
)  # fmt: skip
