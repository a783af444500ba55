"""How a plan can be drawn: families of styles, and everything that varies within them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

RGB = tuple[int, int, int]

FAMILIES = (
    "agent", "cad", "hatched", "coloured", "line", "scan", "photo", "blueprint", "crossed", "grey",
    "chart", "symbols", "sheet",
)  # fmt: skip
"""Estate agent's; hollow double lines; hatched walls; filled floors; single lines; a scanned
print, askew; a photo with shadow and noise; white on blue; cross-hatched walls; grey walls between
thin faces; walls, doors and windows each in a colour; symbols of fixtures in place of names; a
photo of a sheet on a table, in perspective."""

_DARK: tuple[RGB, ...] = ((0, 0, 0), (30, 30, 30), (60, 60, 70), (20, 40, 80), (80, 20, 20))


@dataclass(frozen=True)
class Style:
    """One way to draw. Lengths in metres on the ground unless a name says otherwise."""

    family: str
    m_per_px: float = 0.015
    paper_rgb: RGB = (255, 255, 255)
    wall: Literal["solid", "hollow", "hatched", "crossed", "line"] = "solid"
    wall_rgb: RGB = (0, 0, 0)
    body_rgb: RGB | None = None
    """Between the faces of walls that are not solid; None for paper."""
    wall_m: float = 0.24
    """Drawn thickness; the true one stays 0.24, about the same middle."""
    line_px: int = 1
    line_rgb: RGB = (0, 0, 0)
    door: Literal["arc", "leaf", "gap", "filled"] = "arc"
    door_rgb: RGB = (230, 140, 195)
    window: Literal["panes", "double", "filled"] = "panes"
    window_rgb: RGB = (200, 215, 235)
    floors: Literal["white", "coloured", "tinted"] = "white"
    language: str = "en"
    sizes: Literal["none", "area", "metres", "centimetres", "feet"] = "area"
    has_names: bool = True
    has_dimensions: bool = False
    has_furniture: bool = True
    has_symbols: bool = False
    """Whether fixtures are drawn, which show a room's kind."""
    has_frame: bool = False
    skew_deg: float = 0.0
    noise: float = 0.0
    """Standard deviation, grey levels."""
    blur_px: float = 0.0
    jpeg: int = 0
    """Quality; 0 for none."""
    shadow: float = 0.0
    """How much darker the darkest corner is, [0, 1]."""
    tilt: float = 0.0
    """How far the corners of the sheet are displaced in a photo, as a share of its sides."""
    letters_m: float = 0.22
    """Height of letters, as on the ground."""


def random_style(rng: np.random.Generator, family: str) -> Style:
    """A style of a family. Raises KeyError for an unknown family."""
    base = Style(
        family,
        m_per_px=float(rng.uniform(0.009, 0.02)),
        wall_rgb=_DARK[int(rng.integers(len(_DARK)))],
        wall_m=float(rng.uniform(0.15, 0.3)),
        line_px=int(rng.integers(1, 3)),
        door=rng.choice(["arc", "arc", "leaf", "gap"]),
        window=rng.choice(["panes", "double", "filled"]),
        language=str(rng.choice(["en", "de", "fr", "es", "pt", "sv", "fi"])),
        sizes=rng.choice(["none", "area", "area", "metres", "centimetres", "feet"]),
        has_names=bool(rng.random() < 0.85),
        has_dimensions=bool(rng.random() < 0.35),
        has_furniture=bool(rng.random() < 0.7),
        has_frame=bool(rng.random() < 0.25),
        jpeg=int(rng.choice([0, 0, 60, 80, 92])),
        letters_m=float(rng.uniform(0.2, 0.28)),
    )
    return replace(base, **_of_family(rng, family))


def _of_family(rng: np.random.Generator, family: str) -> dict[str, Any]:
    grey = int(rng.integers(0, 70))
    changes: dict[str, dict[str, Any]] = {
        "agent": {"wall_rgb": (grey,) * 3},
        "cad": {"wall": "hollow", "wall_rgb": (grey,) * 3, "line_px": 1, "has_dimensions": True},
        "hatched": {"wall": "hatched", "wall_rgb": (grey,) * 3, "line_px": 1},
        "coloured": {"floors": str(rng.choice(["coloured", "tinted"]))},
        "line": {"wall": "line", "line_px": int(rng.integers(3, 6)), "wall_m": 0.24},
        "scan": {"skew_deg": float(rng.uniform(-4.0, 4.0)), "noise": 6.0, "blur_px": 0.6},
        "photo": {
            "shadow": float(rng.uniform(0.2, 0.5)), "noise": 5.0, "blur_px": 1.0, "jpeg": 75,
            "skew_deg": float(rng.uniform(-2.0, 2.0)),
        },
        "blueprint": {
            "paper_rgb": (25, 55, 120), "wall_rgb": (240, 245, 250), "line_rgb": (240, 245, 250),
            "window": str(rng.choice(["panes", "double"])),
        },
        "crossed": {"wall": "crossed", "wall_rgb": (grey,) * 3, "line_px": 1},
        "grey": {"wall": "hollow", "wall_rgb": (40, 40, 40), "body_rgb": (190, 190, 190)},
        "chart": {
            "wall": "hollow", "wall_rgb": (60, 60, 60), "body_rgb": (255, 217, 47), "line_px": 1,
            "door": "filled", "window": "filled", "window_rgb": (166, 216, 84),
            "floors": "coloured", "has_furniture": False, "line_rgb": (60, 60, 60),
        },
        "symbols": {"has_names": False, "has_furniture": False, "has_symbols": True},
        "sheet": {
            "tilt": float(rng.uniform(0.03, 0.09)), "shadow": float(rng.uniform(0.1, 0.3)),
            "noise": 4.0, "blur_px": 0.7, "jpeg": 80,
        },
    }  # fmt: skip
    return changes[family]
