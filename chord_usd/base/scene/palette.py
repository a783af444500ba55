"""The only category table, categories.tsv: a row a category, a column a fact (CONTRIBUTING.md).

Colours are the paper's (supplementary, tables "Scene layout items" and "Fine-grained items").
The paper speaks of 28 household categories and lists 26: `chair` and `bathtub` are ours, in the
two colours farthest from all others. House level and table level share colours (0000FF is window
and lying book), so every look-up by colour names its level.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import Literal, cast

from chord_usd.base.errors import SceneError
from chord_usd.base.scene.category_rows import category_rows
from chord_usd.base.scene.types import LEARNED_KINDS, ROOM_KINDS, RoomKind

_LEAST_KG = 0.01

ITEM_OPACITY = 0.3
"""Opacity of an item over the plan raster (paper, supplementary)."""

FRONT_MARK_OPACITY = 0.3
"""Opacity of the mark that shows an item's front: black over the painted item.

Black keeps all (category, mark) colours at least four grey levels apart on every room shade.
"""

FRONT_MARK_LENGTH = 0.6
"""Share of the item's length that the front mark spans, centred."""

FRONT_MARK_WIDTH = 0.3
"""Share of the item's width (depth) that the front mark takes, measured from the front edge."""

Rgb = tuple[int, int, int]


class Level(Enum):
    """Which raster a category is painted in."""

    HOUSE = "house"
    TABLE = "table"
    DRESSING = "dressing"
    """Painted in none: chosen when furniture and tables are in place."""
    PLAN = "plan"


class Mount(Enum):
    """What carries an item."""

    FLOOR = "floor"
    WALL = "wall"
    UNDERFOOT = "underfoot"
    """Lies flat under other items, which may stand on it."""
    CEILING = "ceiling"
    WINDOW = "window"
    """Hangs in or before a window."""
    PIECE = "piece"
    """Lies on a piece of furniture: a cushion, a throw."""
    BOARD = "board"
    """Stands on a shelf, a sill, a worktop."""


THIN_M = 0.1
"""A side that is usually as short is a pixel or two wide, which does not show its length."""

UNDERSIZED_SHARE = 0.7
"""What is shorter or narrower than this share of the smallest usual piece is too small for one."""


Trait = Literal[
    "supports",  # tabletop items may lie on it
    "moved",  # people move it: a rigid body in physics; others stay where they are
    "seat",  # soft seat of a living room
    "easy_chair",  # soft seat for one person
    "table",  # chairs stand at it
    "low_table",  # people pass it to sit down
    "faced",  # sofas look at it
    "sat_at",  # people sit at its top
    "walled",  # its back stands at a wall
    "panel",  # flat, behind what leans on it
    "kitchen_unit",  # part of a run of a kitchen
    "worktop",  # kitchen unit below the worktop
    "floor_cabinet",  # worktop unit with doors or drawers only
    "storage",  # holds clothes, shoes, linen
    "sideboard",  # closed storage that things are shown on
    "basin",  # hands are washed in it
    "bathing",  # shower or bath
    "laundry",  # washes clothes
    "fixture",  # stays when people move out
    "hung",  # some designs hang on the wall that they are plumbed to
    "rises",  # its mesh may pass its height: a television, a tap
    "any_side",  # used from whichever side is free
    "reached_over",  # reached over its neighbours
    "on_rug",  # may stand on a rug
    "to_measure",  # cut to the length that it has to have
    "soft",
    "studio",  # stands in the living room of a home of one room
    "leans",  # against the wall behind the board that it stands on
]
"""What sets categories apart that rules speak of."""

Span = tuple[float, float]
Side = tuple[int, int]
_SIDES: dict[str, Side] = {"front": (0, -1), "back": (0, 1), "left": (-1, 0), "right": (1, 0)}


@dataclass(frozen=True)
class Category:
    """One row of the table. Sizes are metres, (smallest, largest) over usual pieces."""

    name: str
    label: str
    level: Level
    rgb: Rgb
    detector_class: int
    """Index within its level; rows keep their index for ever, checkpoints depend on it."""
    length_m: Span
    width_m: Span
    height_m: Span
    mount: Mount
    mount_height_m: float
    """Usual height of the underside above the floor (table level: above what carries it)."""
    rooms: tuple[RoomKind, ...]
    """Room kinds it usually stands in, the first one its home."""
    rank: int | None
    """Place in the lists that networks write: large and needed pieces first."""
    kg_per_m3: float
    """Mass over the box that a piece fills, air included; 0 at the level of plans."""
    used_from: tuple[Side, ...]
    """Sides in its frame of which one has to be free; (0, -1) is the front."""
    seat_reach_m: float
    """How far from a table people still sit at it; 0 for what is no seat."""
    overlaps: frozenset[str]
    """Categories that it overlaps by nature: of a chair, the tables it is pushed under."""
    traits: frozenset[Trait]
    ifc: str
    """Class of IFC4 and predefined type, `IfcFurniture.BED`; "" for furniture of no kind."""
    words: tuple[str, ...]
    """Everyday names in the languages of room_names, with "_" for blanks."""

    @property
    def supports(self) -> bool:
        """Whether tabletop items may stand on it."""
        return "supports" in self.traits

    def is_undersized(self, size_m: tuple[float, float, float]) -> bool:
        """Whether what was painted is too short or too narrow to be one of these."""
        least_m = self.length_m[0], self.width_m[0]
        pairs = zip(size_m, least_m, strict=False)
        return any(least > THIN_M and side < UNDERSIZED_SHARE * least for side, least in pairs)


def _rgb(code: str) -> Rgb:
    return int(code[0:2], 16), int(code[2:4], 16), int(code[4:6], 16)


def _span(cell: str) -> Span:
    low, _, high = cell.partition("..")
    return float(low or 0.0), float(high or 0.0)


def _category(row: dict[str, str], index: int) -> Category:
    rooms = ROOM_KINDS if row["rooms"] == "*" else row["rooms"].split()
    return Category(
        name=row["name"],
        label=row["label"],
        level=Level(row["level"]),
        rgb=_rgb(row["colour"]),
        detector_class=index,
        length_m=_span(row["length_m"]),
        width_m=_span(row["width_m"]),
        height_m=_span(row["height_m"]),
        mount=Mount(row["mount"] or "floor"),
        mount_height_m=float(row["mount_m"] or 0.0),
        rooms=tuple(cast("Iterable[RoomKind]", rooms)),
        rank=int(row["rank"]) if row["rank"] else None,
        kg_per_m3=float(row["kg_per_m3"] or 0.0),
        used_from=tuple(_SIDES[side] for side in row["used_from"].split()),
        seat_reach_m=float(row["seat_reach_m"] or 0.0),
        overlaps=frozenset(row["overlaps"].split()),
        traits=cast("frozenset[Trait]", frozenset(row["traits"].split())),
        ifc=row["ifc"],
        words=tuple(row["words"].split()),
    )


def _of_level(level: Level) -> tuple[Category, ...]:
    rows = [row for row in category_rows().values() if row["level"] == level.value]
    return tuple(_category(row, index) for index, row in enumerate(rows))


CATEGORIES: dict[str, Category] = {row.name: row for level in Level for row in _of_level(level)}
"""Every row by name; names are unique over all levels."""


def _learned(level: Level) -> tuple[Category, ...]:
    rows = (row for row in CATEGORIES.values() if row.level is level)
    return tuple(row for row in rows if row.rank is not None)


HOUSE_CATEGORIES, TABLE_CATEGORIES = _learned(Level.HOUSE), _learned(Level.TABLE)
"""What networks list, paint and detect; a row without a rank is for scenes and stages only."""
DRESSING_CATEGORIES, PLAN_CATEGORIES = _of_level(Level.DRESSING), _of_level(Level.PLAN)


@cache
def having(trait: Trait) -> frozenset[str]:
    """Names of the categories with this trait."""
    return frozenset(row.name for row in CATEGORIES.values() if trait in row.traits)


def ranked(level: Level) -> tuple[str, ...]:
    """Names of the categories of a level in the order of lists."""
    rows = [row for row in CATEGORIES.values() if row.level is level and row.rank is not None]
    return tuple(row.name for row in sorted(rows, key=lambda row: row.rank or 0))


BACKGROUND_RGB: Rgb = (255, 255, 255)
"""Outside the house, and rooms of unknown kind."""

ROOM_SHADES: dict[RoomKind, Rgb] = {
    "unknown": BACKGROUND_RGB,
    "living": (244, 244, 244),
    "dining": (235, 235, 235),
    "bedroom": (226, 226, 226),
    "kitchen": (217, 217, 217),
    "bathroom": (208, 208, 208),
    "balcony": (199, 199, 199),
    "corridor": (190, 190, 190),
    "study": (181, 181, 181),
    "store": (172, 172, 172),
}
"""Grey level of each room kind in a shaded plan raster (paper, open-plan section)."""

assert set(ROOM_SHADES) == set(LEARNED_KINDS)

ROOM_RGB: dict[RoomKind, Rgb] = {
    "living": (230, 120, 60), "dining": (240, 200, 60), "bedroom": (90, 130, 220),
    "kitchen": (200, 60, 60), "bathroom": (60, 190, 200), "balcony": (100, 180, 80),
    "corridor": (150, 150, 150), "study": (160, 90, 200), "store": (130, 100, 70),
    "washroom": (90, 150, 170), "wc": (120, 210, 190),
}  # fmt: skip
"""Kinds of room on sheets that people look at."""

SUPPORTS: tuple[str, ...] = tuple(row.name for row in HOUSE_CATEGORIES if row.supports)
"""Categories that carry tabletop items. Their order stays for ever: checkpoints depend on it."""

TOP_SHADES: dict[str, Rgb] = {name: (244 - 9 * index,) * 3 for index, name in enumerate(SUPPORTS)}
"""Grey level of each supporting category's top in the top view that tabletop layouts lie on."""


def category(name: str) -> Category:
    """The row of this name. Raises SceneError for a name that is not in the table."""
    try:
        return CATEGORIES[name]
    except KeyError:
        from difflib import get_close_matches

        near = get_close_matches(name, CATEGORIES, n=1)
        hint = f"use '{near[0]}'" if near else "see chord_usd/base/scene/categories.tsv"
        raise SceneError(
            f"unknown category '{name}'", expected="a category of the palette", try_=hint
        ) from None


def usual_mass_kg(name: str, size_m: tuple[float, float, float]) -> float:
    """Mass of a piece of this category, by itself. Raises KeyError for one not in the palette."""
    return max(CATEGORIES[name].kg_per_m3 * math.prod(size_m), _LEAST_KG)


def painted(base_rgb: Rgb, item_rgb: Rgb, opacity: float = ITEM_OPACITY) -> Rgb:
    """item_rgb laid over base_rgb at this opacity, rounded to 8 bits per channel."""
    red, green, blue = (
        round((1.0 - opacity) * base + opacity * top)
        for base, top in zip(base_rgb, item_rgb, strict=True)
    )
    return red, green, blue
