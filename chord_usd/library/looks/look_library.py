"""Draws wall and floor looks on demand, into the user's cache: a family and its parameters, once.

Planks_1f3a9c/look.json          what base/scene/looks.py reads
Planks_1f3a9c/Planks_1f3a9c.usda material package
Planks_1f3a9c/maps/Planks_1f3a9c_{base_color, roughness, normal}.jpg
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import AssetError, OutputError
from chord_usd.base.runtime.locations import CACHE_VARIABLE, cache_folder
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.scene.credits import AUTHOR, LICENCE
from chord_usd.base.scene.look_families import Family, Setting, family_named
from chord_usd.base.scene.looks import LOOK_FILE, Look, look_of, looks_in, read_entry
from chord_usd.base.scene.style_rooms import Part, looks_for
from chord_usd.base.scene.styles import HomeStyle
from chord_usd.base.scene.types import ROOM_KINDS, Room
from chord_usd.library.looks import look_coats, look_tiles, look_wood
from chord_usd.library.looks.look_ground import Raster
from chord_usd.library.looks.look_noise import normal_map
from chord_usd.library.looks.look_wood import Maps

BASE_PX = 1024
"""Side of the colour map unless asked otherwise; roughness and normals have half of it."""

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

_GENERATOR = (
    "look_boards.py", "look_coats.py", "look_colours.py", "look_ground.py", "look_library.py",
    "look_noise.py", "look_package.py", "look_tiles.py", "look_wood.py",
)  # fmt: skip


def draw_look(family: Family, settings: Mapping[str, object], px: int = BASE_PX) -> Maps:
    """The maps of a look. Raises AssetError for broken parameters."""
    chosen = family.settings(settings)
    if family.drawing not in DRAWINGS:
        raise AssetError(
            f"the family {family.name} has the drawing '{family.drawing}'",
            expected=f"one of {', '.join(DRAWINGS)}",
        )
    # The same grain whatever the size of the maps.
    seed = int.from_bytes(hashlib.sha256(_key(family, chosen)).digest()[:8], "big")
    maps = DRAWINGS[family.drawing](np.random.default_rng(seed), px, **chosen)
    height = np.ascontiguousarray(maps.height_m, dtype=np.float32)
    rough = np.clip(maps.roughness, 0.04, 1.0).astype(np.float32)
    return replace(maps, rgb=np.clip(maps.rgb, 0.0, 255.0), roughness=rough, height_m=height)


def look_name(family: Family, settings: Mapping[str, object], px: int = BASE_PX) -> str:
    """Name of a look by what it is: Planks_1f3a9c."""
    key = _key(family, family.settings(settings)) + (f"/{px}".encode() if px != BASE_PX else b"")
    words = "".join(word.capitalize() for word in family.name.split("_"))
    return f"{words}_{hashlib.sha256(key).hexdigest()[:6]}"


def _key(family: Family, chosen: Mapping[str, Setting]) -> bytes:
    return json.dumps([family.drawing, sorted(chosen.items())]).encode()


def drawn_look(
    family: Family,
    settings: Mapping[str, object],
    px: int = BASE_PX,
    kinds: Sequence[str] = ROOM_KINDS,
) -> Look:
    """A look in the cache, drawn where it is not there yet.

    Raises AssetError for broken parameters, OutputError when the cache cannot be written.
    """
    folder = drawn_folder()
    name = look_name(family, settings, px)
    if not (folder / name / LOOK_FILE).is_file():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with scratch_folder(folder) as hidden:
                write_look(name, family, settings, px, kinds, hidden)
                _move(hidden / name, folder / name)
        except OSError as error:
            raise OutputError(
                f"looks of walls and floors cannot be kept ({error.strerror or error})",
                where=str(folder),
                expected="a writable cache folder with 20 MB of space",
                try_=f"set {CACHE_VARIABLE} to another folder",
            ) from None
    return look_of(folder / name)


def _move(made: Path, place: Path) -> None:
    try:
        made.rename(place)
    except OSError:
        # Another process was faster; what it made is the same.
        if not (place / LOOK_FILE).is_file():
            raise


def write_look(
    name: str,
    family: Family,
    settings: Mapping[str, object],
    px: int,
    kinds: Sequence[str],
    folder: Path,
) -> Path:
    """Write one look package; the same bytes every time with the same Pillow."""
    from chord_usd.library.looks.look_package import map_file, write_material

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


def drawn_folder() -> Path:
    """Where this version's drawn looks are kept."""
    return cache_folder() / f"looks-{_generator_hash()}"


@lru_cache(maxsize=1)
def _generator_hash() -> str:
    """Twelve hexadecimal digits that change with any source that draws or writes looks."""
    digest = hashlib.sha256()
    for name in _GENERATOR:
        digest.update(name.encode() + b"\0" + (Path(__file__).parent / name).read_bytes() + b"\0")
    return digest.hexdigest()[:12]


@dataclass(frozen=True)
class StyleLooks:
    """The looks of a home: a user's own that suit a room before those that its style draws."""

    style: HomeStyle
    seed: int
    px: int = BASE_PX
    own: tuple[Look, ...] = ()

    def choices(self, part: Part, room: Room, count: int) -> list[Look]:
        """As scene.looks.LookSource."""
        own = [
            look for look in self.own if look.surface in (part, "both") and room.kind in look.kinds
        ][:count]
        even_px = self.px // 2 * 2
        wanted = looks_for(self.style, self.seed, part, room, count - len(own))
        drawn = [drawn_look(family_named(w.family), w.settings, even_px) for w in wanted]
        return [*own, *drawn]


def style_looks(
    style: HomeStyle, seed: int, px: int = BASE_PX, folder: Path | None = None
) -> StyleLooks:
    """The looks of a home. folder: of looks that go before; by default the materials folder.

    Raises AssetError for a damaged look.
    """
    return StyleLooks(style, seed, px, own_looks(folder))


def own_looks(folder: Path | None = None) -> tuple[Look, ...]:
    """Looks of a folder: packages with their maps, and those that name a family to be drawn."""
    found = []
    for file in looks_in(folder):
        entry = read_entry(file)
        if "family" in entry and not (file.parent / f"{entry['name']}.usda").is_file():
            family = family_named(str(entry["family"]))
            settings = family.settings(dict(entry.get("parameters", {})), str(file))
            found.append(drawn_look(family, settings, kinds=tuple(entry["kinds"])))
        else:
            found.append(look_of(file.parent))
    return tuple(found)
