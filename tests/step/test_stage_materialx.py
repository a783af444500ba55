"""Houses with MaterialX networks, held against MaterialX' own definitions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import MaterialX as mx  # type: ignore[import-untyped]  # noqa: N813
import pytest
from pxr import Sdf, Usd, UsdShade

from chord_usd.base.scene.types import Box, Item, Room, SceneGraph, frozen_array
from chord_usd.cli import UNUSABLE, main
from chord_usd.library.database import load_database
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.export_stage import export_stage

KINDS = {
    "color3f": "color3", "color4f": "color4", "float": "float", "float2": "vector2",
    "float3": "vector3", "asset": "filename", "string": "string", "int": "integer",
    "token": "surfaceshader",
}  # fmt: skip


def twins(stage: Usd.Stage) -> Iterator[UsdShade.Shader]:
    """The MaterialX nodes of a stage, with those in instances."""
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdShade.Shader) and str(UsdShade.Shader(prim).GetShaderId()).startswith("ND_"):
            yield UsdShade.Shader(prim)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A room with a piece of each of three looks, and the same with networks."""
    folder = tmp_path_factory.mktemp("materialx")
    corners = frozen_array([(0.0, 0.0), (6.0, 0.0), (6.0, 5.0), (0.0, 5.0)])
    assets = [
        load_database().nearest(name, size_m)
        for name, size_m in (
            ("bed", (1.5, 2.1, 1.0)), ("tv_cabinet", (1.6, 0.4, 0.5)),
            ("refrigerator", (0.6, 0.6, 1.8)),
        )
    ]  # fmt: skip
    items = tuple(
        Item(f"{n}", one.category, Box((1.2 + 1.9 * n, 2.5, 0.0), one.size_m, 0.0), "r", one)
        for n, one in enumerate(assets)
    )
    graph = SceneGraph(rooms=(Room("r", "bedroom", corners),), openings=(), items=items)
    source = author_stage(graph, folder / "house.usda").path
    export_stage(source, folder / "materialx", "materialx")
    return source, folder / "materialx" / "house.usda"


def test_every_material_has_nodes_that_materialx_defines(written: tuple[Path, Path]) -> None:
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    stage = Usd.Stage.Open(str(written[1]))
    nodes = list(twins(stage))
    assert nodes
    for node in nodes:
        definition = library.getNodeDef(node.GetShaderId())
        assert definition is not None, node.GetShaderId()
        inputs = {one.getName(): one.getType() for one in definition.getActiveInputs()}
        outputs = {one.getName(): one.getType() for one in definition.getActiveOutputs()}
        for one in node.GetInputs():
            assert KINDS[str(one.GetTypeName())] == inputs[one.GetBaseName()], one.GetFullName()
            for source in one.GetAttr().GetConnections():
                wired = stage.GetAttributeAtPath(source)
                assert wired, source
                assert wired.GetTypeName() == one.GetTypeName()
        for out in node.GetOutputs():
            assert KINDS[str(out.GetTypeName())] == outputs[out.GetBaseName()]


def test_both_networks_say_the_same_in_every_colourway(written: tuple[Path, Path]) -> None:
    stage = Usd.Stage.Open(str(written[1]))
    told: dict[str, set[str]] = {}
    for prim in stage.Traverse():
        ways = prim.GetVariantSets()
        for name in ways.GetNames():
            for way in ways.GetVariantSet(name).GetVariantNames():
                ways.GetVariantSet(name).SetVariantSelection(way)
                for key, value in _colours(stage):
                    told.setdefault(key, set()).add(value)
    assert any(len(values) > 1 for values in told.values())  # the colourways are there


def _colours(stage: Usd.Stage) -> list[tuple[str, str]]:
    """Of each material, after a look whether both networks agree."""
    found = []
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if not prim.IsA(UsdShade.Material):
            continue
        material = UsdShade.Material(prim)
        preview = material.ComputeSurfaceSource()[0]
        if not preview:  # felt, not seen
            continue
        twin = material.ComputeSurfaceSource("mtlx")[0]
        assert preview.GetShaderId() == "UsdPreviewSurface"
        assert twin.GetShaderId() == "ND_UsdPreviewSurface_surfaceshader"
        for one in preview.GetInputs():
            other = twin.GetInput(one.GetBaseName())
            assert other.Get() == one.Get()
            assert other.HasConnectedSource() == one.HasConnectedSource()
        found.append((str(prim.GetPath()), str(preview.GetInput("diffuseColor").Get())))
    return found


def test_the_copy_is_whole_and_the_house_as_it_was(written: tuple[Path, Path]) -> None:
    source, copy = written
    stage = Usd.Stage.Open(str(copy))
    layers = [Path(one.realPath) for one in stage.GetUsedLayers() if one.realPath]
    assert all(layer.is_relative_to(copy.parent) for layer in layers)
    before = Usd.Stage.Open(str(source))
    assert not list(twins(before))
    assert {prim.GetPath() for prim in before.Traverse()} <= {
        prim.GetPath() for prim in stage.Traverse()
    }
    files = [
        prim.GetAttribute("inputs:file") for prim in map(UsdShade.Shader.GetPrim, twins(stage))
    ]
    named = [one.Get() for one in files if one and isinstance(one.Get(), Sdf.AssetPath)]
    assert named
    assert all(Path(one.resolvedPath).is_file() for one in named)


def test_a_package_is_refused(written: tuple[Path, Path], tmp_path: Path) -> None:
    packed = tmp_path / "house.usdz"
    export_stage(written[0], packed, "web")
    command = ["export", str(packed), "--for", "materialx", "-o", str(tmp_path / "out")]
    assert main(command) == UNUSABLE
