"""FID and KID of layout rasters, under the name of the encoder (encoders.py).

Figures of different encoders are never to be compared. The floor beside each is the same score
between two sets of real pictures of the same size: no model can be expected to go below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import WALL_THICKNESS_M, ByteArray, FloatArray, Room, RoomKind
from chord_usd.workshop.evaluation.cases import Case, procedural_cases
from chord_usd.workshop.evaluation.encoders import Encoder
from chord_usd.workshop.evaluation.layouts import Furnished, Sampling, as_read, drawn

LEAST_PICTURES = 10
"""Fewer have no covariance worth the name."""

_OTHER_PLANS = 10**5
"""Procedural test plans from here on are those that both sets are compared with."""

ROOM_KINDS: tuple[RoomKind, ...] = ("bedroom", "living")
"""Kinds of room with a row of their own (paper)."""


@dataclass(frozen=True)
class Realism:
    """How like real pictures a set of pictures is; smaller is better."""

    fid: float
    fid_floor: float
    kid: float
    kid_floor: float
    count: int
    """Pictures in each of the three sets: the generated, and the two real ones."""
    encoder: str = ""
    """By whose features."""


def frechet_distance(a: FloatArray, b: FloatArray) -> float:
    """FID between two sets of features, (N, D) and (M, D) (Heusel et al., 2017).

    The trace of the square root of the product of two covariances is the nuclear norm of the
    product of the centred features: exact also where there are fewer pictures than features.
    """
    centred_a = (a - a.mean(axis=0)) / np.sqrt(len(a) - 1)
    centred_b = (b - b.mean(axis=0)) / np.sqrt(len(b) - 1)
    shared = np.linalg.svd(centred_a @ centred_b.T, compute_uv=False).sum()
    means = ((a.mean(axis=0) - b.mean(axis=0)) ** 2).sum()
    return float(means + (centred_a**2).sum() + (centred_b**2).sum() - 2.0 * shared)


def kernel_distance(a: FloatArray, b: FloatArray) -> float:
    """KID between two sets of features: unbiased squared MMD, cubic kernel (Binkowski, 2018)."""

    def kernel(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.asarray((x @ y.T / x.shape[1] + 1.0) ** 3)

    def within(x: FloatArray) -> float:
        table = kernel(x, x)
        return float((table.sum() - np.trace(table)) / (len(x) * (len(x) - 1)))

    return within(a) + within(b) - 2.0 * float(kernel(a, b).mean())


def realism(generated: FloatArray, real: FloatArray, others: FloatArray) -> Realism | None:
    """Generated pictures against real ones of other plans; the floor is real against those.

    All three by their features, (N, D). real: pictures of the plans the generated ones are of. All
    three sets are cut to the same size, since both distances depend on it. None where that is below
    LEAST_PICTURES.
    """
    count = min(len(generated), len(real), len(others))
    if count < LEAST_PICTURES:
        return None
    ours, theirs, rest = (features[:count] for features in (generated, real, others))
    return Realism(
        fid=frechet_distance(ours, rest),
        fid_floor=frechet_distance(theirs, rest),
        kid=kernel_distance(ours, rest),
        kid_floor=kernel_distance(theirs, rest),
        count=count,
    )


def reference_layouts(
    cases: Sequence[Case], sampling: Sampling
) -> tuple[list[Furnished], list[Furnished]]:
    """What these cases are furnished with, and others of their kind.

    Those that nobody has furnished are by our furnisher.

    There are no further real plans: where cases are not procedural, the first list is of their
    first half and the second of the rest.
    """
    if all(case.id.startswith("procedural/") for case in cases):
        others: Sequence[Case] = procedural_cases("test", len(cases), start=_OTHER_PLANS).cases
    else:
        half = len(cases) // 2
        cases, others = cases[:half], cases[half:]
    return list(drawn(cases, sampling)), list(drawn(others, sampling))


def realism_by_part(
    generated: Sequence[Furnished],
    real: Sequence[Furnished],
    others: Sequence[Furnished],
    encoder: Encoder,
    sampling: Sampling,
) -> dict[str, Realism]:
    """Realism of whole houses and of the rooms of ROOM_KINDS, each cut out of its house.

    Of the pictures as they are and, where a model painted them, `as read`: painted from the
    items that were read, from which a stage is built.
    """
    read = [
        as_read(layout, sampling) for layout in generated if layout.image.provenance.checkpoint_hash
    ]
    by_part = {}
    for part in ("house", *ROOM_KINDS):
        theirs, rest = (encoder.features(_pictures(those, part)) for those in (real, others))
        for name, those in ((part, generated), (f"{part}, as read", read)):
            ours = encoder.features(_pictures(those, part))
            by_part[name] = realism(ours, theirs, rest)
    name = encoder.name
    return {
        part: replace(figures, encoder=name)
        for part, figures in by_part.items()
        if figures is not None
    }


def _pictures(furnished: Sequence[Furnished], part: str) -> list[ByteArray]:
    """Of whole houses, or of their rooms of a kind."""
    if part == "house":
        return [layout.image.rgb for layout in furnished]
    return [
        room_picture(layout, room)
        for layout in furnished
        for room in layout.case.plan.rooms
        if room.kind == part
    ]


def room_picture(layout: Furnished, room: Room) -> ByteArray:
    """A square cut-out of a room with its walls; what lies beyond them is white."""
    frame = layout.image.frame
    walled = np.array(
        room_polygon(room).buffer(WALL_THICKNESS_M, join_style="mitre").exterior.coords
    )[:-1]
    pixels = canvas.room_pixels(Room(room.id, room.kind, walled[::-1]), frame)
    rgb = np.where(pixels[..., None], layout.image.rgb, 255).astype(np.uint8)
    rows, columns = np.flatnonzero(pixels.any(axis=1)), np.flatnonzero(pixels.any(axis=0))
    cut = rgb[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    side = max(cut.shape[:2])
    square = np.full((side, side, 3), 255, np.uint8)
    square[: cut.shape[0], : cut.shape[1]] = cut
    return square
