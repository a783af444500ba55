"""The certificate: a sound house passes, and each fault put into it is found and named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from pxr import Usd

from chord_usd.base.errors import StageError
from chord_usd.base.metrics import score_scene
from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Box, Facts, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.cli import DONE, NOT_HELD, main
from chord_usd.line.image.preview_marks import FAULT
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check import check_contact
from chord_usd.line.stage.check.check_contact import Body, Solid, collisions, unsupported
from chord_usd.line.stage.check.check_scene import read_scene
from chord_usd.line.stage.check.check_stage import Report, certificate, check_stage
from chord_usd.line.stage.check.triangles import Triangles

FIXTURES = Path(__file__).parents[1] / "fixtures"


def item(name, category, x, y, size, yaw=0.0, room_id="a", z=0.0, children=()) -> Item:
    return Item(name, category, Box((x, y, z), size, yaw), room_id=room_id, children=children)


LAPTOP = item("laptop", "laptop", 0.1, 0.0, (0.3, 0.25, 0.2), z=0.75)
DESK = item("desk", "table", 0.7, 3.0, (1.4, 0.6, 0.75), yaw=90, children=(LAPTOP,))
BED = item("bed", "bed", 3.0, 5.23, (1.8, 2.0, 0.9))
PANEL = item("panel", "bed_background", 3.0, 6.205, (2.0, 0.07, 1.0), z=1.1)
SHOES = item("shoes", "shoe_cabinet", 3.4, 0.2, (1.0, 0.4, 1.0), yaw=180, room_id="hall")


def house(*items: Item, rooms_apart_m: float = 0.24) -> SceneGraph:
    """A corridor (4 x 2) below a bedroom (4 x 4), a front door, a door between, a window."""
    above = 2 + rooms_apart_m

    def rectangle(y: float, width: float) -> np.ndarray:
        return frozen_array([(0, y), (4, y), (4, y + width), (0, y + width)])

    return SceneGraph(
        rooms=(
            Room("hall", "corridor", rectangle(0, 2)),
            Room("a", "bedroom", rectangle(above, 4)),
        ),
        openings=(
            Opening("front", "door", Box((1, -0.12, 0), (0.9, 0.24, 2.1), 0.0), ("hall",)),
            Opening("inner", "door", Box((1.8, 2.12, 0), (0.8, 0.24, 2.1), 0.0), ("hall", "a")),
            Opening("view", "window", Box((-0.12, 5.2, 0.9), (1.2, 0.24, 1.3), 90.0), ("a",)),
        ),
        items=items,
    )


SOUND = (replace(DESK, box=Box((0.31, 3.2, 0), DESK.box.size_m, 90)), BED, PANEL, SHOES)
BEDROOM = "/House/Rooms/Bedroom_0"


def check(tmp_path: Path, graph: SceneGraph) -> Report:
    return check_stage(author_stage(graph, tmp_path / "house.usda", seed=0).path)


def test_a_sound_house_holds(tmp_path):
    report = check(tmp_path, house(*SOUND))
    assert report.errors == ()
    assert report.holds, certificate(report)
    assert (report.walkable, report.reachable_rooms) == (1.0, 1.0)
    assert report.pairs == 6


def test_the_certificate_has_the_fields_of_the_contract(tmp_path):
    fields = certificate(check(tmp_path, house(*SOUND)))
    assert list(fields) == [
        "holds", "valid", "errors", "collisions", "out_of_room", "blocked_openings", "unsupported",
        "empty_rooms", "walkable", "reachable_rooms", "por", "piou", "pairs", "ood",
        "complete", "right", "missing", "home_lacks", "misplaced", "objects", "dressing", "design",
        "stairs", "unreachable", "opens", "standards", "faults",
    ]  # fmt: skip
    assert fields["holds"] is fields["valid"] is True
    crowded = check(tmp_path, house(*SOUND, replace(BED, id="bed2")))
    (first, *_) = certificate(crowded)["collisions"]
    assert set(first) == {"a", "b", "depth_m"}
    assert certificate(crowded)["holds"] is certificate(crowded)["valid"] is False
    assert any(first["a"] in fault for fault in certificate(crowded)["faults"])


def test_broken_planning_rules_are_told_in_centimetres_with_source_and_place(tmp_path, capsys):
    stage = author_stage(house(*SOUND), tmp_path / "house.usda", seed=0).path
    assert main(["check", str(stage)]) == DONE
    told = capsys.readouterr().out
    assert "Bedroom_0 (bedroom):" in told
    assert "wardrobe: 0, not 1 (HUD 1973), at " in told
    design = certificate(check_stage(stage))["design"]
    room = next(one for one in design["rooms"] if one["path"] == BEDROOM)
    assert 0 < room["rules_kept"] < room["rules"]
    foot = next(one for one in room["findings"] if one["rule"] == "bedside tables of a double bed")
    assert (foot["need"], foot["have"], foot["source"]) == (2, 0, "NDSS")
    assert np.hypot(*np.subtract(foot["at"], BED.box.center_m[:2])) < 0.2
    assert design["home"]["findings"]


def test_out_of_distribution_scores_travel_to_the_report(tmp_path):
    bed, *others = (replace(BED, facts=Facts(ood=0.9)), replace(SHOES, facts=Facts(ood=0.2)), PANEL)
    report = check(tmp_path, house(bed, *others))
    assert [(one.path.rsplit("/", 1)[-1], one.score) for one in report.ood] == [
        ("Bed_0", 0.9),
        ("ShoeCabinet_0", 0.2),
    ]


def test_items_in_one_place_collide(tmp_path):
    wardrobe = item("wardrobe", "cabinet", 3.6, 4.5, (0.6, 0.6, 2.0))
    report = check(tmp_path, house(*SOUND, wardrobe))
    (found,) = report.collisions
    assert {found.a, found.b} == {f"{BEDROOM}/Furniture/Bed_0", f"{BEDROOM}/Furniture/Cabinet_0"}
    assert found.depth_m == pytest.approx(0.57, abs=0.03)
    assert report.por == pytest.approx(1 / 10)
    assert not report.holds


def test_an_item_in_the_wall_collides_with_it_and_is_out_of_room(tmp_path):
    report = check(tmp_path, house(*SOUND, item("c", "cabinet", 3.75, 3.0, (0.6, 0.6, 2.0))))
    assert report.out_of_room == (f"{BEDROOM}/Furniture/Cabinet_0",)
    assert [c.b.startswith(f"{BEDROOM}/Architecture/Geometry/Wall") for c in report.collisions] == [
        True
    ]
    assert report.collisions[0].depth_m == pytest.approx(0.05, abs=0.005)


def test_a_wardrobe_at_the_door_blocks_it_and_shuts_the_room(tmp_path):
    wardrobe = item("c", "cabinet", 1.8, 2.6, (1.2, 0.6, 2.0))
    report = check(tmp_path, house(BED, wardrobe))
    (blocked,) = report.blocked_openings
    assert blocked.endswith("/Geometry/Door_1") or blocked.endswith("/Geometry/Door_0")
    assert report.reachable_rooms == 0.5
    assert [room.shut_by for room in report.unreachable] == ["furniture"]
    assert report.walkable < 1.0
    assert not report.holds


def test_a_room_that_the_plan_gives_no_door_is_no_fault_of_furniture(tmp_path):
    sound = house(*SOUND)
    report = check(tmp_path, replace(sound, openings=sound.openings[:1]))
    (room,) = report.unreachable
    assert room.shut_by == "plan"
    assert not report.holds
    assert [line for line in report.faults if line.startswith(room.path)] == [
        f"{room.path} cannot be reached: the plan gives it no way in"
    ]


@pytest.mark.parametrize("z", [0.05, 1.0])
def test_a_floating_item_is_unsupported(tmp_path, z):
    report = check(tmp_path, house(BED, item("c", "chair", 1.0, 4.0, (0.5, 0.5, 0.9), z=z)))
    assert report.unsupported == (f"{BEDROOM}/Furniture/Chair_0",)


def test_a_laptop_over_the_edge_of_its_desk_is_unsupported(tmp_path):
    over = replace(LAPTOP, box=Box((0.75, 0.0, 0.75), LAPTOP.box.size_m, 0.0))
    desk = replace(SOUND[0], children=(over,))
    report = check(tmp_path, house(desk, BED))
    (found,) = report.unsupported
    assert found.endswith("/Items/Laptop_0")


def test_a_panel_away_from_its_wall_hangs_on_nothing(tmp_path):
    panel = replace(PANEL, box=Box((3.0, 6.1, 1.1), PANEL.box.size_m, 0.0))
    assert check(tmp_path, house(BED, panel)).unsupported == (
        f"{BEDROOM}/Furniture/BedBackground_0",
    )


def test_a_bedroom_without_bedroom_furniture_is_empty(tmp_path):
    assert check(tmp_path, house(SHOES)).empty_rooms == (BEDROOM,)


def test_the_scene_read_back_is_the_scene_that_was_authored(tmp_path):
    from pxr import Usd

    graph = house(*SOUND)
    author_stage(graph, tmp_path / "house.usda", seed=0)
    found = read_scene(Usd.Stage.Open(str(tmp_path / "house.usda"))).graph
    assert [room.kind for room in found.rooms] == ["corridor", "bedroom"]
    for ours, theirs in zip(found.rooms, graph.rooms, strict=True):
        assert room_polygon(ours).symmetric_difference(room_polygon(theirs)).area < 1e-3
    ours = {one.category: one for one in found.items}
    for theirs in graph.items:
        box = ours[theirs.category].box
        np.testing.assert_allclose(box.center_m, theirs.box.center_m, atol=1e-4)
        np.testing.assert_allclose(box.size_m, theirs.box.size_m, atol=1e-4)
        assert abs((box.yaw_deg - theirs.box.yaw_deg + 180) % 360 - 180) < 1e-3
    assert [child.category for child in ours["table"].children] == ["laptop"]
    assert sorted(o.kind for o in found.openings) == ["door", "door", "window"]
    assert score_scene(found).overlap.pairs == score_scene(graph).overlap.pairs


def test_openings_read_back_join_the_rooms_that_they_joined(tmp_path):
    """Rules ask which rooms a door joins, of stages too."""
    path = tmp_path / "house.usda"
    author_stage(house(*SOUND), path)
    read = read_scene(Usd.Stage.Open(str(path))).graph
    rooms = {room.id: room.kind for room in read.rooms}
    joined = sorted(sorted(rooms[room_id] for room_id in one.room_ids) for one in read.openings)
    assert joined == [["bedroom"], ["bedroom", "corridor"], ["corridor"]]


def test_findings_are_drawn_where_they_are(tmp_path):
    """Each has its disk on the plan, in the colour of a fault where the certificate breaks."""
    path, before, after = (tmp_path / name for name in ("h.usda", "b.png", "a.png"))
    author_stage(house(*SOUND, item("other", "table", 0.31, 3.2, (1.4, 0.6, 0.75), yaw=90)), path)
    assert main(["describe", str(path), "--preview", str(before)]) == DONE
    assert main(["check", str(path), "--preview", str(after)]) == NOT_HELD
    plain, marked = (np.asarray(Image.open(one)) for one in (before, after))
    on_plan = marked[: plain.shape[0], : plain.shape[1]]
    changed = (plain != on_plan).any(axis=-1)
    assert (on_plan[changed] == FAULT).all(axis=-1).sum() > 100
    x_px = np.nonzero((on_plan == FAULT).all(axis=-1))[1].mean()
    assert x_px < 0.4 * plain.shape[1], "the desks stand at the left"


def test_a_stage_without_rooms_does_not_hold():
    report = check_stage(FIXTURES / "plain_stage.usda")
    assert [finding.rule for finding in report.errors] == ["CHORD015"]
    assert not report.holds


def test_what_is_no_stage_is_named(tmp_path):
    with pytest.raises(StageError, match="there is no such file"):
        check_stage(tmp_path / "none.usda")
    (tmp_path / "text.usda").write_text("hello")
    with pytest.raises(StageError, match="cannot be opened as a stage"):
        check_stage(tmp_path / "text.usda")


# --- contact, on meshes of known shape ----------------------------------------------------------


def body(name: str, *meshes: trimesh.Trimesh, parent: str = "") -> Body:
    triangles = [Triangles(np.array(mesh.vertices), np.array(mesh.faces)) for mesh in meshes]
    return Body(name, tuple(Solid(f"{name}/{k}", m) for k, m in enumerate(triangles)), parent)


def box(size, at) -> trimesh.Trimesh:
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(at)
    return mesh


def sheet(x: float) -> trimesh.Trimesh:
    return trimesh.Trimesh([[x, -5, -5], [x, 5, -5], [x, 5, 5], [x, -5, 5]], [[0, 1, 2], [0, 2, 3]])


FLOOR = body(
    "floor",
    trimesh.Trimesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]]),
)


@pytest.mark.parametrize("depth_m", [-0.01, 0.0, 0.004, 0.006, 0.05, 0.4])
def test_depth_of_boxes_is_exact(depth_m):
    pair = [body("a", box((1, 1, 1), (0, 0, 0))), body("b", box((1, 1, 1), (1 - depth_m, 0.1, 0)))]
    found = collisions(pair, [])
    assert [c.depth_m for c in found] == (
        [pytest.approx(depth_m, abs=1e-4)] if depth_m > 0.005 else []
    )


@pytest.mark.parametrize("depth_m", [-0.01, 0.0, 0.004, 0.01, 0.1])
def test_a_ring_against_a_wall_collides_only_when_deep(depth_m):
    """A torus is not convex: the depth between triangles is checked by stepping back."""
    ring = body("ring", trimesh.creation.torus(0.4, 0.1))
    found = collisions([ring], [body("wall", sheet(0.5 - depth_m))])
    assert bool(found) == (depth_m > 0.005)


def test_a_hole_in_a_wall_is_a_hole():
    """A board reaches through a window's hole in a flat sheet without touching it."""
    outer, inner = 3.0, 0.5
    ring = [(-outer, -outer), (outer, -outer), (outer, outer), (-outer, outer)]
    hole = [(-inner, -inner), (inner, -inner), (inner, inner), (-inner, inner)]
    points = [(0.0, *corner) for corner in (*ring, *hole)]
    faces = [
        f
        for k in range(4)
        for f in ((k, (k + 1) % 4, 4 + k), ((k + 1) % 4, 4 + (k + 1) % 4, 4 + k))
    ]
    wall = body("wall", trimesh.Trimesh(points, faces))
    assert collisions([body("board", box((1, 0.5, 0.5), (0, 0, 0)))], [wall]) == []
    assert collisions([body("board", box((1, 1.5, 0.5), (0, 0, 0)))], [wall]) != []


def test_support_wants_contact_below_the_centroid():
    top = box((1, 0.6, 0.03), (0, 0, 0.735))
    legs = [box((0.05, 0.05, 0.72), (x, y, 0.36)) for x in (-0.45, 0.45) for y in (-0.25, 0.25)]
    table = body("table", top, *legs)
    cases = {
        "on": (0.3, 0.755), "over": (0.53, 0.755), "above": (0.0, 0.78), "sunk": (0.0, 0.748),
        "deep": (0.0, 0.72),
    }  # fmt: skip
    things = [
        body(name, box((0.3, 0.2, 0.01), (x, 0, z)), parent="table")
        for name, (x, z) in cases.items()
    ]
    assert unsupported([table, *things], [FLOOR], lambda _: False) == ["over", "above", "deep"]
    assert unsupported([table], [], lambda _: False) == ["table"]
    assert unsupported([table], [], lambda _: True) == []


@pytest.mark.parametrize(("over_m", "stands"), [(1.5e-5, True), (0.26, False)])
def test_what_is_flush_with_a_wall_stands_on_all_of_its_feet(over_m, stands):
    """The floor's corners are rounded, so feet on its edge may lie a hair beside it."""
    at = 0.25 - 5 - over_m
    shower = body("shower", box((0.5, 0.5, 1.0), (at, at, 0.5)))
    assert (unsupported([shower], [FLOOR], lambda _: False) == []) == stands


def test_a_wide_piece_may_stand_on_a_narrow_one():
    """None of the plate's corners is over the post; the post's are under the plate."""
    post, plate = (
        body("post", box((0.1, 0.1, 1), (0, 0, 0.5))),
        body("plate", box((1, 1, 0.1), (0, 0, 1.05))),
    )
    assert unsupported([post, plate], [FLOOR], lambda _: False) == []


@pytest.mark.parametrize(("bars_m", "stands"), [((-0.06, 0.06), True), ((0.04, 0.09), False)])
def test_a_pot_may_stand_on_bars_that_cross_below_it(bars_m, stands):
    """No corner of either lies over the other."""
    bars = [box((1.0, 0.02, 0.4), (0, y, 0.2)) for y in bars_m]
    grate = body("grate", *bars, box((0.02, 0.6, 0.4), (0.5, 0, 0.2)))
    pot = body(
        "pot", trimesh.creation.box((0.3, 0.3, 0.2), np.eye(4)).apply_translation((0, 0, 0.5))
    )
    assert (unsupported([grate, pot], [FLOOR], lambda _: False) == []) == stands


def test_what_is_left_out_early_touches_nothing(monkeypatch):
    """Triangles out of reach and meshes apart: contact is that of all triangles and meshes."""
    rng = np.random.default_rng(0)
    flat = rng.uniform(-1.0, 1.0, (300, 3, 3)) * [1.0, 1.0, 0.005]
    flat[::3, 2] = flat[::3, 0] + rng.normal(0.0, 1e-3, (100, 3))  # slivers
    feet = rng.uniform(-1.0, 1.0, (40, 6, 3)) * [0.1, 0.1, 0.0] + rng.uniform(-1, 1, (40, 1, 3))
    feet[..., 2] = 0.0
    balls = [
        body(f"ball {k}", trimesh.creation.torus(0.3, 0.1, 12, 8).apply_translation(at))
        for k, at in enumerate(rng.uniform(0.0, 1.2, (12, 3)))
    ]

    def contact():
        return [check_contact._touch(foot, flat).tolist() for foot in feet], collisions(balls, [])

    found = contact()
    monkeypatch.setattr(check_contact, "_within_reach", lambda points, faces: slice(None))
    monkeypatch.setattr(check_contact, "_apart", lambda a, b: False)
    assert found == contact()
    assert any(map(any, found[0]))
    assert found[1]


def test_a_toilet_hangs_on_its_wall_and_nowhere_else(tmp_path):
    toilet = item("toilet", "toilet", 2.0, 1.65, (0.4, 0.7, 0.4), room_id="hall", z=0.1)
    assert check(tmp_path, house(BED, toilet)).unsupported == ()
    away = replace(toilet, box=replace(toilet.box, center_m=(2.0, 1.5, 0.1)))
    assert check(tmp_path, house(BED, away)).unsupported != ()


def test_a_stage_whose_certificate_does_not_hold_is_written_and_reported_first(tmp_path, capsys):
    scene, stage = tmp_path / "scene.json", tmp_path / "house.usda"
    write_scene(house(*SOUND, item("wardrobe", "cabinet", 3.6, 4.5, (0.6, 0.6, 2.0))), scene)
    words = ["stage", str(scene), "-o", str(stage), "--no-arrange", "--progress", "none"]
    assert main(words) == NOT_HELD
    first, *_ = capsys.readouterr().out.splitlines()
    assert first.startswith("certificate does not hold: ")
    assert "Cabinet_0" in first
    assert not check_stage(stage).holds
    assert main([*words, "--no-check"]) == DONE
    assert main(["check", str(stage), "--progress", "none"]) == NOT_HELD
