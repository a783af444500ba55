"""Looks that the pieces of a house share: fewer of them, and each piece looks as it did."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdShade

from chord_usd.base.scene.types import SceneGraph
from chord_usd.library.database import load_database
from chord_usd.line.graph.match import match_assets
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.author.shared_looks import LOOKS, LOOKS_SET
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan

_ALL = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


@pytest.fixture(scope="module")
def furnished() -> SceneGraph:
    rng = np.random.default_rng(4)
    return match_assets(furnish(random_plan(rng, 3), rng), load_database(()))


@pytest.mark.parametrize("articulation", ["fixed", "jointed"])
def test_pieces_look_as_their_own_materials_do(
    furnished: SceneGraph, articulation: str, tmp_path: Path
) -> None:
    path = tmp_path / "house.usda"
    author_stage(furnished, path, style="scandinavian", articulation=articulation)
    report = check_stage(path)
    assert not report.errors, report.errors
    shared = Usd.Stage.Open(str(path))
    assert shared.GetPrimAtPath(LOOKS).GetChildren()
    seen, own = dict(_worn(shared)), dict(_worn(_with_own_materials(path)))
    assert seen == own


def test_a_colourway_chosen_later_is_worn(furnished: SceneGraph, tmp_path: Path) -> None:
    path = tmp_path / "house.usda"
    author_stage(furnished, path, style="scandinavian")
    stages = Usd.Stage.Open(str(path)), _with_own_materials(path)
    for stage in stages:
        for prim in stage.Traverse():
            colours = prim.GetVariantSet("colour")
            names = colours.GetVariantNames()
            if prim.IsInstance() and len(names) > 1:
                colours.SetVariantSelection(names[names.index(colours.GetVariantSelection()) - 1])
    assert dict(_worn(stages[0])) == dict(_worn(stages[1]))


def _with_own_materials(path: Path) -> Usd.Stage:
    """The stage with nothing that wears looks of the house."""
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    text = layer.ExportToString()
    layer.ImportFromString(text.replace(f'string {LOOKS_SET} = "house"', ""))
    other = path.with_name("own.usda")
    layer.Export(str(other))
    return Usd.Stage.Open(str(other))


def _worn(stage: Usd.Stage) -> Iterator[tuple[str, Any]]:
    """What each gprim wears, and what it feels like where it is felt, by its path."""
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), _ALL):
        if not prim.IsA(UsdGeom.Gprim):
            continue
        binding = UsdShade.MaterialBindingAPI(prim)
        seen, felt = (binding.ComputeBoundMaterial(purpose)[0] for purpose in ("full", "physics"))
        surface = seen.ComputeSurfaceSource()[0] if seen else None
        told = sorted(_said_by(surface)) if surface else []
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            told += [
                (one.GetName(), str(one.Get()))
                for one in felt.GetPrim().GetAuthoredPropertiesInNamespace("physics")
            ]
        yield str(prim.GetPath()), told


def _said_by(shader: UsdShade.Shader) -> Iterator[tuple[str, str]]:
    for wire in shader.GetInputs():
        name = f"{shader.GetPrim().GetName()}.{wire.GetBaseName()}"
        sources = wire.GetConnectedSources()[0]
        if sources:
            source = UsdShade.Shader(sources[0].source.GetPrim())
            yield name, source.GetPrim().GetName()
            yield from _said_by(source)
        elif not (wire.GetBaseName() == "normal" and wire.Get() == (0.0, 0.0, 1.0)):
            value = wire.Get()
            if isinstance(value, Sdf.AssetPath):  # of all names of a file, one
                value = Path(value.resolvedPath).stat().st_ino
            yield name, str(value)
