"""Twins of a house: one piece moved, at the place that the manifest says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.scene.chord_json import read_scene
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.workshop.data.twin_faults import KINDS
from chord_usd.workshop.data.twins import findings_of, found_by, override, twins_of, write_twins


def living_room() -> SceneGraph:
    outline = frozen_array([(0.0, 0.0), (6.0, 0.0), (6.0, 5.0), (0.0, 5.0)])
    room = Room("/House/Rooms/Living_0", "living", outline)
    door = Opening("door", "door", Box((0.8, -0.12, 0.0), (0.9, 0.24, 2.0), 0.0), (room.id,))

    def piece(name: str, x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0,
              z: float = 0.0) -> Item:  # fmt: skip
        return Item(f"{room.id}/{name.title()}", name, Box((x, y, z), size, yaw), room.id)

    items = (
        piece("sofa", 3.0, 4.5, (2.0, 0.9, 0.8)),
        piece("coffee_table", 3.0, 3.2, (1.0, 0.5, 0.4)),
        piece("cabinet", 5.7, 2.0, (1.2, 0.5, 2.1), -90.0),
    )
    dressing = (
        piece("picture", 3.0, 4.98, (0.6, 0.03, 0.5), z=1.4),
        piece("floor_lamp", 0.4, 4.5, (0.4, 0.4, 1.5)),
        piece("rug", 3.0, 3.5, (1.2, 0.8, 0.01)),
    )
    return SceneGraph((room,), (door,), items, dressing=dressing)


def test_half_of_the_kinds_are_named_by_no_rule() -> None:
    assert sum(kind.is_named for kind in KINDS) * 2 == len(KINDS)


def test_a_twin_differs_by_one_piece_and_the_same_seed_gives_the_same() -> None:
    house = living_room()
    twins = list(twins_of(house, np.random.default_rng(3)))
    again = list(twins_of(house, np.random.default_rng(3)))
    assert [(t.after.id, t.after.box) for t in twins] == [(t.after.id, t.after.box) for t in again]
    assert len(twins) >= 6
    for twin in twins:
        before = {item.id: item for item in (*house.items, *house.dressing)}
        after = {item.id: item for item in (*twin.graph.items, *twin.graph.dressing)}
        changed = [name for name in before if before[name].box != after[name].box]
        assert changed == [twin.after.id], twin.kind.name
        assert twin.after.category == twin.before.category


def test_a_judge_finds_what_is_named_at_its_place_and_nothing_in_the_house_itself() -> None:
    house = living_room()
    sound = findings_of(house)
    twins = {twin.kind.name: twin for twin in twins_of(house, np.random.default_rng(0))}
    same = replace(twins["a piece in a wall"], graph=house)
    assert not any(verdict["found"] for verdict in found_by(sound, same).values())
    for name in ("a piece in a wall", "a piece before a door"):
        verdict = found_by(sound, twins[name])["faults on the floor"]
        assert verdict == {"found": True, "at_its_place": True}, name
    lamp = twins["a cord across the floor"]
    x, y = lamp.after.box.center_m[:2]
    assert min(x, y, 6.0 - x, 5.0 - y) >= 1.5
    hidden = twins["a picture behind a wardrobe"].after.box
    assert hidden.center_m[0] == pytest.approx(5.7 + 0.25 - 0.015 - 0.01)
    assert hidden.yaw_deg == -90.0


def test_files_of_a_pair_hold_the_house_and_the_fault(tmp_path: Path) -> None:
    house = living_room()
    folder = tmp_path / "pairs"
    folder.mkdir()
    rows = write_twins("h", house, "../stages/house.usda", folder, (1, 0))
    for row in rows:
        twin = read_scene(folder / row["twin"])
        moved = {item.id: item.box for item in (*twin.items, *twin.dressing)}[row["piece"]]
        assert moved.center_m == pytest.approx(row["after"]["at_m"], abs=1e-3)
        layer = (folder / row["twin_stage"]).read_text()
        assert "@../stages/house.usda@" in layer
        assert layer.count("{") == layer.count("}") == row["piece"].count("/")


def test_a_layer_over_the_stage_turns_only_what_is_turned() -> None:
    twins = {t.kind.name: t for t in twins_of(living_room(), np.random.default_rng(0))}
    assert "rotateZ" in override(twins["a front at the wall"], "house.usda")
    assert "rotateZ" not in override(twins["a piece in a wall"], "house.usda")
