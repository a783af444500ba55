"""Layouts of others by the table: what their format leaves out is never passed in silence."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design import ROOM_RULES, design_of
from chord_usd.base.metrics.design.unsaid import UNSAID, Fact, read_by, unsaid_of
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.metrics.rooms import out_of_room
from chord_usd.base.runtime.yaml_text import parse_yaml
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.workshop.data.foreign import Models, foreign_houses
from chord_usd.workshop.data.tdw import category_of
from chord_usd.workshop.evaluation.scenes import judge_scene, judged_sets

KITCHEN = """
room:
  walls:
    - {name: wall, type: wall, size: [2.0, 1.5, 0.02], pos: [2.0, 0, 1.5]}
    - {name: wall_left, type: wall, wall_side: left, size: [1.5, 1.5, 0.02], pos: [0, -1.5, 1.5]}
  floor:
    - {name: floor, type: floor, size: [2.0, 1.5, 0.02], pos: [2.0, -1.5, 0]}
    - {name: floor_backing, type: floor, backing: true, size: [2.0, 1.5, 0.1], pos: [2.0, -1.5, 0]}
  wall_accessories:
    - {name: window, type: window, attach_to: wall, size: [1.2, 0.03, 0.9], pos: [1.0, null, 1.8]}
main_group:
  bottom_row:
    - {name: sink, type: sink}
    - name: counter
      type: counter
      interior_obj: sink
      size: [2.0, 0.65, 0.92]
      pos: [1.0, -0.325, 0.46]
      obj_x_percent: 0.5
    - {name: stove, type: stove, size: [null, 0.66, null], align_to: counter, side: right,
       alignment: top_back}
left_group:
  group_origin: [0, 0]
  group_pos: [0, -2.9]
  group_z_rot: 1.5707963
  bottom_row:
    - {name: fridge, type: fridge_french_door}
    - {name: housing, type: housing_cabinet, size: [0.95, 0.8, 1.9], pos: [0.6, -0.4, 0.95],
       padding: [null, null, [0, null]], interior_obj: fridge}
"""


def kitchen(folder: Path, text: str = KITCHEN) -> SceneGraph:
    path = folder / "layout001.yaml"
    path.write_text(text)
    (found,) = foreign_houses(path, Models())
    assert found.house is not None, found.why
    return found.house


def test_a_kitchen_of_robocasa_stands_where_its_groups_put_it(tmp_path: Path) -> None:
    house = kitchen(tmp_path)
    assert out_of_room(house) == []
    pieces = {item.category: item.box for item in house.items}
    assert pieces["sink_cabinet"].center_m[:2] == pytest.approx((1.0, -0.325))
    # Flush with the counter's right end and back.
    assert pieces["cooker_cabinet"].center_m[:2] == pytest.approx((2.38, -0.33))
    # A group that is turned by a quarter: what stood along x stands along y, facing +x.
    fridge = pieces["refrigerator"]
    assert fridge.center_m[:2] == pytest.approx((0.4, -2.3))
    assert fridge.yaw_deg == pytest.approx(90.0)
    (window,) = house.openings
    assert window.box.center_m == pytest.approx((1.0, 0.12, 1.35))
    lengths = [item.box.size_m[0] for item in house.items if item.box.yaw_deg == 0.0]
    assert sum(lengths) == pytest.approx(2.0 + 0.76)


@pytest.mark.parametrize("text", ["a: &a [1]\nb: *a\n", "[" * 200, "a: !!python/name:os.system"])
def test_yaml_builds_plain_values_only(text: str) -> None:
    with pytest.raises(SceneError):
        parse_yaml(text.encode(), "layout.yaml", SceneError)


def test_furnishings_of_tdw_need_sizes_and_are_rooms_by_gaps(tmp_path: Path) -> None:
    unit = {"x": 1, "y": 1, "z": 1}
    pieces = [
        {"name": name, "library": "models_core.json", "scale_factor": unit,
         "position": {"x": x, "y": 0.0, "z": z}, "rotation": {"x": 0, "y": turn, "z": 0}}
        for name, x, z, turn in (("bed01", 0.0, 0.0, 180.0), ("stand", 1.5, 0.5, 0.0),
                                 ("sofa01", 6.0, 0.0, 90.0))
    ]  # fmt: skip
    path = tmp_path / "floorplan_layouts.json"
    path.write_text(json.dumps({"1": {"0": pieces}}))
    (refused,) = foreign_houses(path, Models())
    assert refused.house is None
    assert "models_core.json" in refused.why
    sizes = {"bed01": ("bed", (2.0, 2.1, 1.0)), "stand": ("table", (0.5, 0.5, 0.5)),
             "sofa01": ("sofa", (2.0, 0.9, 0.8))}  # fmt: skip
    (found,) = foreign_houses(path, Models(librarian=sizes))
    assert found.house is not None
    assert [room.kind for room in found.house.rooms] == ["bedroom", "living"]
    bed, stand, sofa = found.house.items
    assert (bed.category, stand.category) == ("bed", "bedside_table")
    # Unity turns clockwise from above, and its models face +z: at 90 degrees, +x.
    assert (bed.box.yaw_deg, sofa.box.yaw_deg) == (0.0, 90.0)
    assert category_of("chair", "armchair", (0.9, 0.8, 0.8)) == "single_sofa"


def bedroom() -> SceneGraph:
    outline = frozen_array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])
    room = Room("b", "bedroom", outline)
    door = Opening("door", "door", Box((0.6, -0.12, 0.0), (0.9, 0.24, 2.0), 0.0), ("b",))
    window = Opening("window", "window", Box((2.0, 4.12, 0.9), (1.2, 0.24, 1.2), 0.0), ("b",))
    bed = Item("b/bed", "bed", Box((2.0, 2.9, 0.0), (1.6, 2.0, 0.9), 0.0), "b")
    return SceneGraph((room,), (door, window), (bed,))


FACTS_OF: dict[str, set[Fact]] = {
    "bed to a door": {"doors"},
    "headboard under a window": {"windows"},
    "wardrobe": set(),
}


@pytest.mark.parametrize("rule", ROOM_RULES["bedroom"], ids=lambda rule: rule.name)
def test_a_rule_is_judged_alike_where_it_reads_nothing_that_is_hidden(rule) -> None:  # type: ignore[no-untyped-def]
    house = bedroom()
    (view,) = view_home(house, is_dressed=True).rooms
    facts = read_by(rule, view)
    assert FACTS_OF.get(rule.name, set()) <= facts
    if rule.name == "wardrobe":
        assert not facts & {"doors", "windows"}
    if not facts & {"doors", "windows"}:
        # Without openings it measures the same: nothing was read unnoticed.
        (bare,) = view_home(replace(house, openings=()), is_dressed=True).rooms
        assert list(rule.measure(view)) == list(rule.measure(bare))


def test_a_layout_without_openings_is_not_judged_by_them() -> None:
    house = bedroom()
    whole = judge_scene("said", [house])
    assert whole.unsaid == frozenset()
    assert whole.design == design_of([house], homely=_homely(house))
    bare = replace(house, openings=(), extra={UNSAID: ["home"]})
    assert unsaid_of([bare]) == {"doors", "windows", "home"}
    judged = judge_scene("bare", [bare])
    left = {each.rule for each in judged.unjudged}
    assert {"bed to a door", "headboard under a window", "shoe cabinets"} <= left
    names = {rule for room in judged.judged for rule in room.kept}
    assert not names & left
    # The same facts hidden from the whole layout: the same rules, the same verdict.
    hidden = judge_scene("hidden", [house], ("doors", "windows", "home"))
    assert hidden.design == judged.design


def _homely(house: SceneGraph):  # type: ignore[no-untyped-def]
    from chord_usd.base.metrics.complete import homely_rooms

    return homely_rooms(house)


def test_sizes_that_are_guessed_judge_nothing() -> None:
    scene = judge_scene("guessed", [replace(bedroom(), extra={UNSAID: ["sizes"]})])
    kept = [name for judged in scene.judged for name in judged.kept]
    assert set(kept) <= {"what rooms of its kind cannot do without"}


def no_stage(path: Path) -> tuple[list[SceneGraph], None]:
    raise AssertionError(f"{path} is no stage")


def test_a_source_says_what_could_not_be_read(tmp_path: Path) -> None:
    kitchen(tmp_path)
    (tmp_path / "broken.yaml").write_text("room: {walls: [], floor: [{type: floor}]}")
    (part,) = judged_sets([tmp_path], Models(), (), no_stage)
    assert [scene.name for scene in part.scenes] == ["layout001"]
    assert list(part.skipped) == ["broken"]
    assert part.scenes[0].holds is None
