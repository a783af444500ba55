"""Vector files of other programs are read exactly, or refused in one sentence."""

from __future__ import annotations

import zipfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from plan_files import (
    HOME,
    write_cubicasa,
    write_dxf,
    write_ifc,
    write_single_lines,
    write_sweethome,
)

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon, wall_area
from chord_usd.base.scene.types import Plan
from chord_usd.line.pipeline.as_drawn import placed_pieces
from chord_usd.line.plan.read import read_plan_file
from chord_usd.workshop.data.houses import random_plan

PLAN = random_plan(np.random.default_rng(5), rooms=5)


def assert_same(plan: Plan, wanted: Plan, *, kinds: bool = True) -> None:
    """Rooms and openings alike to a centimetre, wherever the house lies."""
    shift = corner(wanted) - corner(plan)
    for room in wanted.rooms:
        floor = room_polygon(room)
        best = max(plan.rooms, key=lambda r: floor.intersection(moved(r.polygon_m, shift)).area)
        found = moved(best.polygon_m, shift)
        assert floor.symmetric_difference(found).area < 0.01 * floor.length
        assert not kinds or best.kind == room.kind
    assert len(plan.rooms) == len(wanted.rooms)
    assert Counter(o.kind for o in plan.openings) == Counter(o.kind for o in wanted.openings)
    for opening in wanted.openings:
        hole = footprint_polygon(opening.box)
        overlap = max(
            hole.intersection(moved(np.array(footprint_polygon(o.box).exterior.coords), shift)).area
            for o in plan.openings
            if o.kind == opening.kind
        )
        assert overlap > 0.85 * hole.area
        assert len(opening.room_ids) in {len(o.room_ids) for o in plan.openings}


def corner(plan: Plan) -> np.ndarray:
    return np.concatenate([room.polygon_m for room in plan.rooms]).min(axis=0)


def moved(points: np.ndarray, shift: np.ndarray):  # type: ignore[no-untyped-def]
    from shapely.geometry import Polygon

    return Polygon(points + shift).buffer(0)


def without_touching(plan: Plan) -> bool:
    """Whether no two rooms run into each other."""
    floor = [room_polygon(room).buffer(0.01) for room in plan.rooms]
    return not any(a.intersects(b) for i, a in enumerate(floor) for b in floor[:i])


def test_cubicasa_is_read_exactly_but_for_its_scale(tmp_path: Path) -> None:
    write_cubicasa(PLAN, tmp_path / "model.svg", px_per_m=50.0)
    plan = read_plan_file(tmp_path / "model.svg", scale=1 / 50.0)
    assert_same(plan, PLAN)
    guessed = read_plan_file(tmp_path / "model.svg")
    assert guessed.extra["scale"]["witness"] == "doors"
    assert guessed.extra["scale"]["mPerPx"] == pytest.approx(1 / 50.0, rel=0.15)


@pytest.mark.parametrize(("units", "per_m"), [(4, 1000.0), (5, 100.0), (6, 1.0), (0, 1000.0)])
def test_dxf_is_read_in_its_own_units(units: int, per_m: float, tmp_path: Path) -> None:
    seed = next(
        s for s in range(40) if without_touching(random_plan(np.random.default_rng(s), rooms=5))
    )
    wanted = random_plan(np.random.default_rng(seed), rooms=5)
    write_dxf(wanted, tmp_path / "plan.dxf", units, per_m)
    plan = read_plan_file(tmp_path / "plan.dxf")
    assert plan.extra["scale"]["witness"] == "file"
    assert len(plan.rooms) == len(wanted.rooms)
    areas = [np.sort([room_polygon(r).area for r in p.rooms]) for p in (plan, wanted)]
    np.testing.assert_allclose(*areas, rtol=0.02)
    assert Counter(r.kind for r in plan.rooms) == Counter(r.kind for r in wanted.rooms)
    doors = [sum(o.kind != "window" for o in p.openings) for p in (plan, wanted)]
    assert doors[0] == doors[1]


def assert_two_rooms(plan: Plan, areas: list[float], kinds: list[str]) -> None:
    by_area = sorted(plan.rooms, key=lambda room: room_polygon(room).area)
    np.testing.assert_allclose([room_polygon(r).area for r in by_area], areas, rtol=1e-3)
    assert [room.kind for room in by_area] == kinds
    assert Counter(o.kind for o in plan.openings) == {"door": 2, "window": 1}
    inner = [o for o in plan.openings if len(o.room_ids) == 2]
    assert len(inner) == 1
    assert inner[0].box.size_m[0] == pytest.approx(0.9, abs=1e-3)


@pytest.mark.parametrize("unit", ["MILLIMETRE", "METRE"])
def test_ifc_is_read_in_metres(unit: str, tmp_path: Path) -> None:
    write_ifc(tmp_path / "house.ifc", unit=unit)
    plan = read_plan_file(tmp_path / "house.ifc")
    assert_two_rooms(plan, [12.0, 20.0], ["kitchen", "living"])
    window = next(o for o in plan.openings if o.kind == "window")
    assert window.box.center_m[2] == pytest.approx(0.9)
    assert window.box.size_m == pytest.approx((1.5, 0.2, 1.2), abs=1e-3)


def test_ifc_takes_the_storey_with_rooms_and_doors_and_not_the_roof(tmp_path: Path) -> None:
    write_ifc(tmp_path / "house.ifc", roof=True)
    plan = read_plan_file(tmp_path / "house.ifc")
    assert_two_rooms(plan, [12.0, 20.0], ["kitchen", "living"])
    assert "number 1 by rooms with doors (Ground) was taken" in plan.extra["warnings"][0]


def test_dxf_walls_may_be_single_lines(tmp_path: Path) -> None:
    write_single_lines(tmp_path / "plan.dxf")
    plan = read_plan_file(tmp_path / "plan.dxf")
    areas = sorted(room_polygon(room).area for room in plan.rooms)
    np.testing.assert_allclose(areas, [2.9 * 3.9, 4.9 * 3.9], rtol=1e-3)
    (door,) = plan.openings
    assert (door.kind, len(door.room_ids)) == ("door", 2)
    assert "single lines" in plan.extra["warnings"][0]


def test_dxf_hatches_have_holes_and_leaves_that_meet_are_one_door(tmp_path: Path) -> None:
    import ezdxf

    document = ezdxf.new()
    document.header["$INSUNITS"] = 6
    space = document.modelspace()
    # Two rooms of 4 by 4 m in one hatch, a double door between them, a passage to the outside.
    walls = space.add_hatch(dxfattribs={"layer": "WALLS"})
    rings = [(0, 0, 8.6, 4.4), (0.2, 0.2, 4.2, 4.2), (4.4, 0.2, 8.4, 4.2)]
    for west, south, east, north in rings:
        walls.paths.add_polyline_path([(west, south), (east, south), (east, north), (west, north)])
    for y, shut, turned in ((1.2, 90, 180), (3.0, 180, 270)):
        space.add_arc((4.3, y), 0.9, shut, turned, dxfattribs={"layer": "DOORS"})
    corners = [(1.0, 0.0), (2.1, 0.0), (2.1, 0.2), (1.0, 0.2)]
    drawn = {"layer": "PASSAGES", "elevation": 0.0, "thickness": 2.2}
    space.add_lwpolyline(corners, close=True, dxfattribs=drawn)
    document.saveas(tmp_path / "plan.dxf")
    plan = read_plan_file(tmp_path / "plan.dxf")
    np.testing.assert_allclose([room_polygon(room).area for room in plan.rooms], [16.0, 16.0])
    found = {opening.kind: opening.box for opening in plan.openings}
    assert len(plan.openings) == 2
    assert found["door"].size_m[:2] == pytest.approx((1.8, 0.2), abs=1e-3)
    assert found["passage"].size_m == pytest.approx((1.1, 0.2, 2.2), abs=1e-3)


def test_ifc_without_spaces_has_the_rooms_that_its_walls_enclose(tmp_path: Path) -> None:
    write_ifc(tmp_path / "house.ifc", spaces=False)
    assert_two_rooms(read_plan_file(tmp_path / "house.ifc"), [12.0, 20.0], ["unknown"] * 2)


def test_sweet_home_is_read_in_centimetres(tmp_path: Path) -> None:
    write_sweethome(tmp_path / "home.sh3d")
    plan = read_plan_file(tmp_path / "home.sh3d")
    # Rooms drawn to the middle of their walls end at the walls' faces.
    assert_two_rooms(plan, [2.35 * 3.8, 3.35 * 3.8], ["bedroom", "living"])
    window = next(o for o in plan.openings if o.kind == "window")
    assert window.box.center_m[2] == pytest.approx(0.8)
    bare = tmp_path / "bare.sh3d"
    write_sweethome(bare, rooms="")
    assert_two_rooms(read_plan_file(bare), [2.35 * 3.8, 3.35 * 3.8], ["unknown"] * 2)


def test_furniture_of_sweet_home_comes_along(tmp_path: Path) -> None:
    """A double bed with its head at the right wall, an unknown thing, and a lamp on the ceiling."""
    pieces = """<pieceOfFurniture level='ground' catalogId='eTeks#bed140x190' name='Double bed'
      x='485' y='322' width='140' depth='190' height='70' angle='1.5707964'/>
      <pieceOfFurniture level='ground' name='Kugel' x='100' y='100' width='50' depth='50'/>
      <pieceOfFurniture level='ground' name='Cupboard' x='100' y='100' width='50' depth='50'
      elevation='150'/>"""
    write_sweethome(tmp_path / "home.sh3d", HOME.replace("</home>", f"{pieces}</home>"))
    plan = read_plan_file(tmp_path / "home.sh3d")
    (bed,) = placed_pieces(plan)
    assert bed.item is not None
    assert bed.item.room_id == "bedroom1"
    assert bed.item.box.yaw_deg == pytest.approx(-90.0, abs=0.1)
    assert bed.item.box.center_m[:2] == pytest.approx((5.9 - 0.95, -3.2), abs=0.01)


def test_several_storeys_take_the_largest_and_say_so(tmp_path: Path) -> None:
    upper = HOME.replace("{rooms}", "").replace("'ground'", "'upper'").replace("600", "500")
    walls = upper[upper.index("<wall") : upper.index("</home>")]
    write_sweethome(tmp_path / "home.sh3d", HOME.replace("</home>", f"{walls}</home>"))
    plan = read_plan_file(tmp_path / "home.sh3d")
    assert "2 storeys" in plan.extra["warnings"][0]
    smaller = read_plan_file(tmp_path / "home.sh3d", part=2)
    assert area(smaller) < area(plan)
    with pytest.raises(PlanError, match="part 3 was asked for, but the file holds 2 storeys"):
        read_plan_file(tmp_path / "home.sh3d", part=3)
    write_sweethome(tmp_path / "one.sh3d")
    with pytest.raises(PlanError, match=r"part 2 was .* holds one storey .* expected no part"):
        read_plan_file(tmp_path / "one.sh3d", part=2)


def test_a_home_of_niches_is_refused_with_the_reason(tmp_path: Path) -> None:
    niche = "<room level='ground' name='Niche'>" + "".join(
        f"<point x='{x}' y='{y}'/>" for x, y in ((0, 0), (120, 0), (120, 110), (0, 110))
    )
    write_sweethome(tmp_path / "home.sh3d", rooms=niche + "</room>")
    with pytest.raises(PlanError, match=r"one closed room of 1\.\d+ m² .* niches") as caught:
        read_plan_file(tmp_path / "home.sh3d")
    assert "\n" not in str(caught.value)


def area(plan: Plan) -> float:
    return sum(room_polygon(room).area for room in plan.rooms)


def test_plain_svg_of_lines_and_rectangles(tmp_path: Path) -> None:
    (tmp_path / "plain.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="7m" height="5m" viewBox="0 0 700 500">'
        '<g id="walls" style="fill: none; stroke-width:20" transform="translate(50,50)">'
        '<path d="M0 0 H600 V400 H0 Z"/><line x1="350" y1="0" x2="350" y2="400"/></g>'
        '<rect id="door-1" x="390" y="200" width="20" height="90"/>'
        '<rect id="door-2" x="100" y="440" width="90" height="20"/>'
        '<rect id="window-1" x="460" y="40" width="120" height="20"/>'
        '<text x="200" y="200">Living <tspan>room</tspan></text><text x="500" y="200">Bad</text>'
        "</svg>"
    )
    plan = read_plan_file(tmp_path / "plain.svg")
    assert_two_rooms(plan, [2.3 * 3.8, 3.3 * 3.8], ["bathroom", "living"])


# Bad input ---------------------------------------------------------------------------------------

ENTITIES = '<!DOCTYPE s [<!ENTITY a SYSTEM "file:///etc/passwd">]><svg><text>&a;</text></svg>'
BOMB = "<svg>" + "<g>" * 5000 + "</g>" * 5000 + "</svg>"

BAD: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "outside entity": (".svg", lambda p: p.write_text(ENTITIES), "declares XML entities"),
    "hidden entity": (".svg", lambda p: p.write_bytes(ENTITIES.encode("utf-16")), "not text in"),
    "deep": (".svg", lambda p: p.write_text(BOMB), "nested too deeply"),
    "huge": (".svg", lambda p: p.write_bytes(b"<svg>" + b" " * 2**26), "larger than 64 MiB"),
    "cut": (".svg", lambda p: p.write_text("<svg><g>"), "is damaged"),
    "empty": (".svg", lambda p: p.write_text(""), "is empty"),
    "html": (".svg", lambda p: p.write_text("<html/>"), "is not an SVG"),
    "nothing": (".svg", lambda p: p.write_text("<svg/>"), "neither walls nor rooms"),
    "no zip": (".sh3d", lambda p: p.write_text("home"), "is damaged"),
    "old": (".sh3d", lambda p: zipped(p, "Home", b"x"), "holds no Home.xml"),
    "zip bomb": (".sh3d", lambda p: zipped(p, "Home.xml", b" " * 2**27), "zip bomb"),
    "no dxf": (".dxf", lambda p: p.write_text("plan"), "is not a DXF drawing"),
    "binary dxf": (".dxf", lambda p: p.write_bytes(bytes(range(256)) * 9), "is not a DXF"),
    "no ifc": (".ifc", lambda p: p.write_text("plan"), "is not an IFC file"),
    "cut ifc": (".ifc", lambda p: p.write_text("ISO-10303-21;\nHEADER;"), "IFC"),
    "missing": (".dxf", lambda p: None, "no such file"),
    "no pdf": (".pdf", lambda p: p.write_text("plan"), "is not a PDF"),
    "folder": (".ifc", lambda p: p.mkdir(), "is a folder"),
}


def zipped(path: Path, name: str, data: bytes) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, data)


@pytest.mark.parametrize("name", BAD)
def test_bad_vector_files_get_one_clear_sentence(name: str, tmp_path: Path) -> None:
    suffix, make, message = BAD[name]
    path = tmp_path / f"plan{suffix}"
    make(path)
    with pytest.raises(PlanError, match=message) as caught:
        read_plan_file(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_walls_alone_make_rooms(tmp_path: Path) -> None:
    write_cubicasa(Plan((), ()), tmp_path / "empty.svg")
    assert polygons_of(wall_area(())) == []
    with pytest.raises(PlanError, match="neither walls nor rooms"):
        read_plan_file(tmp_path / "empty.svg")


# PDF ---------------------------------------------------------------------------------------------


def write_pdf(path: Path, *texts: tuple[float, float, str], scale: int = 100) -> float:
    """A page with the plan's walls and openings drawn at 1:scale, and texts at places in metres.

    Returns the plan's floor area.
    """
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    inch = 1 / 0.0254 / scale
    figure = Figure(figsize=(11.69, 8.27))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-1, 11.69 / inch - 1), ylim=(-1, 8.27 / inch - 1))
    axes.axis("off")
    walls = wall_area(PLAN.rooms)
    low = corner(PLAN)
    for opening in PLAN.openings:
        walls = walls.difference(footprint_polygon(opening.box).buffer(1e-6))
        hole = np.array(footprint_polygon(opening.box).exterior.coords) - low
        if opening.kind != "passage":
            axes.plot(*hole.T, color="black", linewidth=0.5)
    for wall in polygons_of(walls):
        axes.fill(*(np.array(wall.exterior.coords) - low).T, color="black")
        for ring in wall.interiors:
            axes.fill(*(np.array(ring.coords) - low).T, color="white")
    for x, y, text in texts:
        axes.text(x, y, text, fontsize=7, ha="center")
    with PdfPages(path) as pages:
        pages.savefig(figure)
    return area(PLAN)


def test_a_pdf_page_is_read_at_its_stated_scale(tmp_path: Path) -> None:
    middles = [np.array(room_polygon(r).representative_point().coords[0]) for r in PLAN.rooms]
    names = [(*(m - corner(PLAN)), r.kind) for m, r in zip(middles, PLAN.rooms, strict=True)]
    floor_m2 = write_pdf(tmp_path / "plan.pdf", *names, (5, 15, "Ground floor 1:100"))
    plan = read_plan_file(tmp_path / "plan.pdf")
    assert plan.extra["scale"]["witness"] == "stated scale"
    assert area(plan) == pytest.approx(floor_m2, rel=0.03)
    assert "unknown" not in {room.kind for room in plan.rooms}


def test_a_password_is_told(tmp_path: Path) -> None:
    # An encryption dictionary without the password to it.
    (tmp_path / "plan.pdf").write_bytes(
        b"%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n"
        b"2 0 obj<</Type/Pages/Kids[]/Count 0>>endobj\n"
        b"3 0 obj<</Filter/Standard/V 1/R 2/O<" + b"41" * 32 + b">/U<" + b"42" * 32 + b">/P -4>>"
        b"endobj\ntrailer<</Root 1 0 R/Encrypt 3 0 R/ID[<41><41>]/Size 4>>\n%%EOF"
    )
    with pytest.raises(PlanError, match="protected by a password"):
        read_plan_file(tmp_path / "plan.pdf")


def test_the_overlay_of_a_vector_file_shows_its_walls(tmp_path: Path) -> None:
    from chord_usd.line.plan.overlay import overlay_on

    write_sweethome(tmp_path / "home.sh3d")
    picture = overlay_on(read_plan_file(tmp_path / "home.sh3d"), tmp_path / "home.sh3d")
    assert picture.shape[2] == 3
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 4
