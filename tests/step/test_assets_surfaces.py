"""Maps of finishes: seamless, true to the finish's colour and to metres, shared by content."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdShade

from chord_usd.base.errors import AssetError
from chord_usd.library.catalogue import designs
from chord_usd.library.component import write_component
from chord_usd.library.kit.model import Design
from chord_usd.library.kit.shading import corner_uvs_m
from chord_usd.library.kit.solids import block, cylinder
from chord_usd.library.surfaces.drawn import DrawnFinishes
from chord_usd.library.surfaces.finishes import FINISHES, PLAIN
from chord_usd.library.surfaces.surface_maps import (
    MAPS_FOLDER,
    SURFACES,
    colour_map,
    has_maps,
    map_files,
    pattern_of,
)
from chord_usd.library.textures.fields import normal_map
from chord_usd.line.stage.export.packages import Packages
from tests.design_forms import forms
from tests.every import for_every

PX = 256
DRAWN = {name: finish for name, finish in FINISHES.items() if has_maps(finish)}


@for_every("surface", sorted(SURFACES))
def test_tiles_meet_at_their_edges(surface: str) -> None:
    """Over the edge, neighbours differ no more than they do within the tile."""
    pattern = pattern_of(surface, PX)
    normals = normal_map(pattern.height_m, pattern.ground.tile_m)
    for field in (pattern.depth, pattern.roughness, normals[..., 0], normals[..., 1]):
        for axis in (0, 1):
            steps = np.abs(np.diff(field, axis=axis)).mean(axis=1 - axis)
            over = np.abs(np.take(field, 0, axis) - np.take(field, -1, axis)).mean()
            assert over <= steps.max() * 1.5 + 1e-9


@for_every("name", sorted(DRAWN))
def test_colours_keep_to_their_finish_and_yet_vary(name: str) -> None:
    rgb = colour_map(DRAWN[name], PX)
    assert np.abs(rgb.mean(axis=(0, 1)) - DRAWN[name].rgb).max() < 4.0
    assert 0.8 < rgb.mean(axis=2).std() < 30.0


def test_texture_coordinates_are_metres_along_the_grain() -> None:
    for size_m, axis in (((1.2, 0.3, 0.02), 0), ((0.3, 1.2, 0.02), 1), ((0.05, 0.05, 0.7), 2)):
        solid = block(size_m)
        uvs = corner_uvs_m(solid, "Board")
        corners = solid.points_m[solid.faces].reshape(-1, 3)
        edges = corners[1::3] - corners[::3]
        along = np.abs(edges[:, axis]) > 0.9 * size_m[axis]
        drawn_m = np.abs(uvs[1::3] - uvs[::3])[along]
        assert along.any()
        assert np.allclose(drawn_m[:, 0], size_m[axis], atol=0.01)


def test_a_slanting_leg_has_its_grain_along_it_and_boards_do_not_repeat() -> None:
    leg = cylinder(0.02, 0.7).turned("y", 15.0)
    assert np.ptp(corner_uvs_m(leg, "Leg")[:, 0]) == pytest.approx(0.7, abs=0.03)
    board = block((1.0, 0.2, 0.02))
    both = corner_uvs_m(board + board.moved(y=0.3), "Boards").reshape(2, -1, 2)
    assert not np.allclose(both[0], both[1], atol=0.01)
    assert np.array_equal(corner_uvs_m(board, "Boards"), corner_uvs_m(board, "Boards"))


def test_finishes_share_files_by_content(tmp_path: Path) -> None:
    oak, walnut = (map_files(FINISHES[n], tmp_path / "one", PX) for n in ("oak", "walnut"))
    assert oak.colour != walnut.colour
    assert (oak.roughness, oak.normal) == (walnut.roughness, walnut.normal)
    assert len(list((tmp_path / "one").iterdir())) == 4
    assert map_files(FINISHES["oak"], tmp_path / "two", PX) == oak
    for name in (oak.colour, oak.normal):
        same = [(tmp_path / folder / name).read_bytes() for folder in ("one", "two")]
        assert same[0] == same[1]


def surfaces(design: Design, looks: Mapping[str, str]) -> set[str]:
    """What a colourway is made of; it may name finishes for slots that this form has not."""
    found = set()
    for name in looks.values():
        with contextlib.suppress(KeyError):
            found.add(design.finishes[name].surface)
    return found - {"plain"}


def test_every_design_that_is_not_plain_throughout_wears_maps(tmp_path: Path) -> None:
    """Of each family of surfaces a design is written; its textures are there, sRGB or raw."""
    seen: set[str] = set()
    for design, *_ in forms(designs()):
        looks = next(iter(design.colourways.values()))
        kinds = surfaces(design, looks)
        if kinds <= seen:
            continue
        seen |= kinds
        stage = Usd.Stage.Open(str(write_component(design, tmp_path)))
        shaders = [UsdShade.Shader(prim) for prim in stage.Traverse()]
        files = [s.GetInput("file").Get() for s in shaders if s.GetInput("file")]
        assert files
        assert all(Path(file.resolvedPath).is_file() for file in files), design.id
    assert len(seen) >= 8


def even_finishes(design: Design) -> set[str]:
    """Names of the finishes of all its colourways that have neither maps nor a picture."""
    finishes = design.finishes
    pictures = finishes.drawn if isinstance(finishes, DrawnFinishes) else {}
    names = {name for looks in design.colourways.values() for name in looks.values()}
    return {name for name in names - set(pictures) if finishes[name].surface == "plain"}


def test_whatever_is_not_even_by_nature_has_maps() -> None:
    found = set[str]().union(*(even_finishes(design) for design in designs()))
    assert found == {name for names in PLAIN.values() for name in names}


def package(folder: Path, picture: str) -> Path:
    """An asset whose layer names a picture."""
    folder.mkdir(parents=True)
    layer = Sdf.Layer.CreateNew(str(folder / "Block.usda"))
    prim = Sdf.CreatePrimInLayer(layer, "/Block")
    prim.specifier = Sdf.SpecifierDef
    layer.defaultPrim = "Block"
    file = Sdf.AttributeSpec(prim, "inputs:file", Sdf.ValueTypeNames.Asset)
    file.default = Sdf.AssetPath(picture)
    layer.Save()
    return folder / "Block.usda"


def test_only_pictures_in_the_shared_folder_are_taken(tmp_path: Path) -> None:
    database, victim = tmp_path / "database", tmp_path / "victim"
    for folder in (database / MAPS_FOLDER, victim):
        folder.mkdir(parents=True)
        (folder / "a.jpg").write_bytes(b"a")
    (database / MAPS_FOLDER / "key.pem").write_bytes(b"secret")
    (database / MAPS_FOLDER / "link.jpg").symlink_to(victim / "a.jpg")
    (database / "Other").mkdir()
    (database / "Other" / "a.jpg").write_bytes(b"a")
    good = package(database / "Good", f"../{MAPS_FOLDER}/a.jpg")
    packages = Packages(tmp_path / "out", [tmp_path / "out"], "assets")
    assert packages.add(good) == "./assets/Good/Block.usda"
    taken = [one.name for one in (tmp_path / "out/assets" / MAPS_FOLDER).iterdir()]
    assert taken == ["a.jpg"]
    for number, name in enumerate(("Finishes/key.pem", "Finishes/link.jpg", "Other/a.jpg")):
        with pytest.raises(AssetError, match="points to"):
            packages.add(package(database / f"Bad{number}", f"../{name}"))
    linked = tmp_path / "linked"
    linked.mkdir()
    (linked / MAPS_FOLDER).symlink_to(victim)
    with pytest.raises(AssetError, match="points to"):
        packages.add(package(linked / "Bad", f"../{MAPS_FOLDER}/a.jpg"))


def test_pictures_of_one_name_are_one_picture(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name / MAPS_FOLDER).mkdir(parents=True)
        (tmp_path / name / MAPS_FOLDER / "a.jpg").write_text(name)
    packages = Packages(tmp_path / "out", [tmp_path / "out"], "assets")
    packages.add(package(tmp_path / "one" / "Block", f"../{MAPS_FOLDER}/a.jpg"))
    with pytest.raises(AssetError, match="another file is there"):
        packages.add(package(tmp_path / "two" / "Chair", f"../{MAPS_FOLDER}/a.jpg"))
