"""Whether what can open does: terms that assets, stages and commands share."""

from __future__ import annotations

ARTICULATION = "articulation"
"""The variant set."""

FIXED, JOINTED = "fixed", "jointed"
"""Its variants: a piece in one, or one whose doors and drawers open."""

SETTLES_S = 0.4
"""What hangs on a joint and was pushed slows down to a third in this time."""

PAYLOAD_LAYER, JOINTED_LAYER = "payload.usdc", "jointed.usdc"
"""Layers beside an asset's interface: its geometry, and its bodies and joints."""

JOINTS = "Joints"
"""The scope of joints in JOINTED_LAYER."""
