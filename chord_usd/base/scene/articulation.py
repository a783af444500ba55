"""Whether what can open does: terms that assets, stages and commands share."""

from __future__ import annotations

import math
from pathlib import Path

ARTICULATION = "articulation"
"""The variant set."""

FIXED, JOINTED = "fixed", "jointed"
"""Its variants: a piece in one, or one whose doors and drawers open."""

SETTLES_S = 0.4
"""What hangs on a joint and was pushed slows down to a third in this time."""

_MOST_N_M_S = 12.0
"""Per radian, of a wide leaf: a hand that turns it by 30 N m has it open within 1.6 s."""


def hinge_damping(inertia_kg_m2: float) -> float:
    """Of a leaf about its hinge, in newton metre seconds per degree."""
    return round(math.radians(min(inertia_kg_m2 / SETTLES_S, _MOST_N_M_S)), 6)


PAYLOAD_LAYER, JOINTED_LAYER = "payload.usdc", "jointed.usdc"
"""Layers of an asset: its geometry, and its bodies and joints."""

PROP = "simready_usd"
"""Folder of an asset's package that simulators take by itself."""

PAYLOADS = f"{PROP}/payloads"
"""Where these layers and their pictures lie, seen from the asset's interface."""


def layer_places(name: str) -> tuple[str, str]:
    """Where a layer of an asset may lie, seen from its interface; packages of earlier versions
    have it beside that."""
    return f"{PAYLOADS}/{name}", name


def layer_file(interface: Path, name: str) -> Path | None:
    """The file of a layer of an asset, or None where it has none."""
    files = (interface.parent / place for place in layer_places(name))
    return next((file for file in files if file.is_file()), None)


JOINTS = "Joints"
"""The scope of joints in JOINTED_LAYER."""
