"""What hangs on the walls of a kitchen: cabinets, hoods, splashbacks, rails."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from chord_usd.assets.dressing.kitchen_finishes import FINISHES, KITCHENS, kitchen_slots
from chord_usd.assets.dressing.utensils import whisk_head
from chord_usd.assets.furniture.joinery import FRONT_M, Cell, cells
from chord_usd.assets.furniture.kitchen_fronts import (
    FORM_STYLES,
    FrontForm,
    kitchen_fronts,
    pull_bar,
    reach_m,
)
from chord_usd.assets.model import Design, Draw, Part
from chord_usd.assets.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    extruded,
    joined,
    lathe,
    loft,
    ring,
    tube,
)

_BOARD_M = 0.018
_WIDEST_DOOR_M = 0.5


def wall_cabinet(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """A closed cabinet: one door, or two where it is wide."""
    length, depth, height = size_m
    y = -depth / 2 + reach_m(form) + FRONT_M
    case = block((length, depth / 2 - y, height), 0.002).moved(y=(depth / 2 + y) / 2)
    face = _face(length, height)
    return (Part("Body", case, "body"), *kitchen_fronts(face, y, form, low=True))


def _face(length: float, height: float) -> list[Cell]:
    columns = 1 if length <= _WIDEST_DOOR_M else 2
    return list(cells(length, height - 0.004, columns, z_m=0.002))


def _carcass(length: float, depth: float, height: float, y: float) -> Solid:
    """Sides, top, bottom, back: the front open, at y."""
    deep = depth / 2 - y
    middle = y + deep / 2
    side = block((_BOARD_M, deep, height), 0.0015)
    plate = block((length - 2 * _BOARD_M + 0.002, deep - 0.001, _BOARD_M), 0.0015)
    back = box((length - 2 * _BOARD_M + 0.004, 0.008, height - 2 * _BOARD_M + 0.003))
    pieces = [
        side.moved((length - _BOARD_M) / 2, middle),
        side.moved(-(length - _BOARD_M) / 2, middle),
        plate.moved(y=middle, z=0.0005),
        plate.moved(y=middle, z=height - _BOARD_M - 0.0005),
        back.moved(y=depth / 2 - 0.006, z=_BOARD_M - 0.0015),
    ]
    return joined(pieces)


def open_cabinet(size_m: Size) -> tuple[Part, ...]:
    """A cabinet without doors and one board, with bowls and glasses in it."""
    length, depth, height = size_m
    case = _carcass(length, depth, height, -depth / 2)
    board = block((length - 2 * _BOARD_M + 0.003, depth - 0.02, _BOARD_M), 0.0015)
    ware, glasses = _tableware(length - 0.1, height)
    return (
        Part("Case", case + board.moved(y=0.004, z=height / 2), "front"),
        Part("Ware", ware, "ware", collider=None),
        Part("Glasses", glasses, "glass", collider=None),
    )


def _tableware(length: float, height: float, y: float = 0.0) -> tuple[Solid, Solid]:
    """Bowls and plates below, glasses above, as wide as there is room."""
    bowl = lathe(
        [(0.03, 0), (0.065, 0.04), (0.068, 0.055), (0.064, 0.055), (0.03, 0.008), (0, 0.008)], 20
    )
    plates = lathe(
        [(0.05, 0), (0.1, 0.014), (0.1, 0.06), (0.094, 0.06), (0.05, 0.05), (0, 0.05)], 28
    )
    cup = lathe([(0.026, 0), (0.034, 0.11), (0.032, 0.11), (0.024, 0.006), (0, 0.006)], 14)
    low, high = _BOARD_M, height / 2 + _BOARD_M
    ware = [plates.moved(-length / 2 + 0.1, y, low)]
    if length > 0.42:
        x = length / 2 - 0.07
        ware += [bowl.moved(x, y, low + 0.022 * n) for n in range(3)]
    count = max(2, int(length / 0.09))
    pitch = length / count
    cups = [
        cup.moved(-length / 2 + pitch * (n + 0.5), y + 0.03 * (n % 2), high) for n in range(count)
    ]
    return joined(ware), joined(cups)


def glazed_cabinet(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """Doors of glass in frames, and what stands behind them."""
    length, depth, height = size_m
    y = -depth / 2 + reach_m(form) + FRONT_M
    board = box((length - 2 * _BOARD_M + 0.003, depth / 2 - y - 0.03, _BOARD_M))
    case = _carcass(length, depth, height, y) + board.moved(y=(y + depth / 2) / 2, z=height / 2)
    wide = 0.05 if form == "shaker" else 0.03
    frames, panes, grips = [], [], []
    for cell in _face(length, height):
        frames.append(_glazed_frame(cell, y, wide, crossed=form == "shaker"))
        pane = box((cell.length_m - 2 * wide + 0.01, 0.004, cell.height_m - 2 * wide + 0.01))
        panes.append(pane.moved(cell.x_m, y - FRONT_M / 2, cell.z_m + wide - 0.005))
    ware, glasses = _tableware(length - 0.1, height, (y + depth / 2) / 2)
    parts = [
        Part("Case", case, "body"),
        Part("Doors", joined(frames), "front"),
        Part("Panes", joined(panes), "glass", collider=None),
        Part("Ware", ware, "ware", collider=None),
        Part("Glasses", glasses, "glass", collider=None),
    ]
    if form in ("bar", "shaker"):
        for cell in _face(length, height):
            inner = 1.0 if cell.column % 2 == 0 else -1.0
            made = pull_bar(0.16).turned("y", 90)
            grips.append(
                made.moved(
                    cell.x_m + inner * (cell.length_m / 2 - wide / 2), y - FRONT_M, cell.z_m + 0.15
                )
            )
        parts.append(Part("Door_Handles", joined(grips), "handle", collider=None))
    return tuple(parts)


def _glazed_frame(cell: Cell, y: float, wide: float, *, crossed: bool) -> Solid:
    outline = ring(cell.length_m, cell.height_m, 0.0, 0.0, 0)[:, :2]
    hole = ring(cell.length_m - 2 * wide, cell.height_m - 2 * wide, 0.0, 0.0, 0)[:, :2]
    frame = extruded(outline, FRONT_M, [hole]).turned("x", 90)
    frame = frame.moved(cell.x_m, y, cell.z_m + cell.height_m / 2)
    if not crossed:
        return frame
    upright = box((0.016, 0.012, cell.height_m - 2 * wide + 0.004))
    lying = box((cell.length_m - 2 * wide + 0.004, 0.0118, 0.016))
    return joined([
        frame,
        upright.moved(cell.x_m, y - FRONT_M / 2 - 0.001, cell.z_m + wide - 0.002),
        lying.moved(cell.x_m, y - FRONT_M / 2 - 0.001, cell.z_m + cell.height_m * 0.62),
    ])  # fmt: skip


def _shifted_ring(
    long: float, deep: float, back: float, z: float, radius: float = 0.004
) -> np.ndarray:
    """A rectangle whose back side lies at y = back."""
    return ring(long, deep, radius, z, 1) + np.array([0.0, back - deep / 2, 0.0])


def chimney_hood(size_m: Size) -> tuple[Part, ...]:
    """A flat steel canopy under a chimney."""
    length, depth, height = size_m
    back = depth / 2
    levels = ((length, depth, 0.0), (length, depth, 0.05), (0.3, 0.26, 0.2), (0.296, 0.256, 0.21))
    canopy = loft([_shifted_ring(long, far, back, z) for long, far, z in levels])
    chimney = block((0.27, 0.23, height - 0.2), 0.002).moved(y=back - 0.116, z=0.2)
    sleeve = block((0.278, 0.238, height * 0.4), 0.002).moved(y=back - 0.121, z=0.198)
    return (
        Part("Canopy", canopy, "metal"),
        Part("Chimney", chimney + sleeve, "metal"),
        *_underside(length, depth, back, front=-depth / 2),
    )


def _underside(
    length: float, depth: float, back: float, front: float, z: float = 0.0
) -> tuple[Part, ...]:
    """Filters, lights and keys of a hood whose underside is at z."""
    filters = [
        block((length * 0.4, depth * 0.6, 0.006), 0.001).moved(
            s * length * 0.21, back - depth * 0.45, z - 0.003
        )
        for s in (-1, 1)
    ]
    lights = [
        cylinder(0.028, 0.004, 0.0, 16).moved(s * length * 0.3, front + 0.055, z - 0.002)
        for s in (-1, 1)
    ]
    keys = [
        cylinder(0.006, 0.004, 0.001, 10).turned("x", 90).moved(0.025 * n, front + 0.001, z + 0.025)
        for n in range(-2, 3)
    ]
    return (
        Part("Filters", joined(filters), "filter", collider=None),
        Part("Lights", joined(lights), "glow", collider=None),
        Part("Keys", joined(keys), "dark_glass", collider=None),
    )


def slanted_hood(size_m: Size) -> tuple[Part, ...]:
    """A leaning pane of black glass before a slim chimney."""
    length, depth, height = size_m
    back, front = depth / 2, -depth / 2
    rise = 0.42
    side = [[front + 0.02, 0.0], [back, 0.0], [back, rise], [back - 0.18, rise]]
    body = extruded(side, length * 0.8).turned("x", 90).turned("z", 90).moved(x=-length * 0.4)
    lean = np.degrees(np.arctan2(rise, depth - 0.2))
    long = float(np.hypot(rise, depth - 0.2))
    pane = block((length, long + 0.02, 0.008), 0.002).moved(y=long / 2).turned("x", lean)
    pane = pane.moved(y=front + 0.006, z=0.004)
    chimney = block((0.26, 0.2, height - rise + 0.002), 0.002).moved(y=back - 0.1, z=rise - 0.002)
    keys = (
        box((0.12, 0.012, 0.001))
        .moved(y=0.06, z=0.008)
        .turned("x", lean)
        .moved(y=front + 0.006, z=0.004)
    )
    return (
        Part("Body", body, "metal"),
        Part("Pane", pane, "dark_glass"),
        Part("Chimney", chimney, "metal"),
        Part("Keys", keys, "glow", collider=None),
    )


def built_in_hood(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """A wall cabinet whose underside draws: a slim steel lip below its doors."""
    length, depth, height = size_m
    lip = 0.04
    y = -depth / 2 + reach_m(form) + FRONT_M
    case = block((length, depth / 2 - y, height - lip), 0.002).moved(y=(depth / 2 + y) / 2, z=lip)
    columns = 1 if length <= _WIDEST_DOOR_M else 2
    face = list(cells(length, height - lip - 0.004, columns, z_m=lip + 0.002))
    plate = block((length, depth - 0.004, lip - 0.002), 0.003).moved(y=0.002)
    return (
        Part("Body", case, "body"),
        *kitchen_fronts(face, y, form, low=True),
        Part("Lip", plate, "metal"),
        *_underside(length, depth, depth / 2, front=-depth / 2 + 0.004),
    )


def mantel_hood(size_m: Size) -> tuple[Part, ...]:
    """A plastered mantel on a moulded shelf, as in a country kitchen."""
    length, depth, height = size_m
    back = depth / 2
    levels = [
        (length - 0.05, depth - 0.03, 0.1), (length - 0.07, depth - 0.045, 0.12),
        (length * 0.66, depth * 0.72, height * 0.5), (length * 0.52, depth * 0.62, height * 0.8),
        (length * 0.5, depth * 0.6, height),
    ]  # fmt: skip
    shelf = [
        (length - 0.06, depth - 0.035, 0.0), (length - 0.05, depth - 0.03, 0.02),
        (length - 0.04, depth - 0.025, 0.055), (length - 0.012, depth - 0.012, 0.07),
        (length, depth, 0.076), (length, depth, 0.098), (length - 0.006, depth - 0.004, 0.102),
    ]  # fmt: skip
    hood = loft([_shifted_ring(a, b, back - 0.001, z) for a, b, z in levels])
    return (
        Part("Mantel", hood, "plaster"),
        Part("Shelf", loft([_shifted_ring(a, b, back, z) for a, b, z in shelf]), "front"),
        *_underside(length - 0.1, depth - 0.06, back, front=-depth / 2 + 0.02)[:2],
    )


_GROUT_M = 0.0028


def tiles(
    size_m: Size, *, long: float, tall: float, shift: float = 0.5, lean_deg: float = 0.0
) -> tuple[Part, ...]:
    """Tiles with slanted edges on a bed of grout; rows shifted by a share of a tile.

    lean_deg: how far hand-made tiles lean out of the plane.
    """
    length, depth, height = size_m
    rows, columns = max(1, round(height / tall)), max(1, round(length / long))
    high, wide = height / rows, length / columns
    random = np.random.default_rng(7)
    made = []
    for row in range(rows):
        start = -length / 2 - (row * shift % 1.0) * wide
        for column in range(columns + 1):
            left = max(start + column * wide, -length / 2)
            right = min(start + (column + 1) * wide, length / 2)
            if right - left > 0.012:
                tilt = random.uniform(-lean_deg, lean_deg, 2)
                made.append(_tile(left, right, row * high, (row + 1) * high, depth, tilt))
    bed = box((length, depth - 0.004, height)).moved(y=0.002)
    return (
        Part("Bed", bed, "grout", collider=None),
        Part("Tiles", joined(made), "tile", collider=None),
    )


def _tile(
    left: float, right: float, low: float, high: float, depth: float, tilt: np.ndarray
) -> Solid:
    wide, tall = right - left - _GROUT_M, high - low - _GROUT_M
    soft = 0.0022
    rings = [ring(wide, tall, 0.0, 0.0, 0), ring(wide - soft, tall - soft, 0.0, 0.0045, 0)]
    slope = np.tan(np.radians(tilt))
    rings[1][:, 2] += np.minimum(rings[1][:, 0] * slope[0] + rings[1][:, 1] * slope[1], 0.0)
    plate = loft_flat(rings)
    return plate.turned("x", 90).moved((left + right) / 2, -depth / 2 + 0.0045, (low + high) / 2)


def loft_flat(rings: list[np.ndarray]) -> Solid:
    """A loft of two rectangles, each closed by two triangles."""
    from chord_usd.assets.solids import welded

    low, high = rings
    faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, j, j + 4], [i, j + 4, i + 4]]
    return welded(np.concatenate([low, high]), faces)


def slab(size_m: Size) -> tuple[Part, ...]:
    """One plate: stone, glass, steel."""
    length, depth, height = size_m
    return (Part("Plate", block((length, depth, height), 0.002), "plate", collider=None),)


def utensil_rail(size_m: Size) -> tuple[Part, ...]:
    """A bar with hooks, and tools that hang on them."""
    length, depth, height = size_m
    back, z = depth / 2, height - 0.012
    y = back - 0.04
    bar = cylinder(0.008, length, 0.002, 14).turned("y", 90).moved(-length / 2, y, z)
    holds = [
        tube(
            [[s * (length / 2 - 0.05), back - 0.001, z], [s * (length / 2 - 0.05), y, z]], 0.006, 8
        )
        + cylinder(0.014, 0.004, 0.001, 14).turned("x", 90).moved(s * (length / 2 - 0.05), back, z)
        for s in (-1, 1)
    ]
    count = max(3, round((length - 0.14) / 0.095))
    spread = np.linspace(-(length - 0.16) / 2, (length - 0.16) / 2, count)
    hooks, tools, grips = [], [], []
    for index, x in enumerate(spread):
        hooks.append(_hook(float(x), y, z))
        tool, grip = _tool(index % 4, height - 0.045)
        tools.append(tool.moved(float(x), y - 0.0155))
        grips.append(grip.moved(float(x), y - 0.0155))
    return (
        Part("Rail", joined([bar, *holds]), "metal", collider=None),
        Part("Hooks", joined(hooks), "metal", collider=None),
        Part("Tools", joined(tools), "steel", collider=None),
        Part("Grips", joined(grips), "grip", collider=None),
    )


def _hook(x: float, y: float, z: float) -> Solid:
    path = [[x, y + 0.011, z - 0.006], [x, y + 0.006, z + 0.0105], [x, y - 0.006, z + 0.0105],
            [x, y - 0.011, z - 0.006], [x, y - 0.013, z - 0.034], [x, y - 0.024, z - 0.03]]  # fmt: skip
    return tube(path, 0.0022, 6)


def _tool(kind: int, top: float) -> tuple[Solid, Solid]:
    """Head and grip of a spoon, slice, ladle or whisk that hangs from z = top."""
    grip_l = 0.11
    grip = block((0.018, 0.009, grip_l), 0.004).moved(z=top - grip_l)
    eye = top - grip_l
    low = 0.004
    if kind == 0:
        head = lathe(
            [(0.0, 0.0), (0.02, 0.006), (0.03, 0.022), (0.028, 0.022), (0.018, 0.01), (0.0, 0.006)],
            16,
        )
        head = head.scaled(1.0, 1.0, 1.0).turned("x", 62).moved(y=0.004, z=low + 0.036)
    elif kind == 1:
        head = block((0.07, 0.003, 0.085), 0.001).moved(z=low)
    elif kind == 2:
        bowl = lathe(
            [
                (0.0, 0.0),
                (0.026, 0.006),
                (0.036, 0.028),
                (0.033, 0.028),
                (0.022, 0.01),
                (0.0, 0.005),
            ],
            18,
        )
        head = bowl.moved(y=-0.03, z=low + 0.001)
    else:
        head = whisk_head(low, 0.11)
    stem_low = {0: low + 0.04, 1: low + 0.08, 2: low + 0.026, 3: low + 0.1}[kind]
    stem = cylinder(0.0035, eye - stem_low + 0.01, 0.0, 8).moved(z=stem_low)
    return head + stem, grip


def _design(
    name: str, category: str, size: Size, draw: Draw, looks: Mapping[str, Mapping[str, str]],
    styles: tuple[str, ...] = (),
) -> Design:  # fmt: skip
    return Design(name, category, size, draw, looks, FINISHES, styles)


def _sized(name: str, size: Size) -> str:
    return f"{name}_{100 * size[0]:.0f}"


_FORMS: tuple[FrontForm, ...] = ("bar", "handleless", "shaker", "slatted")


def _cabinets() -> Iterator[Design]:
    for form in _FORMS:
        looks, styles = kitchen_slots(form), FORM_STYLES[form]
        stem = f"Wall_Cabinet_{form.capitalize()}"
        for length in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2):
            size = (length, 0.35, 0.7)
            yield _design(
                _sized(stem, size),
                "wall_cabinet",
                size,
                partial(wall_cabinet, form=form),
                looks,
                styles,
            )
        for length in (0.4, 0.6, 0.8, 1.0):
            size = (length, 0.35, 0.7)
            yield _design(
                _sized(f"{stem}_Glazed", size),
                "wall_cabinet",
                size,
                partial(glazed_cabinet, form=form),
                looks,
                styles,
            )
        for length in (0.6, 0.9):
            size = (length, 0.35, 0.54)
            yield _design(
                _sized(f"Hood_Built_In_{form.capitalize()}", size),
                "cooker_hood",
                size,
                partial(built_in_hood, form=form),
                looks,
                styles,
            )
    for length in (0.3, 0.45, 0.6, 0.8, 1.0):
        size = (length, 0.32, 0.7)
        yield _design(
            _sized("Wall_Cabinet_Open", size), "wall_cabinet", size, open_cabinet, KITCHENS
        )


_HOODS = {
    "steel": {"metal": "steel", "filter": "grey", "glow": "lamp_shade", "dark_glass": "black_glass"},
    "black_metal": {"metal": "black_metal", "filter": "graphite", "glow": "lamp_shade", "dark_glass": "black_glass"},
    "enamel": {"metal": "white", "filter": "steel", "glow": "lamp_shade", "dark_glass": "black_glass"},
}  # fmt: skip
_MANTELS = {
    "white": {"plaster": "warm_white", "front": "oak", "filter": "steel", "glow": "lamp_shade"},
    "sage": {"plaster": "sage", "front": "sage", "filter": "steel", "glow": "lamp_shade"},
    "walnut": {"plaster": "warm_white", "front": "walnut", "filter": "steel", "glow": "lamp_shade"},
}


def _hoods() -> Iterator[Design]:
    for length in (0.6, 0.75, 0.9):
        size = (length, 0.48, 0.92)
        yield _design(
            _sized("Hood_Chimney", size),
            "cooker_hood",
            size,
            chimney_hood,
            _HOODS,
            ("industrial", "classic", "scandinavian", "modern"),
        )
        size = (length, 0.4, 0.92)
        yield _design(
            _sized("Hood_Slanted", size),
            "cooker_hood",
            size,
            slanted_hood,
            _HOODS,
            ("modern", "japanese"),
        )
        size = (length, 0.5, 0.92)
        yield _design(
            _sized("Hood_Mantel", size),
            "cooker_hood",
            size,
            mantel_hood,
            _MANTELS,
            ("classic", "scandinavian"),
        )


_TILES = {
    "white": {"tile": "ceramic", "grout": "light_grey"},
    "sage": {"tile": "tile_sage", "grout": "warm_white"},
    "navy": {"tile": "tile_navy", "grout": "light_grey"},
    "graphite": {"tile": "tile_graphite", "grout": "graphite"},
    "terracotta": {"tile": "tile_clay", "grout": "sand"},
}
_STONES = {
    "marble": {"plate": "marble"}, "quartz": {"plate": "quartz"}, "dark_stone": {"plate": "dark_stone"},
    "concrete": {"plate": "concrete"},
}  # fmt: skip
_GLASSES = {
    "white": {"plate": "glazed_white"}, "sage": {"plate": "glazed_sage"},
    "graphite": {"plate": "glazed_graphite"}, "steel": {"plate": "steel"},
}  # fmt: skip
_RUNS_M = (0.3, 0.38, 0.48, 0.6, 0.78, 1.0, 1.3, 1.7, 2.2, 2.8)
_SPLASH_HEIGHT_M = 0.53


def _splashbacks() -> Iterator[Design]:
    for length in _RUNS_M:
        size = (length, 0.01, _SPLASH_HEIGHT_M)
        metro = partial(tiles, long=0.15, tall=0.076)
        square = partial(tiles, long=0.1, tall=0.106, shift=0.0, lean_deg=0.9)
        yield _design(
            _sized("Splashback_Metro", size),
            "splashback",
            size,
            metro,
            _TILES,
            ("classic", "industrial", "scandinavian"),
        )
        yield _design(
            _sized("Splashback_Square", size),
            "splashback",
            size,
            square,
            _TILES,
            ("scandinavian", "japanese"),
        )
        yield _design(
            _sized("Splashback_Stone", size),
            "splashback",
            size,
            slab,
            _STONES,
            ("modern", "classic", "industrial", "japanese"),
        )
        yield _design(
            _sized("Splashback_Glass", size),
            "splashback",
            (length, 0.006, _SPLASH_HEIGHT_M),
            slab,
            _GLASSES,
            ("modern",),
        )


_RAILS = {
    "steel": {"metal": "steel", "steel": "steel", "grip": "black"},
    "black_metal": {"metal": "black_metal", "steel": "steel", "grip": "walnut"},
    "brass": {"metal": "brass", "steel": "steel", "grip": "oak"},
}


def _rails() -> Iterator[Design]:
    for length in (0.4, 0.6, 0.8):
        size = (length, 0.12, 0.34)
        yield _design(_sized("Utensil_Rail", size), "utensil_rail", size, utensil_rail, _RAILS)


DESIGNS = (*_cabinets(), *_hoods(), *_splashbacks(), *_rails())
