"""Colourways of what is made of ceramic, for toilets and bathtubs."""

from __future__ import annotations

CERAMIC = {
    "white": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "chrome", "cap": "ceramic"},
    "black_metal": {
        "ceramic": "ceramic",
        "seat": "plastic_white",
        "metal": "black_metal",
        "cap": "black",
    },
    "brass": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "brass", "cap": "marble"},
}
