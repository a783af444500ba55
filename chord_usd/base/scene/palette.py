"""The only category table: name, level, colour, detector class, sizes, mounting.

Colours are the paper's (supplementary, tables "Scene layout items" and "Fine-grained items").
The paper speaks of 28 household categories and lists 26: `chair` and `bathtub` are ours, in the
two colours farthest from all others. House level and table level share colours (0000FF is window
and lying book), so every look-up by colour names its level.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from chord_usd.base.errors import SceneError
from chord_usd.base.scene.types import ROOM_KINDS, RoomKind

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

    PLAN = "plan"
    HOUSE = "house"
    TABLE = "table"
    DRESSING = "dressing"
    """Painted in none: chosen when furniture and tables are in place."""


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
"""A side that is usually as short is a pixel or two wide, which does not tell its length."""

UNDERSIZED_SHARE = 0.7
"""What is shorter or narrower than this share of the smallest usual piece is too small for one."""


@dataclass(frozen=True)
class Category:
    """One row of the table. Sizes are metres, (smallest, largest) over usual pieces."""

    name: str
    label: str
    level: Level
    rgb: Rgb
    detector_class: int
    """Index within its level; rows keep their index for ever, checkpoints depend on it."""
    length_m: tuple[float, float]
    width_m: tuple[float, float]
    height_m: tuple[float, float]
    mount: Mount = Mount.FLOOR
    mount_height_m: float = 0.0
    """Usual height of the underside above the floor (table level: above what carries it)."""
    rooms: tuple[RoomKind, ...] = ()
    """Room kinds it usually stands in, the first one its home."""
    supports: bool = False
    """Tabletop items may stand on it."""

    def is_undersized(self, size_m: tuple[float, float, float]) -> bool:
        """Whether what was painted is too short or too narrow to be one of these."""
        least_m = self.length_m[0], self.width_m[0]
        pairs = zip(size_m, least_m, strict=False)
        return any(least > THIN_M and side < UNDERSIZED_SHARE * least for side, least in pairs)


def _rgb(code: str) -> Rgb:
    return int(code[0:2], 16), int(code[2:4], 16), int(code[4:6], 16)


_Span = tuple[float, float]
_WALL = {"mount": Mount.WALL}
_BED: tuple[RoomKind, ...] = ("bedroom",)
_STORAGE: tuple[RoomKind, ...] = ("bedroom", "study", "store", "corridor", "living")
_LOUNGE: tuple[RoomKind, ...] = ("living",)
_EAT: tuple[RoomKind, ...] = ("dining", "living", "kitchen")
_COOK: tuple[RoomKind, ...] = ("kitchen",)
_BATH: tuple[RoomKind, ...] = ("bathroom",)
_LAUNDRY: tuple[RoomKind, ...] = ("balcony", "bathroom", "kitchen")

# name, label, colour, length, width (depth), height, rooms, further fields
_HOUSE_ROWS: tuple[tuple[str, str, str, _Span, _Span, _Span, tuple[RoomKind, ...], dict], ...] = (
    ("bed", "Bed", "FF0000", (0.9, 2.0), (1.9, 2.2), (0.85, 1.2), _BED, {}),
    ("cabinet", "Cabinet", "FFFF00", (0.6, 2.8), (0.38, 0.65), (0.75, 2.4), _STORAGE, {}),
    ("bed_background", "Bed Background", "FF3333", (1.2, 3.2), (0.05, 0.12), (0.6, 1.6), _BED,
     {**_WALL, "mount_height_m": 1.1}),
    ("bedside_table", "Bedside Table", "F08080", (0.35, 0.6), (0.35, 0.5), (0.4, 0.65), _BED,
     {"supports": True}),
    ("table", "Table", "A52A2A", (0.8, 1.8), (0.45, 0.8), (0.72, 0.78),
     ("bedroom", "study", "living"), {"supports": True}),
    ("leisure_sofa", "Leisure Sofa", "666600", (0.6, 1.0), (0.6, 1.1), (0.7, 1.0),
     ("living", "balcony", "bedroom", "study"), {}),
    ("sofa", "Sofa", "FF9933", (1.4, 3.2), (0.8, 1.1), (0.7, 0.95), _LOUNGE, {}),
    ("tv_cabinet", "TV Cabinet", "FFCC99", (1.0, 2.6), (0.3, 0.5), (0.35, 0.6),
     ("living", "bedroom"), {"supports": True}),
    ("sofa_background", "Sofa Background", "99004C", (1.2, 3.6), (0.05, 0.12), (0.5, 1.4), _LOUNGE,
     {**_WALL, "mount_height_m": 1.1}),
    ("coffee_table", "Coffee Table", "CCFF99", (0.6, 1.4), (0.5, 0.9), (0.35, 0.5), _LOUNGE,
     {"supports": True}),
    ("dining_cabinet", "Dining Cabinet", "FF9999", (0.8, 2.0), (0.35, 0.5), (0.8, 2.2), _EAT, {}),
    ("shoe_cabinet", "Shoe Cabinet", "006633", (0.6, 1.6), (0.25, 0.45), (0.8, 2.2),
     ("corridor", "living", "dining"), {}),
    ("single_sofa", "Single Sofa", "CC6600", (0.75, 1.05), (0.75, 1.0), (0.7, 1.0), _LOUNGE, {}),
    ("dining_table", "Dining Table", "FF6666", (0.8, 2.2), (0.75, 1.1), (0.72, 0.78), _EAT,
     {"supports": True}),
    ("side_coffee_table", "Side Coffee Table", "99FFCC", (0.35, 0.65), (0.35, 0.65), (0.4, 0.6),
     ("living", "bedroom", "study", "balcony"), {"supports": True}),
    ("single_door_floor_cabinet", "Single Door Floor Cabinet", "9999FF", (0.14, 0.6), (0.5, 0.65),
     (0.8, 0.95), _COOK, {"supports": True}),
    ("double_door_floor_cabinet", "Double Door Floor Cabinet", "6666FF", (0.6, 1.2), (0.5, 0.65),
     (0.8, 0.95), _COOK, {"supports": True}),
    ("cooker_cabinet", "Cooker Cabinet", "000099", (0.6, 0.95), (0.5, 0.65), (0.8, 0.95), _COOK,
     {}),
    ("sink_cabinet", "Sink Cabinet", "0000CC", (0.6, 1.1), (0.5, 0.65), (0.8, 0.95), _COOK, {}),
    ("electrical_floor_cabinet", "Electrical Floor Cabinet", "3333FF", (0.45, 0.75), (0.5, 0.65),
     (0.8, 2.2), _COOK, {}),
    ("refrigerator", "Refrigerator", "006666", (0.55, 0.95), (0.55, 0.78), (1.5, 1.95),
     ("kitchen", "dining"), {}),
    ("shower", "Shower", "33FF99", (0.75, 1.4), (0.75, 1.2), (1.9, 2.2), _BATH, {}),
    ("toilet", "Toilet", "660033", (0.36, 0.46), (0.5, 0.78), (0.4, 0.85), _BATH, {}),
    ("washbasin", "Washbasin", "CC0066", (0.35, 1.3), (0.25, 0.6), (0.8, 0.95), _BATH, {}),
    ("washing_machine", "Washing Machine", "FFCCE5", (0.55, 0.68), (0.5, 0.68), (0.82, 0.95),
     _LAUNDRY, {}),
    ("washing_set", "Washing Set", "FF66B2", (0.9, 1.7), (0.5, 0.68), (0.85, 2.2), _LAUNDRY, {}),
    ("chair", "Chair", "CC00FF", (0.4, 0.58), (0.4, 0.6), (0.75, 1.05),
     ("dining", "study", "bedroom", "living", "kitchen"), {}),
    ("bathtub", "Bathtub", "66FF00", (1.3, 1.8), (0.68, 0.9), (0.48, 0.62), _BATH, {}),
)  # fmt: skip

# name, label, colour, length, width, height, further fields
_TABLE_ROWS: tuple[tuple[str, str, str, _Span, _Span, _Span, dict], ...] = (
    ("lying_book", "Lying Book", "0000FF", (0.12, 0.24), (0.17, 0.32), (0.01, 0.06), {}),
    ("standing_book", "Standing Book", "FFFFAA", (0.1, 0.45), (0.14, 0.26), (0.18, 0.32), {}),
    ("magazine", "Magazine", "7FFFAA", (0.18, 0.25), (0.24, 0.32), (0.004, 0.02),
     {"mount": Mount.UNDERFOOT}),
    ("all_in_one_computer", "All-in-one Computer", "00FFAA", (0.45, 0.75), (0.2, 0.5), (0.38, 0.6),
     {}),
    ("laptop", "Laptop", "FF7FAA", (0.28, 0.4), (0.2, 0.35), (0.18, 0.28), {}),
    ("big_mouse_pad", "Big Mouse Pad", "7F7FAA", (0.6, 1.0), (0.28, 0.45), (0.003, 0.006),
     {"mount": Mount.UNDERFOOT}),
    ("table_lamp", "Table Lamp", "007FAA", (0.15, 0.4), (0.15, 0.4), (0.3, 0.65), {}),
    ("small_ornament", "Small Ornament", "FF00AA", (0.05, 0.2), (0.05, 0.2), (0.05, 0.3), {}),
    ("pen_holder", "Pen Holder", "7F00AA", (0.07, 0.14), (0.07, 0.14), (0.1, 0.22), {}),
    ("big_plant", "Big Plant", "0000AA", (0.25, 0.5), (0.25, 0.5), (0.35, 0.8), {}),
    ("small_plant", "Small Plant", "FFFF55", (0.1, 0.25), (0.1, 0.25), (0.1, 0.35), {}),
    ("coffee_cup", "Coffee Cup", "7FFF55", (0.08, 0.17), (0.08, 0.15), (0.06, 0.12), {}),
    ("electronic", "Electronic", "FF0000", (0.07, 0.3), (0.07, 0.25), (0.01, 0.25), {}),
    ("photo_frame", "Photo Frame", "FF7F55", (0.12, 0.3), (0.03, 0.14), (0.14, 0.35), {}),
    ("food", "Food", "7F7F55", (0.12, 0.35), (0.12, 0.35), (0.04, 0.18), {}),
    ("dinner_set", "Dinner Set", "FFFF00", (0.3, 0.5), (0.25, 0.4), (0.02, 0.16), {}),
    ("drinks", "Drinks", "7F7F00", (0.06, 0.3), (0.06, 0.3), (0.12, 0.35), {}),
)  # fmt: skip

_LIVED: tuple[RoomKind, ...] = ("living", "bedroom", "study", "dining")
_SERVED: tuple[RoomKind, ...] = ("kitchen", "bathroom")
_CEILING = {"mount": Mount.CEILING}
_WINDOW = {"mount": Mount.WINDOW}
_PIECE = {"mount": Mount.PIECE}
_BOARD = {"mount": Mount.BOARD}
_UNDERFOOT = {"mount": Mount.UNDERFOOT}


def _hung(height_m: float) -> dict:
    """On a wall, its underside at this height."""
    return {"mount": Mount.WALL, "mount_height_m": height_m}


# name, label, colour, length, width (depth), height, rooms, further fields
_Row = tuple[str, str, str, _Span, _Span, _Span, tuple[RoomKind, ...], dict]
_DRESSING_ROWS: tuple[_Row, ...] = (
    ("curtain", "Curtain", "B5651D", (0.2, 3.0), (0.06, 0.16), (0.6, 2.6), _LIVED, _WINDOW),
    ("curtain_rail", "Curtain Rail", "7A4A1E", (0.6, 5.0), (0.06, 0.14), (0.02, 0.08), _LIVED,
     _WINDOW),
    ("blind", "Blind", "C49A6C", (0.4, 3.0), (0.03, 0.1), (0.1, 2.4), _SERVED, _WINDOW),
    ("rug", "Rug", "8E3B46", (0.6, 4.0), (0.4, 3.0), (0.004, 0.025), _LIVED, _UNDERFOOT),
    ("mat", "Mat", "A9746E", (0.4, 1.0), (0.3, 0.7), (0.004, 0.025), ("bathroom", "corridor"),
     _UNDERFOOT),
    ("ceiling_lamp", "Ceiling Lamp", "FFE08A", (0.2, 1.2), (0.08, 0.8), (0.04, 0.25), ROOM_KINDS,
     _CEILING),
    ("pendant_lamp", "Pendant Lamp", "FFD24D", (0.15, 1.3), (0.15, 0.9), (0.4, 1.4), _EAT,
     _CEILING),
    ("floor_lamp", "Floor Lamp", "E8B923", (0.25, 0.6), (0.25, 0.6), (1.2, 1.9), _LIVED, {}),
    ("wall_lamp", "Wall Lamp", "F2C14E", (0.08, 0.6), (0.06, 0.3), (0.08, 0.45),
     ("bedroom", "bathroom", "corridor"), _hung(1.5)),
    ("picture", "Picture", "3E7CB1", (0.2, 1.6), (0.015, 0.05), (0.2, 1.3), _LIVED, _hung(1.2)),
    ("mirror", "Mirror", "A7C6DA", (0.3, 1.6), (0.015, 0.14), (0.4, 1.9),
     ("bathroom", "corridor", "bedroom"), _hung(1.1)),
    ("clock", "Clock", "5B6C8F", (0.2, 0.5), (0.02, 0.08), (0.2, 0.5), ("kitchen", "living"),
     _hung(1.8)),
    ("wall_shelf", "Wall Shelf", "9C6644", (0.4, 1.4), (0.12, 0.3), (0.02, 0.9), _LIVED,
     _hung(1.4)),
    ("hook_rail", "Hook Rail", "6B4F3A", (0.3, 1.0), (0.04, 0.3), (0.08, 0.9), ("corridor",),
     _hung(1.0)),
    ("radiator", "Radiator", "D9D9D9", (0.4, 1.8), (0.05, 0.14), (0.3, 0.9), _LIVED, _hung(0.12)),
    ("light_switch", "Light Switch", "BFC3C7", (0.07, 0.16), (0.008, 0.015), (0.07, 0.16),
     ROOM_KINDS, _hung(1.05)),
    ("socket", "Socket", "C9CDD1", (0.07, 0.24), (0.008, 0.015), (0.07, 0.1), ROOM_KINDS,
     _hung(0.3)),
    ("wall_cabinet", "Wall Cabinet", "7077A1", (0.3, 1.2), (0.28, 0.4), (0.35, 0.9), _COOK,
     _hung(1.4)),
    ("cooker_hood", "Cooker Hood", "4B5D67", (0.5, 0.9), (0.28, 0.52), (0.1, 1.1), _COOK,
     _hung(1.55)),
    ("splashback", "Splashback", "B8C0C8", (0.3, 4.0), (0.004, 0.012), (0.4, 0.7), _COOK,
     _hung(0.9)),
    ("utensil_rail", "Utensil Rail", "6D7278", (0.3, 0.9), (0.04, 0.12), (0.2, 0.45), _COOK,
     _hung(1.1)),
    ("towel_rail", "Towel Rail", "B0B7BF", (0.4, 0.8), (0.06, 0.16), (0.05, 1.6), _BATH,
     _hung(0.9)),
    ("paper_holder", "Paper Holder", "8D99A6", (0.12, 0.25), (0.08, 0.16), (0.08, 0.2), _BATH,
     _hung(0.65)),
    ("shower_screen", "Shower Screen", "CFE8EF", (0.6, 1.1), (0.006, 0.03), (1.3, 1.5), _BATH,
     _PIECE),
    ("floor_plant", "Floor Plant", "3A7D44", (0.25, 0.9), (0.25, 0.9), (0.5, 1.9),
     ("living", "dining", "study", "bedroom", "balcony"), {}),
    ("basket", "Basket", "B08D57", (0.25, 0.55), (0.25, 0.5), (0.2, 0.6),
     ("living", "bathroom", "bedroom"), {}),
    ("bin", "Bin", "6E6E6E", (0.18, 0.4), (0.18, 0.4), (0.22, 0.7),
     ("bathroom", "kitchen", "study"), {}),
    ("umbrella_stand", "Umbrella Stand", "4F4A45", (0.18, 0.35), (0.18, 0.35), (0.45, 0.9),
     ("corridor",), {}),
    ("cushion", "Cushion", "D17B88", (0.3, 0.65), (0.1, 0.35), (0.25, 0.55), _LOUNGE, _PIECE),
    ("throw", "Throw", "C08497", (0.4, 2.2), (0.4, 2.2), (0.02, 0.95), ("living", "bedroom"),
     _PIECE),
    ("toilet_brush", "Toilet Brush", "9AA0A6", (0.08, 0.14), (0.08, 0.14), (0.3, 0.5), _BATH, {}),
    ("book_row", "Book Row", "8C5E58", (0.1, 0.6), (0.12, 0.26), (0.16, 0.34), _LIVED, _BOARD),
    ("vase", "Vase", "7FA99B", (0.08, 0.3), (0.08, 0.3), (0.12, 0.7), _LIVED, _BOARD),
    ("sculpture", "Sculpture", "A39BA8", (0.06, 0.3), (0.05, 0.2), (0.08, 0.4), _LIVED, _BOARD),
    ("candle", "Candle", "EFE2BA", (0.05, 0.2), (0.05, 0.2), (0.05, 0.3), _LIVED, _BOARD),
    ("storage_box", "Storage Box", "C2A878", (0.15, 0.4), (0.15, 0.35), (0.1, 0.3), _LIVED,
     _BOARD),
    ("trailing_plant", "Trailing Plant", "5FAD56", (0.12, 0.4), (0.12, 0.4), (0.12, 0.6), _LIVED,
     _BOARD),
    ("kettle", "Kettle", "59636E", (0.15, 0.26), (0.13, 0.22), (0.18, 0.28), _COOK, _BOARD),
    ("toaster", "Toaster", "7D8590", (0.22, 0.36), (0.14, 0.22), (0.16, 0.24), _COOK, _BOARD),
    ("coffee_machine", "Coffee Machine", "3C4146", (0.18, 0.34), (0.24, 0.42), (0.26, 0.42),
     _COOK, _BOARD),
    ("pot", "Pot", "6A7F8C", (0.16, 0.5), (0.16, 0.34), (0.08, 0.26), _COOK, _BOARD),
    ("cutting_board", "Cutting Board", "C68B59", (0.2, 0.5), (0.015, 0.12), (0.25, 0.5), _COOK,
     _BOARD),
    ("knife_block", "Knife Block", "5C4033", (0.08, 0.2), (0.1, 0.22), (0.2, 0.36), _COOK,
     _BOARD),
    ("utensil_jar", "Utensil Jar", "A9B4C2", (0.08, 0.16), (0.08, 0.16), (0.24, 0.4), _COOK,
     _BOARD),
    ("jar", "Jar", "D8C3A5", (0.07, 0.5), (0.07, 0.18), (0.1, 0.3), _COOK, _BOARD),
    ("bottle", "Bottle", "4E6E58", (0.05, 0.3), (0.05, 0.14), (0.14, 0.36), _SERVED, _BOARD),
    ("bowl", "Bowl", "D9BF77", (0.14, 0.4), (0.14, 0.4), (0.05, 0.16), ("kitchen", "living"),
     _BOARD),
    ("plate_stack", "Plate Stack", "E4E4E4", (0.16, 0.3), (0.16, 0.3), (0.03, 0.16), _COOK,
     _BOARD),
    ("soap_dispenser", "Soap Dispenser", "9FB7B9", (0.05, 0.12), (0.05, 0.12), (0.12, 0.22),
     _SERVED, _BOARD),
    ("toothbrush_cup", "Toothbrush Cup", "7EBDC2", (0.06, 0.12), (0.06, 0.12), (0.12, 0.24),
     _BATH, _BOARD),
    ("towel_stack", "Towel Stack", "CFC6B8", (0.2, 0.5), (0.15, 0.4), (0.06, 0.4), _BATH, _BOARD),
)  # fmt: skip

_PLAN_ROWS: tuple[tuple[str, str, str], ...] = (
    ("wall", "Wall", "000000"),
    ("door", "Door", "139C5A"),
    ("window", "Window", "0000FF"),
)


def _house_categories() -> Iterable[Category]:
    for index, (name, label, code, length, width, height, rooms, more) in enumerate(_HOUSE_ROWS):
        yield Category(
            name, label, Level.HOUSE, _rgb(code), index, length, width, height, rooms=rooms, **more
        )


def _table_categories() -> Iterable[Category]:
    for index, (name, label, code, length, width, height, more) in enumerate(_TABLE_ROWS):
        yield Category(name, label, Level.TABLE, _rgb(code), index, length, width, height, **more)


def _dressing_categories() -> Iterable[Category]:
    for index, (name, label, code, length, width, height, rooms, more) in enumerate(_DRESSING_ROWS):
        rgb = _rgb(code)
        yield Category(
            name, label, Level.DRESSING, rgb, index, length, width, height, rooms=rooms, **more
        )


def _plan_categories() -> Iterable[Category]:
    for index, (name, label, code) in enumerate(_PLAN_ROWS):
        span = (0.0, 0.0)
        yield Category(name, label, Level.PLAN, _rgb(code), index, span, span, span)


HOUSE_CATEGORIES: tuple[Category, ...] = tuple(_house_categories())
TABLE_CATEGORIES: tuple[Category, ...] = tuple(_table_categories())
DRESSING_CATEGORIES: tuple[Category, ...] = tuple(_dressing_categories())
PLAN_CATEGORIES: tuple[Category, ...] = tuple(_plan_categories())

CATEGORIES: dict[str, Category] = {
    row.name: row
    for row in (
        *HOUSE_CATEGORIES,
        *TABLE_CATEGORIES,
        *DRESSING_CATEGORIES,
        *PLAN_CATEGORIES,
    )
}
"""Every row by name; names are unique over all levels."""

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

assert set(ROOM_SHADES) == set(ROOM_KINDS)

ROOM_RGB: dict[RoomKind, Rgb] = {
    "living": (230, 120, 60), "dining": (240, 200, 60), "bedroom": (90, 130, 220),
    "kitchen": (200, 60, 60), "bathroom": (60, 190, 200), "balcony": (100, 180, 80),
    "corridor": (150, 150, 150), "study": (160, 90, 200), "store": (130, 100, 70),
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
        hint = f"use '{near[0]}'" if near else "see chord_usd/base/scene/palette.py for the table"
        raise SceneError(
            f"unknown category '{name}'", expected="a category of the palette", try_=hint
        ) from None


def painted(base_rgb: Rgb, item_rgb: Rgb, opacity: float = ITEM_OPACITY) -> Rgb:
    """item_rgb laid over base_rgb at this opacity, rounded to 8 bits per channel."""
    red, green, blue = (
        round((1.0 - opacity) * base + opacity * top)
        for base, top in zip(base_rgb, item_rgb, strict=True)
    )
    return red, green, blue
