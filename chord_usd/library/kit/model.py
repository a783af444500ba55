"""What a piece of furniture is before it becomes USD: parts, finishes, colourways, a design."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import AssetError
from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.leaf_clearance import with_clearance
from chord_usd.library.kit.moves import Leaf, Moving, fitted_leaf
from chord_usd.library.kit.solids import Solid, joined
from chord_usd.library.surfaces.finishes import FINISHES, Finish

Collider = Literal["boundingCube", "convexHull"]
"""USD Physics approximation. boundingCube, along the model's axes, is the steady one in the MuJoCo
solver: whatever something movable stands on has it, and a hollow part has several."""

FIT_TOLERANCE = 0.08
"""Largest share by which a drawn model may miss its nominal size before it counts as wrong."""


@dataclass(frozen=True, eq=False)
class Part:
    """One named, watertight mesh with one finish."""

    name: str
    """Prim name, unique within the model."""
    solid: Solid
    slot: str
    """Name of one of the model's materials; colourways give each slot its finish."""
    collider: Collider | None = "boundingCube"
    """None for small trim that nothing needs to collide with."""
    colliders: tuple[Solid, ...] = ()
    """Solids whose bounding boxes collide in place of its own: the two sides of a table."""
    above: bool = False
    """Stands on top and rises above the nominal height (a tap, a television)."""
    uvs: FloatArray | None = None
    """(3 T, 2) texture coordinates of the corners; None projects them in metres."""
    two_sided: bool = False
    """Its surface may be open: both sides are seen."""
    moves: tuple[Moving, ...] = ()
    """What of it moves where the piece is jointed; its solid has that, shut, too."""
    hollow: tuple[Solid, ...] = ()
    """Closed bodies in its solid that doors and drawers open: boards, where it is jointed."""
    still: Solid | None = None
    """What stands still where the piece is jointed, unless that is all of it."""
    still_colliders: tuple[Solid, ...] = ()
    """Solids whose bounding boxes collide in place of the still portion."""

    @property
    def stays(self) -> bool:
        """Whether it is the same where the piece is jointed."""
        return not self.moves and not self.hollow and self.still is None

    @property
    def is_body(self) -> bool:
        """Whether the part counts for the nominal size."""
        return not self.above

    def collider_boxes_m(self) -> dict[str, FloatArray]:
        """Bounds, (2, 3), of the boxes of its colliders, by the names of their prims."""
        if self.collider != "boundingCube":
            return {}
        if not self.colliders:
            return {self.name: self.solid.bounds_m()}
        return {
            f"{self.name}_{n}": solid.bounds_m() for n, solid in enumerate(self.colliders, start=1)
        }


@dataclass(frozen=True)
class Light:
    """What shines in a lamp."""

    at_m: tuple[float, float, float]
    """Middle of the bulb in the model's own frame."""
    radius_m: float = 0.04
    lumens: float = 600.0


Draw = Callable[[tuple[float, float, float]], tuple[Part, ...]]
"""Makes the parts for a size; own frame: underside centred on the origin, front to -y."""


@dataclass(frozen=True)
class Design:
    """A parametric model with its parameters: one asset of the database."""

    id: str
    """Prim and folder name; a valid USD identifier."""
    category: str
    size_m: tuple[float, float, float]
    """Nominal length, width (depth) and height: the bounds of the parts that are its body."""
    draw: Draw
    colourways: Mapping[str, Mapping[str, str]]
    """Colourway name to (slot to finish name); the first one is the default."""
    finishes: Mapping[str, Finish] = field(default_factory=lambda: FINISHES)
    """Finish by name."""
    styles: tuple[str, ...] = ()
    """Names of the styles (scene.styles) whose form it has; empty where it suits them all."""
    light: Light | None = None
    """Where it shines from, if it is a lamp."""

    def parts(self) -> tuple[Part, ...]:
        """The parts, brought to exactly the nominal size; what opens has its clearance.

        Raises AssetError where the drawing misses it by more than FIT_TOLERANCE: stretching a
        bevel is harmless, stretching a wrong model would hide the mistake.
        """
        return with_clearance(fitted(self.draw(self.size_m), self.size_m, self.id), self.size_m)


def fitted(
    parts: tuple[Part, ...], size_m: tuple[float, float, float], name: str
) -> tuple[Part, ...]:
    """Parts stretched and shifted so that the body fills size_m exactly."""
    body = np.array([part.solid.bounds_m() for part in parts if part.is_body])
    low, high = body[:, 0].min(axis=0), body[:, 1].max(axis=0)
    factor = np.array(size_m) / (high - low)
    if np.any(np.abs(factor - 1.0) > FIT_TOLERANCE):
        raise AssetError(
            f"the drawing measures {np.round(high - low, 3).tolist()} m",
            where=name,
            expected=f"{list(size_m)} m",
        )
    base = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    return placed(parts, -base, factor)


def placed(
    parts: tuple[Part, ...], shift_m: npt.ArrayLike, factor: npt.ArrayLike = (1.0, 1.0, 1.0)
) -> tuple[Part, ...]:
    """Parts shifted, then stretched, with all that moves in them."""
    shift, factors = np.asarray(shift_m), np.asarray(factor)
    leaves: dict[Leaf, Leaf] = {}

    def fit(solid: Solid) -> Solid:
        return solid.moved(*shift).scaled(*factors)

    def fit_all(solids: tuple[Solid, ...]) -> tuple[Solid, ...]:
        return tuple(fit(solid) for solid in solids)

    def moving(move: Moving) -> Moving:
        if move.leaf not in leaves:
            leaves[move.leaf] = fitted_leaf(move.leaf, shift, factors)
        return Moving(leaves[move.leaf], fit(move.solid), fit_all(move.colliders))

    return tuple(
        replace(
            part,
            solid=fit(part.solid),
            colliders=fit_all(part.colliders),
            moves=tuple(moving(move) for move in part.moves),
            hollow=fit_all(part.hollow),
            still=None if part.still is None else fit(part.still),
            still_colliders=fit_all(part.still_colliders),
        )
        for part in parts
    )


def moving_part(
    name: str, solids: Sequence[Solid], slot: str, leaves: Sequence[Leaf],
    collider: Collider | None = "boundingCube",
) -> Part:  # fmt: skip
    """A part each of whose solids moves with the leaf of the same place."""
    moves = tuple(Moving(leaf, solid) for leaf, solid in zip(leaves, solids, strict=True))
    return Part(name, joined(solids), slot, collider, moves=moves)


def partly_moving(name: str, moving: Solid, leaf: Leaf, still: Solid, slot: str) -> Part:
    """Trim of which one solid goes with a leaf and one stays."""
    moves = (Moving(leaf, moving),)
    return Part(name, moving + still, slot, collider=None, moves=moves, still=still)


def hollow_part(name: str, solid: Solid, slot: str = "body") -> Part:
    """A closed body that doors and drawers open into."""
    return Part(name, solid, slot, hollow=(solid,))
