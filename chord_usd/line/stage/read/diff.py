"""What changed between two stages, in words.

Prims are compared by their paths, which are stable: the same plan and seed give the same names.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from chord_usd.base.runtime.stages import open_stage, reading
from chord_usd.base.scene.types import FloatArray
from chord_usd.base.scene.units import wrap_deg

_MOVED_M = 5e-4
_TURNED_DEG = 0.05
_RESIZED = 1e-3
_SHAPE = ("points", "faceVertexCounts", "faceVertexIndices")
_FOLLOWS = (
    "extent", "extentsHint", "normals", "primvars:st", "primvars:st:indices", "chord:usd_path",
    "chord:size_m",
)  # fmt: skip
"""Attributes that change with others."""

_COMPASS = (
    "east",
    "north-east",
    "north",
    "north-west",
    "west",
    "south-west",
    "south",
    "south-east",
)


@dataclass(frozen=True)
class Change:
    """One difference."""

    path: str
    """Prim path."""
    text: str
    """What happened to the prim: the rest of a sentence that begins with its name."""


def diff_stages(before: Path, after: Path) -> tuple[Change, ...]:
    """What distinguishes the second stage from the first, in order of path.

    Of a part that appears or goes only the topmost prim is reported. Raises StageError for a file
    that cannot be opened.
    """
    with reading(after), reading(before):
        return _changes_between(open_stage(before), open_stage(after))


def _changes_between(*stages: Usd.Stage) -> tuple[Change, ...]:
    old, new = ({str(prim.GetPath()): prim for prim in stage.Traverse()} for stage in stages)
    changes = [*_only_in(old, new, "is gone"), *_only_in(new, old, "is new")]
    for path in old.keys() & new.keys():
        changes += [Change(path, text) for text in _changes(old[path], new[path])]
    return tuple(sorted(changes, key=lambda change: (change.path, change.text)))


def _only_in(
    here: Mapping[str, Usd.Prim], there: Mapping[str, Usd.Prim], what: str
) -> Iterator[Change]:
    for path, prim in here.items():
        if path not in there and (prim.GetParent().IsPseudoRoot() or _parent(path) in there):
            asset = _asset(prim)
            yield Change(path, f"{what} ({asset})" if asset else what)


def _parent(path: str) -> str:
    return path.rsplit("/", 1)[0]


def _changes(old: Usd.Prim, new: Usd.Prim) -> Iterator[str]:
    if old.GetTypeName() != new.GetTypeName():
        yield f"was a {old.GetTypeName() or 'plain prim'} and is a {new.GetTypeName()}"
    if _asset(old) != _asset(new):
        yield f"is another model: {_asset(old) or 'none'} became {_asset(new) or 'none'}"
    yield from _variants(old, new)
    if old.IsA(UsdGeom.Xformable) and new.IsA(UsdGeom.Xformable):
        yield from _placement(_matrix(old), _matrix(new))
    yield from _values(old, new)


def _asset(prim: Usd.Prim) -> str:
    return str(prim.GetAssetInfoByKey("name") or "")


def _variants(old: Usd.Prim, new: Usd.Prim) -> Iterator[str]:
    sets = {name: None for prim in (old, new) for name in prim.GetVariantSets().GetNames()}
    for name in sets:
        was, now = (p.GetVariantSets().GetVariantSelection(name) or "none" for p in (old, new))
        if was != now:
            yield f"uses another {name}: {was} became {now}"


def _matrix(prim: Usd.Prim) -> FloatArray:
    """(4, 4) to the parent, column vectors."""
    return np.array(UsdGeom.Xformable(prim).GetLocalTransformation()).T


def _placement(old: FloatArray, new: FloatArray) -> Iterator[str]:
    """Moved, turned, resized; metres and degrees."""
    offset = new[:3, 3] - old[:3, 3]
    flat = float(np.hypot(offset[0], offset[1]))
    if flat > _MOVED_M:
        sector = round(math.degrees(math.atan2(offset[1], offset[0])) / 45.0) % 8
        yield f"moved {flat:.2f} m to the {_COMPASS[sector]}"
    if abs(offset[2]) > _MOVED_M:
        yield f"moved {abs(offset[2]):.2f} m {'up' if offset[2] > 0 else 'down'}"
    yaws = [math.degrees(math.atan2(m[1, 0], m[0, 0])) for m in (old, new)]
    turn = wrap_deg(yaws[1] - yaws[0])
    if min(abs(turn), 360.0 - abs(turn)) > _TURNED_DEG:
        yield f"turned by {turn:.1f} degrees"
    growth = np.linalg.norm(new[:3, :3], axis=0) / np.linalg.norm(old[:3, :3], axis=0)
    if np.abs(growth - 1.0).max() > _RESIZED:
        length, width, height = growth * 100.0
        yield f"is {length:.0f} % as long, {width:.0f} % as wide, {height:.0f} % as high as it was"


def _values(old: Usd.Prim, new: Usd.Prim) -> Iterator[str]:
    """Everything else that is written on a prim."""
    sides = [{a.GetName(): a.Get() for a in prim.GetAuthoredAttributes()} for prim in (old, new)]
    names = [
        name
        for name in sorted(sides[0].keys() | sides[1].keys())
        if not name.startswith("xformOp") and name not in _FOLLOWS
        and not _same(sides[0].get(name), sides[1].get(name))
    ]  # fmt: skip
    if set(names) & set(_SHAPE):
        yield "has another shape"
    for name in names:
        if name not in _SHAPE:
            yield f"{name}: {_shown(sides[0].get(name))} became {_shown(sides[1].get(name))}"


def _same(old: Any, new: Any) -> bool:
    if isinstance(old, Sdf.AssetPath) and isinstance(new, Sdf.AssetPath):
        return Path(old.path).name == Path(new.path).name  # folders are named after their stage
    if hasattr(old, "__len__") and hasattr(new, "__len__") and not isinstance(old, str):
        return len(old) == len(new) and bool(old == new)
    return bool(old == new)


def _shown(value: Any) -> str:
    """A value in few characters."""
    if value is None:
        return "nothing"
    if isinstance(value, float):
        return f"{value:.4g}"
    text = str(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
