"""What a piece of furniture is before it becomes USD: parts, finishes, colourways, a design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from chord_usd.assets.solids import Solid
from chord_usd.errors import AssetError

Collider = Literal["boundingCube", "convexHull", "none"]
"""USD Physics approximation; `none` collides with the triangles themselves (fixed, hollow parts).

boundingCube, along the model's axes, is the steady one in the MuJoCo solver: whatever stands on the
floor has it.
"""

FIT_TOLERANCE = 0.08
"""Largest share by which a drawn model may miss its nominal size before it counts as wrong."""


@dataclass(frozen=True, eq=False)
class Part:
    """One named, watertight mesh with one finish."""

    name: str
    """Prim name, unique within the model."""
    solid: Solid
    slot: str
    """Which of the model's materials it wears; colourways say what each slot looks like."""
    collider: Collider | None = "boundingCube"
    """None for small trim that nothing needs to collide with."""
    above: bool = False
    """Stands on top and rises above the nominal height (a tap, a television)."""


Draw = Callable[[tuple[float, float, float]], tuple[Part, ...]]
"""Makes the parts for a size; own frame: underside centred on the origin, front to -y."""


@dataclass(frozen=True)
class Design:
    """A parametric model with its parameters: one asset of the database."""

    id: str
    """Prim and folder name; a valid USD identifier."""
    category: str
    size_m: tuple[float, float, float]
    """Nominal length, width (depth) and height: the bounds of all parts that are not `above`."""
    draw: Draw
    colourways: Mapping[str, Mapping[str, str]]
    """Colourway name to (slot to finish name); the first one is the default."""

    def parts(self) -> tuple[Part, ...]:
        """The parts, brought to exactly the nominal size.

        Raises AssetError where the drawing misses it by more than FIT_TOLERANCE: stretching a
        bevel is harmless, stretching a wrong model would hide the mistake.
        """
        return fitted(self.draw(self.size_m), self.size_m, self.id)


def fitted(
    parts: tuple[Part, ...], size_m: tuple[float, float, float], name: str
) -> tuple[Part, ...]:
    """Parts stretched and shifted so that those not `above` fill size_m exactly."""
    body = np.array([part.solid.bounds_m() for part in parts if not part.above])
    low, high = body[:, 0].min(axis=0), body[:, 1].max(axis=0)
    factor = np.array(size_m) / (high - low)
    if np.any(np.abs(factor - 1.0) > FIT_TOLERANCE):
        raise AssetError(
            f"the drawing measures {np.round(high - low, 3).tolist()} m",
            where=name,
            expected=f"{list(size_m)} m",
        )
    base = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    return tuple(replace(part, solid=part.solid.moved(*(-base)).scaled(*factor)) for part in parts)
