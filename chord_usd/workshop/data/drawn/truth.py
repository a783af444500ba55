"""A crowded page and its truth, per pixel and as vectors."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.base.scene.types import ByteArray, FloatArray, Item, Plan


@dataclass(frozen=True, eq=False)
class DrawnStorey:
    """One storey of a page, as vectors."""

    plan: Plan
    """As drawn: rooms between the faces of their walls, rooms of an open plan touch; openings where
    and as deep as they are drawn. Metres on the sheet."""
    walls_m: tuple[FloatArray, ...]
    """(N, 2) rings of the walls' bodies, openings left out; holes run clockwise."""
    hinges_m: tuple[tuple[str, FloatArray, FloatArray], ...]
    """Of each leaf: its opening's id, (2,) where it hangs and (2,) where its tip is when open."""
    pieces: tuple[Item, ...] = ()
    """Furniture and fixtures that are drawn. Metres on the sheet."""


@dataclass(frozen=True, eq=False)
class CrowdedPage:
    """A page as it arrives, and its truth."""

    rgb: ByteArray
    """(H, W, 3)."""
    labels: ByteArray
    """(H, W); page_labels.built_of and laid_of decode them."""
    points: FloatArray
    """(P, 3) continuous pixel x, y and which of page_labels.POINT_NAMES."""
    storeys: tuple[DrawnStorey, ...]
    to_picture: FloatArray
    """(3, 3) from metres on the sheet to continuous pixels of rgb, in homogeneous coordinates."""
