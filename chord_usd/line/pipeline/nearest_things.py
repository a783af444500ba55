"""A word for a piece that is not known -> the known ones of nearest meaning."""

from __future__ import annotations

from collections.abc import Sequence

from chord_usd.base.errors import CheckpointError

_LEAST = 0.45
"""Cosine below which words have little to do with each other."""


def nearest_things(said: str, known: Sequence[str], most: int = 3) -> list[str]:
    """Those of the known words whose meaning is nearest, the nearest first, perhaps none.

    By the text model that reads requests; where it cannot be loaded, none.
    """
    import numpy as np

    from chord_usd.line.planning.encoder import MiniLM

    try:
        words = MiniLM(1).encode([said, *known])
    except CheckpointError:
        return []
    means = np.stack([rows.mean(axis=0) for rows in words])
    means /= np.linalg.norm(means, axis=1, keepdims=True)
    alike = means[1:] @ means[0]
    order = np.argsort(-alike, kind="stable")[:most]
    return [known[at] for at in order if alike[at] >= _LEAST]
