"""Draws wall and floor looks on demand, into the user's cache: a family and its parameters, once.

Planks_1f3a9c/look.json          what base/scene/looks.py reads
Planks_1f3a9c/Planks_1f3a9c.usda material package
Planks_1f3a9c/maps/Planks_1f3a9c_{base_color, roughness, normal}.jpg
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from chord_usd.base.errors import OutputError
from chord_usd.base.runtime.locations import CACHE_VARIABLE, cache_folder
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.scene.look_families import Family, Setting, family_named
from chord_usd.base.scene.looks import LOOK_FILE, Look, look_of, looks_in, read_entry
from chord_usd.base.scene.style_rooms import Part, looks_for
from chord_usd.base.scene.styles import HomeStyle
from chord_usd.base.scene.types import ROOM_KINDS, Room

BASE_PX = 1024
"""Side of the colour map unless asked otherwise; roughness and normals have half of it."""

_GENERATOR = (
    "look_coats.py", "look_colours.py", "look_drawing.py", "look_library.py", "look_package.py",
    "look_tiles.py", "look_wood.py", "../textures/boards.py", "../textures/fields.py",
)  # fmt: skip


def look_name(family: Family, settings: Mapping[str, object], px: int = BASE_PX) -> str:
    """Name of a look by what it is: Planks_1f3a9c."""
    key = look_key(family, family.settings(settings)) + (
        f"/{px}".encode() if px != BASE_PX else b""
    )
    words = "".join(word.capitalize() for word in family.name.split("_"))
    return f"{words}_{hashlib.sha256(key).hexdigest()[:6]}"


def look_key(family: Family, chosen: Mapping[str, Setting]) -> bytes:
    """What names a look and seeds its drawing, whatever the size of its maps."""
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
        from chord_usd.library.looks.look_drawing import write_look

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
    brought: tuple[Look, ...] = ()

    def choices(self, part: Part, room: Room, count: int) -> list[Look]:
        """As scene.looks.LookSource."""
        brought = [
            look
            for look in self.brought
            if look.surface in (part, "both") and room.kind in look.kinds
        ][:count]
        even_px = self.px // 2 * 2
        wanted = looks_for(self.style, self.seed, part, room, count - len(brought))
        drawn = [drawn_look(family_named(w.family), w.settings, even_px) for w in wanted]
        return [*brought, *drawn]


def style_looks(
    style: HomeStyle, seed: int, px: int = BASE_PX, folder: Path | None = None
) -> StyleLooks:
    """The looks of a home. folder: of looks that go before; by default the materials folder.

    Raises AssetError for a damaged look.
    """
    return StyleLooks(style, seed, px, own_looks(folder))


def own_looks(folder: Path | None = None) -> tuple[Look, ...]:
    """Looks of a folder: packages with their maps, and those that name a family to be drawn."""
    looks = []
    for file in looks_in(folder):
        entry = read_entry(file)
        if "family" in entry and not (file.parent / f"{entry['name']}.usda").is_file():
            family = family_named(str(entry["family"]))
            settings = family.settings(dict(entry.get("parameters", {})), str(file))
            looks.append(drawn_look(family, settings, kinds=tuple(entry["kinds"])))
        else:
            looks.append(look_of(file.parent))
    return tuple(looks)
