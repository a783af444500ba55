"""A database of boxes to dress rooms with: three sizes of every category, nothing on disk."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from chord_usd.base.scene.palette import DRESSING_CATEGORIES, Category
from chord_usd.base.scene.types import Asset
from chord_usd.library.database import AssetDatabase
from chord_usd.library.design_tables import entries

CURTAINS_M = {"open": (0.3, 0.42), "drawn": (0.6, 0.9, 1.3)}
RUGS_M = ((1.4, 1.4), (2.4, 1.65), (2.8, 1.95), (3.2, 2.3))
RAILS_M = (1.0, 1.4, 1.8, 2.2, 2.6, 3.0, 3.6)
BLINDS_M = (0.6, 0.9, 1.2, 1.5, 1.8)


def _made(asset_id: str, category: str, *size_m: float, tag: str = "") -> Asset:
    length, depth, height = size_m
    path = Path(f"nowhere/{asset_id}.usda")
    tags = (tag,) if tag else ()
    return Asset(asset_id, category, (length, depth, height), path, tags=tags)


def _sizes(row: Category, share: float) -> tuple[float, float, float]:
    spans = (row.length_m, row.width_m, row.height_m)
    length, depth, height = (round(low + share * (high - low), 3) for low, high in spans)
    return length, depth, height


def _plain(row: Category) -> list[Asset]:
    label = row.label.replace(" ", "_")
    return [
        _made(f"{label}_{name}_{100 * share:.0f}", row.name, *_sizes(row, share))
        for name in ("Plain", "Rich")
        for share in (0.1, 0.4, 0.7)
    ]


def stock_of_boxes() -> AssetDatabase:
    """Something of every category of the dressing level."""
    assets = [asset for row in DRESSING_CATEGORIES for asset in _plain(row)]
    # Flat weaves, which furniture may stand on; the plain ones are of pile.
    assets += [_made(f"Rug_Flat_{n}", "rug", *side, 0.0045) for n, side in enumerate(RUGS_M)]
    taken = ("curtain", "curtain_rail", "blind", "throw", "picture")
    assets = [asset for asset in assets if asset.category not in taken]
    for tag, lengths in CURTAINS_M.items():
        for length in lengths:
            for height in (1.4, 2.4):
                name = f"Curtain_{tag}_{100 * length:.0f}x{100 * height:.0f}"
                assets.append(_made(name, "curtain", length, 0.12, height, tag=tag))
    assets += [_made(f"Rail_{100 * m:.0f}", "curtain_rail", m, 0.1, 0.04) for m in RAILS_M]
    assets += [
        _made(f"Blind_{100 * m:.0f}x{100 * h:.0f}", "blind", m, 0.06, h)
        for m in BLINDS_M
        for h in (0.4, 0.8)
    ]
    assets += [
        _made(f"Throw_Bed_{m}", "throw", m / 100, 0.6, 0.35, tag="bed")
        for m in (100, 130, 160, 190)
    ]
    assets += [
        replace(_made(entry.id, "picture", *entry.size_m), styles=entry.styles)
        for entry in entries().values()
        if entry.category == "picture"
    ]
    return AssetDatabase(tuple(assets))
