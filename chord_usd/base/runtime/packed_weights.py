"""Weights in eight bits: whole numbers from -127 to 127, and a scale for each row.

A row is what makes one output of a layer, or the vector of one word. Networks compute with the
products, so a checkpoint in eight bits runs as fast as one in sixteen, from half the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

SCALE_SUFFIX = ".scale"
"""Of the name of the scales of a tensor; their type is that of the tensor before."""

_LEAST_SIZE = 1024
"""Smaller tensors, and those of one axis, stay as they are."""

_STEPS = 127

Tensors = Mapping[str, npt.NDArray[Any]]


def packed(weights: Tensors) -> dict[str, npt.NDArray[Any]]:
    """Tensors by name, the large ones in eight bits with their scales beside them."""
    made: dict[str, npt.NDArray[Any]] = {}
    for name, values in weights.items():
        is_float = np.issubdtype(values.dtype, np.floating)
        if not is_float or values.ndim < 2 or values.size < _LEAST_SIZE:
            made[name] = values
            continue
        rows = values.astype(np.float32).reshape(len(values), -1)
        scales = (np.abs(rows).max(axis=1) / _STEPS).astype(values.dtype)
        steps = np.maximum(scales.astype(np.float32), np.finfo(np.float32).tiny)
        whole = np.clip(np.round(rows / steps[:, None]), -_STEPS, _STEPS)
        made[name] = whole.astype(np.int8).reshape(values.shape)
        made[name + SCALE_SUFFIX] = scales
    return made


def unpacked(stored: Tensors) -> dict[str, npt.NDArray[Any]]:
    """Tensors by name as they are computed with; those that never were packed stay the same.

    Raises KeyError, ValueError for scales that belong to no tensor, or to one of another shape.
    """
    made = {name: values for name, values in stored.items() if not name.endswith(SCALE_SUFFIX)}
    for name in stored.keys() - made.keys():
        scales, whole = stored[name], stored[name.removesuffix(SCALE_SUFFIX)]
        rows = scales.astype(np.float32).reshape(-1, *[1] * (whole.ndim - 1))
        product = (whole.astype(np.float32) * rows).astype(scales.dtype)
        made[name.removesuffix(SCALE_SUFFIX)] = product
    return made
