"""What the pixels of a mask can show: the things of a stage, and marks by which Blender knows them.

A thing is the nearest prim with a semantic label (SemanticsLabelsAPI); where nothing is labelled,
an instance or a single shape. Blender keeps custom attributes of instance roots and of shapes, so
a layer over the stage gives each of these the number of its thing.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.stages import ELEVATION, open_stage
from chord_usd.line.image.picture_layers import layer_over
from chord_usd.line.image.stage_cameras import Matrix, rigid

if TYPE_CHECKING:
    from pxr import Sdf, Usd

NUMBER_MARK = "chord_number"
"""Blender's name of the mark; in USD it lies in the namespace userProperties."""

MOST_THINGS = 65535
"""Masks have 16 bits."""

_OTHER_TAXONOMIES = ("room", "material", "wikidata_qcode")
"""Labels that do not say what a thing is."""


@dataclass(frozen=True)
class Thing:
    """One object of a mask. The world is Z up, in metres."""

    number: int
    """From 1; the value of its pixels in an instance mask."""
    path: str
    """Of its prim."""
    label: str
    """Semantic label, else the prim's name without a number."""
    room: str
    """Name of the room prim it is in; may be empty."""
    matrix: Matrix
    """(4, 4) from its box to the world, column vectors, without scale; the origin is the centre."""
    size_m: tuple[float, float, float]


@dataclass(frozen=True)
class Marks:
    """The things of a stage and the prims that belong to each."""

    things: tuple[Thing, ...]
    numbers: tuple[tuple[str, int], ...]
    """(prim path, number of its thing) of shapes and instances."""


def read_marks(path: Path) -> Marks:
    """The things of a stage. Raises StageError, RenderError for more than a mask can hold."""
    from pxr import Usd

    stage = open_stage(path, load=False)
    stage.Load()
    owners: dict[str, int] = {}
    numbers = []
    for prim in Usd.PrimRange(stage.GetPseudoRoot()):
        if not _is_shown(prim):
            continue
        owner = str(_owner(prim).GetPath())
        numbers.append((str(prim.GetPath()), owners.setdefault(owner, len(owners) + 1)))
    if len(owners) > MOST_THINGS:
        raise RenderError(
            f"holds {len(owners)} things", where=str(path), expected=f"at most {MOST_THINGS}"
        )
    things = tuple(_thing(stage.GetPrimAtPath(path), number) for path, number in owners.items())
    return Marks(things, tuple(numbers))


@contextmanager
def marked_stage(path: Path, marks: Marks) -> Iterator[Path]:
    """Yield a layer over the stage that writes its marks; it is thrown away afterwards."""
    from pxr import Sdf

    with layer_over(path) as (layer, file):
        with Sdf.ChangeBlock():
            for prim_path, number in marks.numbers:
                _write_mark(layer, prim_path, number)
        layer.Save()
        yield file


def _write_mark(layer: Sdf.Layer, prim_path: str, number: int) -> None:
    from pxr import Sdf

    prim = layer.GetPrimAtPath(prim_path) or Sdf.CreatePrimInLayer(layer, prim_path)
    spec = Sdf.AttributeSpec(
        prim,
        f"userProperties:{NUMBER_MARK}",
        Sdf.ValueTypeNames.Int,
        Sdf.VariabilityVarying,
        declaresCustom=True,
    )
    spec.default = number


def _is_shown(prim: Usd.Prim) -> bool:
    """Whether Blender makes an object of it that a camera can see."""
    from pxr import UsdGeom

    if not (prim.IsInstance() or prim.IsA(UsdGeom.Gprim)):
        return False
    shape = UsdGeom.Imageable(prim)
    purposes = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)
    return bool(
        shape
        and shape.ComputePurpose() in purposes
        and shape.ComputeVisibility() != UsdGeom.Tokens.invisible
    )


def _owner(prim: Usd.Prim) -> Usd.Prim:
    """The nearest prim with a label, else the prim itself."""
    above = prim
    while above and not above.IsPseudoRoot():
        if _label(above):
            return above
        above = above.GetParent()
    return prim


def _label(prim: Usd.Prim) -> str:
    for attribute in prim.GetAuthoredPropertiesInNamespace("semantics:labels"):
        if attribute.GetBaseName() not in _OTHER_TAXONOMIES:
            labels = attribute.Get()
            if labels:
                return str(labels[0])
    return ""


def _thing(prim: Usd.Prim, number: int) -> Thing:
    from pxr import Gf, Usd, UsdGeom

    stage = prim.GetStage()
    purposes = [UsdGeom.Tokens.default_, UsdGeom.Tokens.render]
    bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), purposes).ComputeUntransformedBound(prim)
    box = bounds.ComputeAlignedRange()
    place = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    middle = Gf.Matrix4d().SetTranslate(box.GetMidpoint()) * place
    m_per_unit = UsdGeom.GetStageMetersPerUnit(stage)
    extent = box.GetSize()
    stretch = [place.TransformDir(axis).GetLength() for axis in Gf.Matrix3d(1.0)]
    x, y, z = (float(extent[i]) * float(stretch[i]) * m_per_unit for i in range(3))
    name = re.sub(r"_?\d+$", "", prim.GetName()).lower()
    label = _label(prim) or name or prim.GetName()
    return Thing(
        number, str(prim.GetPath()), label, _room_of(prim), rigid(middle, stage), (x, y, z)
    )


def _room_of(prim: Usd.Prim) -> str:
    """Name of the room that a prim is in: of a house of storeys, below one of these."""
    above = prim.GetPath().GetPrefixes()
    rooms = [path for path in above[2:] if path.GetParentPath().name == "Rooms"]
    if rooms and prim.GetStage().GetPrimAtPath(rooms[0]).HasAttribute(ELEVATION):
        rooms = [path for path in above if path.GetParentPath() == rooms[0]]
    return str(rooms[0].name) if rooms else ""
