"""The mesh database: components with their category and size, and the paper's retrieval rule.

A database is a folder with index.json beside its component packages. The embedded one is a list of
designs; what a house needs of it is drawn on first use and kept in the user's cache.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.errors import AssetError, OutputError
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.locations import CACHE_VARIABLE, cache_folder
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.scene.category_rows import category_rows
from chord_usd.base.scene.palette import CATEGORIES, category
from chord_usd.base.scene.types import Asset
from chord_usd.library.design_tables import FOLDERS, SizeM, entries

if TYPE_CHECKING:
    from chord_usd.library.kit.model import Design

INDEX_NAME = "index.json"
INDEX_SCHEMA = 1

TEXTURE_PX = 1024
"""Side of the largest textures of a house unless asked otherwise."""

_GENERATOR = (
    *("catalogue.py", "design_tables.py", "component.py", "component_prims.py", "material.py"),
    *("prop.py", "contact_sheet.py"),
    *("kit", "surfaces", *FOLDERS, "cloth", "textures"),
)
"""Sources that the bytes of the assets depend on, beside the facts in `_CATEGORY_FACTS`."""

_CATEGORY_FACTS = ("name", "wikidata", "kg_per_m3")
"""Columns of categories.tsv that components state; a change of the others keeps drawn assets."""

_REBUILD = "<assets build>"

_LONGEST_M = 1000.0

OWN_FIRST_M = 0.25
"""The shipped furniture comes in so many sizes that hardly anything else would ever be nearest."""


TAGS = {
    "swivels": "chairs that belong at desks only",
    "no_screen": "television cabinets without the set, as they are below windows",
    "drawn": "curtains that cover the whole window",
    "open": "curtains drawn aside; wall cabinets without doors",
    "sheer": "curtains that one sees through",
    "glazed": "wall cabinets with panes",
    "coats": "hook rails with coats on them",
    "doormat": "mats for an entrance",
    "bed": "throws for beds",
    "seat": "throws for sofas and chairs",
    "bath": "bottles for bathrooms",
    "kitchen": "bottles for kitchens",
    "dishwasher": "electrical cabinets of composed kitchens",
    "corner_left": "base cabinets whose left end another run of units hides",
    "corner_right": "base cabinets whose right end another run of units hides",
    "beside_left": "base cabinets with a filler at their left end, beside another run of units",
    "beside_right": "base cabinets with a filler at their right end, beside another run of units",
}
"""What an asset can say beside its category, and what that means; `assets add` accepts these."""

_VARIETIES = ("dishwasher", "corner_left", "corner_right", "beside_left", "beside_right")
"""Tags of units that are for one variety of a composed kitchen only (compose.cut.Variety)."""

STRANGE_FORM_M = 0.3
"""A form of another style is taken where it misses the size by so much less."""


def _is_there(asset: Asset) -> None:
    """What need not be drawn."""


@dataclass(frozen=True, eq=False)
class AssetDatabase:
    """All meshes an item can be given."""

    assets: tuple[Asset, ...]
    """Ids are unique."""
    own_ids: frozenset[str] = frozenset()
    """Ids of the assets that the user brought, which go before the shipped ones."""
    prepare: Callable[[Asset], None] = _is_there
    """Called before an asset is handed out: draws it where it is not on disk yet."""
    style: str = ""
    """Name of the style whose forms go before others; "" for none."""
    _by_category: Mapping[str, tuple[Asset, ...]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        groups: dict[str, list[Asset]] = {}
        for asset in self.assets:
            groups.setdefault(asset.category, []).append(asset)
        object.__setattr__(self, "_by_category", {k: tuple(v) for k, v in groups.items()})

    def in_style(self, name: str) -> AssetDatabase:
        """The same meshes, with the forms of this style before others."""
        return replace(self, style=name)

    def of_category(self, name: str) -> tuple[Asset, ...]:
        """Assets of a category, perhaps none. Raises SceneError for a name not in the palette."""
        return self._by_category.get(category(name).name, ())

    def nearest(
        self,
        name: str,
        size_m: SizeM,
        most_height_m: float | None = None,
        *,
        at_desk: bool = True,
        variety: str | None = None,
        is_screenless: bool = False,
    ) -> Asset:
        """The asset an item of this category and size (length, width, height) is given.

        The paper's rule: same category, least squared difference of length and width. Ties go to
        the nearer height, then to the lower id, so that the answer never depends on order. An
        asset of the user's own is taken unless a shipped one is more than OWN_FIRST_M nearer.
        most_height_m: what stands before a window is no higher, where the category has that.
        at_desk: elsewhere no chair swivels. variety: of a unit of a composed kitchen, a tag of
        these. is_screenless: of cabinets with and without a television, one without.
        Raises AssetError where the category has no asset, SceneError for a name not in the palette.
        """
        candidates = self.of_category(name)
        if not candidates:
            raise AssetError(
                f"the mesh database holds nothing of the category '{name}'",
                expected="at least one asset of every category in use",
                try_="<asset_folders> with such an asset",
            )
        suiting = tuple(a for a in candidates if ("no_screen" in a.tags) == is_screenless)
        candidates = suiting or candidates
        if not at_desk:
            candidates = tuple(a for a in candidates if "swivels" not in a.tags) or candidates
        if most_height_m is not None:
            low = [asset for asset in candidates if asset.size_m[2] <= most_height_m]
            candidates = tuple(low) or candidates
        candidates = tuple(a for a in candidates if _is_of(a, variety or "")) or candidates
        best = min(candidates, key=lambda asset: self._key(asset, size_m))
        brought = [asset for asset in candidates if asset.id in self.own_ids]
        if brought:
            first = min(brought, key=lambda asset: self._key(asset, size_m))
            if _miss_m(first, size_m) <= _miss_m(best, size_m) + OWN_FIRST_M:
                best = first
        self.prepare(best)
        return best

    def ranked(self, name: str, size_m: SizeM, count: int) -> tuple[Asset, ...]:
        """The assets of a category in the order of their difference from a size, on disk.

        Unlike nearest, own assets go before others only where they are as near. Raises SceneError
        for a name not in the palette.
        """
        ranked = sorted(
            self.of_category(name),
            key=lambda asset: (*self._key(asset, size_m)[:2], asset.id not in self.own_ids),
        )[:count]
        for asset in ranked:
            self.prepare(asset)
        return tuple(ranked)

    def _key(self, asset: Asset, size_m: SizeM) -> tuple[float, float, str]:
        """What sorts assets by their difference from a size; a strange form counts as one, too."""
        footprint, height, name = _retrieval_key(asset, size_m)
        if self.style and asset.styles and self.style not in asset.styles:
            footprint = round((math.sqrt(footprint) + STRANGE_FORM_M) ** 2, 9)
        return footprint, height, name

    def named(self, asset_id: str) -> Asset:
        """The asset of this id, on disk. Raises KeyError."""
        asset = next((asset for asset in self.assets if asset.id == asset_id), None)
        if asset is None:
            raise KeyError(asset_id)
        self.prepare(asset)
        return asset


def _is_of(asset: Asset, variety: str) -> bool:
    """Whether it carries the tag of this variety, or none where the variety has no tag."""
    tag = variety.replace(" ", "_")
    return set(asset.tags) & set(_VARIETIES) == ({tag} & set(_VARIETIES))


def _miss_m(asset: Asset, size_m: SizeM) -> float:
    return math.hypot(asset.size_m[0] - size_m[0], asset.size_m[1] - size_m[1])


def _retrieval_key(asset: Asset, size_m: SizeM) -> tuple[float, float, str]:
    footprint = sum((asset.size_m[axis] - size_m[axis]) ** 2 for axis in (0, 1))
    # A nanometre is no difference, only rounding.
    return round(footprint, 9), round(abs(asset.size_m[2] - size_m[2]), 9), asset.id


def load_database(
    folders: Sequence[Path] = (), style: str = "", texture_px: int = TEXTURE_PX
) -> AssetDatabase:
    """The embedded database and, before it, those in folders. style: as AssetDatabase has it.
    texture_px: of floors and walls; maps of furniture, whose tiles are smaller, have half of it.

    An id that occurs twice counts where it is met first, so a folder can replace an embedded
    asset. Raises AssetError for a folder without a readable index.
    """
    assets: dict[str, Asset] = {}
    for folder in folders:
        for asset in read_index(folder):
            assets.setdefault(asset.id, asset)
    own_ids = frozenset(assets)
    for asset in embedded_assets(texture_px):
        assets.setdefault(asset.id, asset)
    prepare = partial(draw_embedded, texture_px=texture_px)
    return AssetDatabase(tuple(assets.values()), own_ids, prepare, style)


def read_index(folder: Path) -> tuple[Asset, ...]:
    """Assets of a database folder. Raises AssetError that names the entry at fault."""
    path = folder / INDEX_NAME
    try:
        entries = parse_json(path.read_bytes(), str(path), AssetError)["assets"]
        return tuple([_asset(entry, folder) for entry in entries])
    except FileNotFoundError:
        raise AssetError(
            "there is no mesh database here",
            where=str(folder),
            expected=f"a folder with {INDEX_NAME}",
            try_=_REBUILD,
        ) from None
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise AssetError(
            f"the index of the mesh database cannot be read ({error})",
            where=str(path),
            expected='{"schema": 1, "assets": [{"id", "category", "size_m", "path", …}]}',
            try_=_REBUILD,
        ) from None


def _asset(entry: Mapping[str, Any], folder: Path) -> Asset:
    """One entry as an asset; raises ValueError, KeyError or TypeError where it is damaged."""
    name = str(entry["id"])
    if entry["category"] not in CATEGORIES:
        raise ValueError(f"{name}: unknown category {entry['category']!r}")
    size = tuple(float(side) for side in entry["size_m"])
    if len(size) != 3 or not all(0.0 < side <= _LONGEST_M for side in size):
        raise ValueError(
            f"{name}: size_m is {entry['size_m']}, not three lengths up to {_LONGEST_M:g} m"
        )
    usd_path = folder / entry["path"]
    if not usd_path.is_file():
        raise ValueError(f"{name}: {entry['path']} is missing")
    if not usd_path.resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"{name}: {entry['path']} lies outside the folder")
    return Asset(
        id=name,
        category=entry["category"],
        size_m=(size[0], size[1], size[2]),
        usd_path=usd_path,
        licence=str(entry.get("licence", "")),
        author=str(entry.get("author", "")),
        styles=tuple(str(name) for name in entry.get("styles", ())),
        tags=tuple(str(tag) for tag in entry.get("tags", ())),
    )


def build_assets(
    folder: Path, progress: Progress | None = None, chosen: Iterable[Design] | None = None
) -> tuple[Asset, ...]:
    """Draw designs into folder, with its index; returns the assets.

    folder must exist and hold none of them yet. chosen: by default every design there is.
    """
    from chord_usd.base.scene.credits import AUTHOR, LICENCE
    from chord_usd.library.catalogue import designs
    from chord_usd.library.component import write_component

    assets = []
    catalogue = designs() if chosen is None else tuple(chosen)
    for done, design in enumerate(catalogue):
        if progress is not None:
            progress(done, len(catalogue))
        path = write_component(design, folder)
        asset = Asset(design.id, design.category, design.size_m, path, LICENCE, AUTHOR)
        entry = entries().get(design.id)
        tags = entry.tags if entry else ()
        assets.append(replace(asset, styles=design.styles, tags=tags))
    write_index(assets, folder)
    if progress is not None:
        progress(len(catalogue), len(catalogue))
    return tuple(assets)


def write_index(assets: Iterable[Asset], folder: Path) -> None:
    """Write index.json for assets that lie inside folder."""
    entries = [
        {
            "id": asset.id,
            "category": asset.category,
            "size_m": list(asset.size_m),
            "path": asset.usd_path.relative_to(folder).as_posix(),
            "licence": asset.licence,
            "author": asset.author,
            **({"styles": list(asset.styles)} if asset.styles else {}),
            **({"tags": list(asset.tags)} if asset.tags else {}),
        }
        for asset in assets
    ]
    text = json.dumps({"schema": INDEX_SCHEMA, "assets": entries}, indent=1)
    (folder / INDEX_NAME).write_text(text + "\n", encoding="utf-8")


def embedded_assets(texture_px: int = TEXTURE_PX) -> tuple[Asset, ...]:
    """The embedded database; nothing of it is drawn, nor need it be on disk.

    Each asset lies in the user's cache once something has asked for it (draw_embedded).
    """
    from chord_usd.base.scene.credits import AUTHOR, LICENCE

    folder = embedded_folder(texture_px)
    return tuple(
        Asset(
            id=entry.id,
            category=entry.category,
            size_m=entry.size_m,
            usd_path=folder / entry.id / f"{entry.id}.usda",
            licence=LICENCE,
            author=AUTHOR,
            styles=entry.styles,
            tags=entry.tags,
        )
        for entry in entries().values()
    )


def draw_embedded(asset: Asset, texture_px: int = TEXTURE_PX) -> None:
    """Draw an embedded asset into the cache, if it is one and has not been drawn yet.

    Raises OutputError when the cache cannot be written.
    """
    folder = embedded_folder(texture_px)
    if asset.usd_path.is_file() or folder not in asset.usd_path.parents:
        return
    try:
        _draw_into(folder, asset, texture_px // 2)
    except OSError as error:
        raise OutputError(
            f"the mesh database cannot be kept ({error.strerror or error})",
            where=str(folder),
            expected="a writable cache folder with 60 MB of space",
            try_=f"set {CACHE_VARIABLE} to another folder",
        ) from None


@lru_cache(maxsize=1)
def _generator_folder() -> str:
    return f"assets-{_generator_hash()}"


def embedded_folder(texture_px: int = TEXTURE_PX) -> Path:
    """Where this version of the embedded database is kept, with maps of a size."""
    size = "" if texture_px == TEXTURE_PX else f"-{texture_px}"
    return cache_folder() / f"{_generator_folder()}{size}"


def _draw_into(folder: Path, asset: Asset, map_px: int) -> None:
    """Draw beside the target and rename, so that nobody ever sees half a component."""
    from chord_usd.library.catalogue import design_of
    from chord_usd.library.component import write_component
    from chord_usd.library.material import MapShelf
    from chord_usd.library.surfaces.surface_maps import MAPS_FOLDER

    folder.mkdir(parents=True, exist_ok=True)
    with scratch_folder(folder) as hidden:
        write_component(design_of(asset.id), hidden, maps=MapShelf(folder / MAPS_FOLDER, map_px))
        try:
            (hidden / asset.id).rename(folder / asset.id)
        except OSError:
            # Another process was faster; what it made is the same.
            if not asset.usd_path.is_file():
                raise


def _generator_hash() -> str:
    """Twelve hexadecimal digits that change with any source that draws or writes the assets."""
    facts = [[row[fact] for fact in _CATEGORY_FACTS] for row in category_rows().values()]
    digest = hashlib.sha256(json.dumps(facts).encode())
    root = Path(__file__).parent
    for name in _GENERATOR:
        source = root / name
        for file in sorted(_sources(source)) if source.is_dir() else [source]:
            digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def _sources(folder: Path) -> list[Path]:
    """Code, tables and stored cloths."""
    return [file for file in folder.iterdir() if file.suffix in (".py", ".tsv", ".npz")]
