"""What a spiral stair is drawn from: treads with risers, the landing, the pole.

Everything is in the stair's own frame. Its handrail is that of a winder's turn, along the rim.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from shapely.geometry import Point

from chord_usd.base.scene.stair_forms import BuiltStair
from chord_usd.base.scene.stair_spirals import POLE_M, SPIRAL_THICK_M
from chord_usd.line.stage.shell.mesh import Face, prism

_RISER_M = 0.02
_SAME_M = 1e-3
_OVER_LANDING_M = 1.0
"""How much higher the pole is than the landing: as high as the railing around the hole."""


def spiral_tread_faces(built: BuiltStair) -> Iterator[Face]:
    """Treads, each on a riser that stands on the one below, and the landing."""
    for tread in built.treads:
        low_m = tread.top_m - SPIRAL_THICK_M
        yield from prism(tread.area_m, low_m, tread.top_m)
        if tread.edges_m is not None:
            edge = tread.edges_m[0].buffer(_RISER_M, cap_style="flat")
            riser = shapely.remove_repeated_points(edge.intersection(tread.area_m), _SAME_M)
            closed = prism(riser, tread.top_m - built.rise_m, low_m)
            # Its ends lie on treads; drawings would take the upper one for a step.
            yield from (face for face in closed if np.ptp(face.corners_m[:, 2]) > 0.0)


def pole_faces(built: BuiltStair) -> list[Face]:
    """The pole, from the floor to over the landing."""
    pole = Point(0.0, 0.0).buffer(POLE_M, quad_segs=8)
    return prism(pole, 0.0, built.height_m + _OVER_LANDING_M)
