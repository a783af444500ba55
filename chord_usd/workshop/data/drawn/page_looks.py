"""How crowded pages look: all that varies between them, and the kinds of page there are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from chord_usd.workshop.data.drawn.page_styles import RGB

WallFill = Literal["solid", "hollow", "hatched", "crossed", "dotted", "grey", "layered", "brick"]
DoorKind = Literal[
    "arc", "thick_arc", "dashed_arc", "ajar", "leaf", "slanted", "sliding", "pocket", "folding",
    "filled", "plain",
]  # fmt: skip
WindowKind = Literal[
    "one", "two", "three", "four", "filled", "framed", "sill", "bold", "black", "open", "box"
]
FloorKind = Literal["bare", "tinted", "kinds", "textured", "photo"]
PieceKind = Literal["none", "lines", "white", "grey", "coloured", "photo"]

KINDS: dict[str, float] = {
    "agent": 0.22, "cad": 0.21, "furnished": 0.1, "coloured": 0.08, "photoreal": 0.08,
    "japanese": 0.04, "chart": 0.17, "sketch": 0.07, "blueprint": 0.01, "pastel": 0.02,
}  # fmt: skip
"""Kinds of page and how often they come: estate agents' black walls; engineers' hollow ones with
chains of dimensions; brochures in grey; floors in colours; furniture seen from above; flats with
thick walls and a colour for each kind of room; walls, doors and windows each in a colour; pencil;
white on blue; blue or brown ink on a tint of it."""


@dataclass(frozen=True)
class Look:
    """One way to draw a page. Lengths in metres on the ground unless a name says otherwise."""

    kind: str
    paper_rgb: RGB = (255, 255, 255)
    ink_rgb: RGB = (0, 0, 0)
    outer_wall_m: float = 0.3
    inner_wall_m: float = 0.12
    thick_rooms: float = 0.0
    """Share of rooms whose own walls are thicker."""
    outer_fill: WallFill = "solid"
    inner_fill: WallFill = "solid"
    wall_rgb: RGB = (0, 0, 0)
    body_rgb: RGB = (255, 255, 255)
    """Between the faces of walls that are not solid."""
    line_px: int = 1
    has_joints: bool = False
    """Corners of walls are drawn as in vector editors: mitres, and a dot at each point."""
    masses: float = 0.0
    """Share of rooms with a chimney breast or a column."""
    mass_fill: WallFill = "solid"
    has_rails: bool = True
    rail_m: float = 0.06
    corner_doors: float = 0.4
    """Share of doors that stand in the corner of their wall."""
    doors: tuple[DoorKind, ...] = ("arc",)
    """Drawn from, the first of them most often."""
    door_rgb: RGB = (0, 0, 0)
    door_fill_rgb: RGB | None = None
    has_thresholds: bool = False
    has_arrow: bool = False
    """At the entrance."""
    windows: tuple[WindowKind, ...] = ("two",)
    window_rgb: RGB = (0, 0, 0)
    glass_rgb: RGB = (255, 255, 255)
    floors: FloorKind = "bare"
    tint_rgb: RGB = (255, 255, 255)
    wet_tiles: float = 0.0
    """How likely bathrooms and balconies are tiled where floors are bare."""
    pieces: PieceKind = "lines"
    piece_rgb: RGB = (0, 0, 0)
    pieces_kept: float = 0.9
    only_fixtures: bool = False
    """Kitchens and bathrooms are drawn, nothing that one moves in with."""
    has_shadows: bool = False
    stairs: float = 0.3
    """How likely the house has stairs."""
    names: float = 0.9
    """Share of rooms that are named."""
    sizes: float = 0.5
    letters_m: float = 0.24
    language: str = "en"
    font: int = 0
    is_upper: bool = False
    chains: float = 0.3
    """How likely each side is to have a chain of dimensions."""
    furniture_of_page: float = 0.5
    """How likely each of titles, north arrows, legends, logos and bars is."""
    surroundings: float = 0.3
    """How likely terraces, plots, trees and neighbours are."""
    axes: float = 0.0
    """How likely an engineer's grid is."""
    inner_dimensions: float = 0.0
    """Share of rooms with a dimension line through them."""


def random_look(rng: np.random.Generator, kind: str | None = None) -> Look:
    """A look of a kind, by default of a random one."""
    kinds = list(KINDS)
    kind = kind or kinds[int(rng.choice(len(kinds), p=list(KINDS.values())))]
    base = _common(rng, kind)
    return replace(base, **_of_kind(rng, kind, base))


def _common(rng: np.random.Generator, kind: str) -> Look:
    ink = _dark(rng)
    outer = float(rng.choice([rng.uniform(0.1, 0.2), rng.uniform(0.2, 0.45)]))
    return Look(
        kind,
        ink_rgb=ink,
        outer_wall_m=outer,
        inner_wall_m=float(min(0.2, max(0.05, outer * rng.uniform(0.3, 1.0)))),
        thick_rooms=float(rng.choice([0.0, 0.0, 0.2, 0.4])),
        wall_rgb=ink if rng.random() < 0.7 else _dark(rng),
        line_px=int(rng.choice([1, 1, 1, 2])),
        masses=float(rng.choice([0.0, 0.1, 0.3])),
        mass_fill=str(rng.choice(["solid", "solid", "crossed", "hollow", "hatched"])),  # type: ignore[arg-type]
        has_rails=bool(rng.random() < 0.7),
        rail_m=float(rng.uniform(0.03, 0.1)),
        corner_doors=float(rng.choice([0.0, 0.5, 0.9])),
        doors=_doors(rng),
        door_rgb=ink,
        door_fill_rgb=_light(rng) if rng.random() < 0.15 else None,
        has_thresholds=bool(rng.random() < 0.35),
        has_arrow=bool(rng.random() < 0.15),
        windows=_windows(rng),
        window_rgb=ink,
        wet_tiles=0.15,
        pieces_kept=float(rng.uniform(0.6, 1.0)),
        piece_rgb=ink if rng.random() < 0.6 else _grey(rng, 60, 190),
        only_fixtures=bool(rng.random() < 0.3),
        stairs=float(rng.choice([0.2, 0.7])),
        names=float(rng.choice([0.0, 0.7, 0.95, 1.0], p=[0.1, 0.15, 0.35, 0.4])),
        sizes=float(rng.choice([0.0, 0.5, 1.0], p=[0.35, 0.25, 0.4])),
        letters_m=float(rng.uniform(0.14, 0.36)),
        language=str(rng.choice(LANGUAGES, p=LANGUAGE_SHARES)),
        font=int(rng.integers(1 << 16)),
        is_upper=bool(rng.random() < 0.35),
        chains=float(rng.choice([0.0, 0.0, 0.4, 0.8])),
        furniture_of_page=float(rng.uniform(0.1, 0.8)),
        surroundings=float(rng.choice([0.0, 0.2, 0.5])),
        inner_dimensions=float(rng.choice([0.0, 0.0, 0.0, 0.3])),
    )


LANGUAGES = (
    "en", "de", "fr", "es", "pt", "sv", "fi", "it", "nl", "pl", "da", "ru", "ja", "ko", "zh", "he"
)  # fmt: skip
LANGUAGE_SHARES = (
    0.4, 0.07, 0.06, 0.05, 0.06, 0.04, 0.05, 0.04, 0.04, 0.04, 0.03, 0.03, 0.03, 0.02, 0.02, 0.02
)  # fmt: skip


def _doors(rng: np.random.Generator) -> tuple[DoorKind, ...]:
    others: list[DoorKind] = ["sliding", "folding", "pocket", "plain", "leaf", "slanted", "ajar"]
    lead: list[DoorKind] = ["arc", "arc", "arc", "thick_arc", "thick_arc", "dashed_arc", "ajar",
                            "leaf", "slanted", "plain"]  # fmt: skip
    first = lead[int(rng.integers(len(lead)))]
    return first, others[int(rng.integers(len(others)))]


def _windows(rng: np.random.Generator) -> tuple[WindowKind, ...]:
    kinds: list[WindowKind] = [
        "one", "two", "two", "three", "three", "four", "filled", "framed", "sill", "bold", "open",
    ]  # fmt: skip
    first, second = (kinds[int(i)] for i in rng.integers(len(kinds), size=2))
    return first, second


def _of_kind(rng: np.random.Generator, kind: str, base: Look) -> dict[str, Any]:
    """What a kind of page has of its own."""
    choices: dict[str, Any] = {
        "agent": _agent, "cad": _cad, "furnished": _furnished, "coloured": _coloured,
        "photoreal": _photoreal, "japanese": _japanese, "chart": _chart, "sketch": _sketch,
        "blueprint": _blueprint, "pastel": _pastel,
    }  # fmt: skip
    changes: dict[str, Any] = choices[kind](rng, base)
    return changes


def _agent(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    tinted = rng.random() < 0.15
    black = rng.random() < 0.8
    return {
        "wall_rgb": _grey(rng, 0, 40) if black else _vivid(rng, 0.5),
        "inner_fill": "grey" if rng.random() < 0.08 else "solid",
        "corner_doors": float(rng.choice([0.6, 0.95])),
        "masses": float(rng.choice([0.05, 0.25, 0.4])), "mass_fill": "solid",
        "floors": "tinted" if tinted else "bare", "tint_rgb": _light(rng),
        "pieces": str(rng.choice(["lines", "lines", "none"])),
        "only_fixtures": bool(rng.random() < 0.75),
        "letters_m": float(rng.uniform(0.13, 0.26)),
        "chains": 0.0 if rng.random() < 0.8 else 0.4,
        "language": "en" if rng.random() < 0.7 else base.language,
        "sizes": float(rng.choice([0.3, 1.0])),
        "surroundings": 0.1,
    }  # fmt: skip


def _cad(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    outer = rng.choice(["hollow", "hollow", "layered", "hatched", "dotted", "crossed", "brick"])
    inner = rng.choice(["hollow", "hollow", outer, "solid", "grey"])
    colored = rng.random() < 0.2
    strokes = _strokes(rng) if rng.random() < 0.1 else {}
    return {
        "outer_fill": str(outer), "inner_fill": str(inner), "line_px": 1,
        "wall_rgb": _vivid(rng, float(rng.uniform(0.6, 1.0))) if colored else _grey(rng, 0, 60),
        "door_rgb": _vivid(rng, 0.7) if colored else base.ink_rgb,
        "chains": float(rng.choice([0.0, 0.5, 0.9])), "wet_tiles": 0.4, "axes": 0.15,
        "inner_dimensions": float(rng.choice([0.0, 0.2, 0.6])),
        "surroundings": float(rng.choice([0.2, 0.7])),
        "pieces": str(rng.choice(["lines", "lines", "lines", "none"])),
        "stairs": 0.6, **strokes,
    }  # fmt: skip


def _furnished(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    return {
        "pieces": str(rng.choice(["white", "grey", "lines"])), "only_fixtures": False,
        "piece_rgb": _grey(rng, 20, 200), "floors": str(rng.choice(["bare", "tinted", "textured"])),
        "tint_rgb": _grey(rng, 225, 255), "wall_rgb": _grey(rng, 0, 110),
        "inner_fill": str(rng.choice(["solid", "solid", "solid", "grey", "hollow"])),
        "pieces_kept": 1.0, "body_rgb": _grey(rng, 170, 240),
    }  # fmt: skip


def _coloured(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    fill = str(rng.choice(["solid", "solid", "hollow", "grey"]))
    return {
        "floors": str(rng.choice(["kinds", "kinds", "tinted", "textured"])),
        "tint_rgb": _light(rng), "outer_fill": fill,
        "inner_fill": fill if rng.random() < 0.7 else "hollow",
        "pieces": str(rng.choice(["none", "lines", "white", "coloured", "grey"])),
        "body_rgb": _grey(rng, 150, 255), "glass_rgb": _light(rng),
        "paper_rgb": (255, 255, 255) if rng.random() < 0.6 else _light(rng),
    }  # fmt: skip


def _photoreal(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    walls = rng.choice(["dark", "white", "grey"])
    wall = {"dark": _grey(rng, 20, 80), "white": _grey(rng, 225, 255), "grey": _grey(rng, 110, 200)}
    inked = {"wall_rgb": _grey(rng, 0, 60), "outer_fill": "grey", "inner_fill": "grey"}
    return {
        "floors": "photo", "pieces": "photo", "piece_rgb": _grey(rng, 30, 120),
        "has_shadows": bool(rng.random() < 0.7), "only_fixtures": False, "pieces_kept": 1.0,
        "wall_rgb": wall[str(walls)], "outer_fill": "solid",
        "inner_fill": "solid" if rng.random() < 0.7 else "grey", "body_rgb": wall[str(walls)],
        "door_rgb": _grey(rng, 30, 140), "window_rgb": _grey(rng, 60, 160),
        "glass_rgb": (int(rng.integers(160, 230)), 225, 245),
        "doors": tuple(rng.choice(["arc", "arc", "leaf", "thick_arc", "plain", "slanted"], 2)),
        "names": float(rng.choice([0.0, 0.9])), "inner_wall_m": float(rng.uniform(0.08, 0.2)),
        **(inked if rng.random() < 0.4 else {}),
    }  # fmt: skip


def _japanese(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    wall = _grey(rng, 0, 60) if rng.random() < 0.6 else _vivid(rng, 0.6)
    return {
        "floors": "kinds", "wall_rgb": wall, "pieces": str(rng.choice(["none", "lines", "white"])),
        "only_fixtures": True, "language": str(rng.choice(["ja", "ja", "zh", "ko", "en"])),
        "doors": tuple(rng.choice(["arc", "sliding", "arc", "folding"], 2)), "corner_doors": 0.7,
        "letters_m": float(rng.uniform(0.3, 0.6)), "windows": ("two", "three"),
        "inner_wall_m": float(rng.uniform(0.08, 0.18)), "chains": 0.0,
    }  # fmt: skip


def _chart(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    """Walls, doors and windows in a colour each, filled or as outlines."""
    filled = rng.random() < 0.3
    fill = "solid" if filled else "hollow"
    outlined = "box" if rng.random() < 0.7 else "framed"
    return {
        "outer_fill": fill, "inner_fill": fill,
        "has_joints": not filled and rng.random() < 0.6,
        "outer_wall_m": base.outer_wall_m * float(rng.uniform(1.0, 1.5)),
        "wall_rgb": _vivid(rng, 0.9), "doors": ("filled",), "door_rgb": _vivid(rng, 0.9),
        "windows": ("filled",) if filled else (outlined,),
        "window_rgb": _vivid(rng, 0.9) if rng.random() < 0.7 else _grey(rng, 0, 60),
        "glass_rgb": _vivid(rng, 1.0) if filled or rng.random() < 0.2 else (255, 255, 255),
        "floors": "kinds" if filled else "bare",
        "door_fill_rgb": _vivid(rng, 1.0) if filled else None,
        "pieces": "none" if rng.random() < 0.8 else "lines",
        "names": 0.0 if rng.random() < 0.7 else 1.0, "sizes": 0.0, "chains": 0.0,
        "masses": 0.0, "furniture_of_page": 0.25, "surroundings": 0.0, "stairs": 0.0,
    }  # fmt: skip


def _sketch(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    fill = str(rng.choice(["hollow", "hatched", "solid"]))
    strokes = _strokes(rng) if rng.random() < 0.7 else {}
    wide = int(rng.integers(1, 4))
    shade = int(rng.integers(205, 255))
    return {
        "outer_fill": fill, "inner_fill": fill if rng.random() < 0.7 else "solid", "line_px": wide,
        "wall_rgb": _grey(rng, 20, 110), "door_rgb": _grey(rng, 20, 110),
        "paper_rgb": (shade, shade - 5, shade - 14), "body_rgb": (shade, shade - 5, shade - 14),
        "pieces": str(rng.choice(["none", "lines"])), "masses": 0.0,
        "windows": tuple(rng.choice(["one", "two", "bold", "open", "three"], 2)),
        "furniture_of_page": 0.1, **strokes,
    }  # fmt: skip


def _strokes(rng: np.random.Generator) -> dict[str, Any]:
    """Walls that are single strokes."""
    width = float(rng.uniform(0.025, 0.07))
    return {
        "outer_fill": "solid", "inner_fill": "solid", "outer_wall_m": width, "inner_wall_m": width,
        "masses": 0.0, "thick_rooms": 0.0,
    }  # fmt: skip


def _blueprint(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    paper = (int(rng.integers(0, 50)), int(rng.integers(30, 90)), int(rng.integers(90, 170)))
    if rng.random() < 0.3:
        paper = _grey(rng, 0, 50)
    light = _grey(rng, 215, 255)
    fill = str(rng.choice(["hollow", "solid", "hatched"]))
    return {
        "paper_rgb": paper, "body_rgb": paper, "ink_rgb": light, "wall_rgb": light,
        "door_rgb": light, "window_rgb": light, "piece_rgb": light, "glass_rgb": paper,
        "tint_rgb": paper, "outer_fill": fill, "inner_fill": fill, "door_fill_rgb": None,
        "pieces": "lines",
    }  # fmt: skip


def _pastel(rng: np.random.Generator, base: Look) -> dict[str, Any]:
    ink = _vivid(rng, 0.6)
    tint: RGB = tuple(int(255 - (255 - v) * 0.15) for v in ink)  # type: ignore[assignment]
    return {
        "ink_rgb": ink, "wall_rgb": ink, "door_rgb": ink, "window_rgb": ink, "piece_rgb": ink,
        "floors": "tinted", "tint_rgb": tint, "pieces": str(rng.choice(["none", "lines"])),
        "inner_wall_m": float(rng.uniform(0.04, 0.1)),
        "outer_wall_m": float(rng.uniform(0.05, 0.12)),
    }  # fmt: skip


def _grey(rng: np.random.Generator, low: int, high: int) -> RGB:
    value = int(rng.integers(low, high + 1))
    return value, value, value


def _dark(rng: np.random.Generator) -> RGB:
    if rng.random() < 0.8:
        return _grey(rng, 0, 70)
    red, green, blue = (int(v) for v in rng.uniform(0, 120, 3))
    return red, green, blue


def _light(rng: np.random.Generator) -> RGB:
    if rng.random() < 0.3:
        return _grey(rng, 215, 254)
    red, green, blue = (int(v) for v in rng.uniform(195, 255, 3))
    return red, green, blue


def _vivid(rng: np.random.Generator, brightness: float) -> RGB:
    """A saturated colour."""
    hue = rng.uniform(0, 6)
    wheel = np.clip(np.abs((hue + np.array([0.0, 4.0, 2.0])) % 6 - 3) - 1, 0, 1)
    scale = 255 * brightness * rng.uniform(0.7, 1.0)
    red, green, blue = (int(v) for v in scale * (1 - rng.uniform(0.5, 1.0) * (1 - wheel)))
    return red, green, blue
