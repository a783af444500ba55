"""Files that show several storeys: Sweet Home 3D with a staircase, IFC, and titles on a sheet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.json_stairs import stairs_of
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.storeys import Building, StoreyPlan
from chord_usd.line.plan.read import read_storey_plans
from chord_usd.line.plan.storey_titles import storey_rank, titled
from chord_usd.line.plan.text import Text
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.plan_files import write_sweethome


def home_of(storeys: tuple[StoreyPlan, ...]) -> str:
    """Home.xml of a house of storeys: rooms, doors, windows and its staircases."""
    parts = []
    for index, storey in enumerate(reversed(storeys)):  # levels in any order
        level = f"level='L{index}'"
        height = 300 * (len(storeys) - 1 - index)
        parts.append(f"<level id='L{index}' name='{storey.name}' elevation='{height}'/>")
        for room in storey.plan.rooms:
            points = "".join(f"<point x='{x * 100}' y='{-y * 100}'/>" for x, y in room.polygon_m)
            parts.append(f"<room {level} name='{room.name}'>{points}</room>")
        for one in storey.plan.openings:
            x, y, z = one.box.center_m
            kind = {"door": "door", "window": "window", "passage": "opening"}[one.kind]
            parts.append(
                f"<doorOrWindow {level} name='{kind}' x='{x * 100}' y='{-y * 100}' "
                f"width='{one.box.size_m[0] * 100}' depth='24' height='{one.box.size_m[2] * 100}' "
                f"elevation='{z * 100}' angle='{-np.radians(one.box.yaw_deg)}'/>"
            )
        for stair in stairs_of(storey.plan):
            x, y, _ = stair.box.center_m
            if stair.leads == "up":
                parts.append(
                    f"<pieceOfFurniture {level} name='Staircase' x='{x * 100}' y='{-y * 100}' "
                    f"width='{stair.box.size_m[0] * 100}' depth='{stair.box.size_m[1] * 100}' "
                    f"angle='{-np.radians(stair.box.yaw_deg)}'/>"
                )
    return f"<?xml version='1.0'?><home version='6000'>{''.join(parts)}</home>"


def read_back(storeys: tuple[StoreyPlan, ...], path: Path) -> Building:
    write_sweethome(path, home_of(storeys))
    return stack(read_storey_plans(path))


@pytest.mark.parametrize("seed", range(5))
def test_a_sweet_home_brings_its_storeys_and_stairs(seed: int, tmp_path: Path) -> None:
    storeys = random_storeys(np.random.default_rng(seed), 2 + seed % 2)
    made = read_back(storeys, tmp_path / "home.sh3d")
    true = stack(storeys)
    assert [one.name for one in made.storeys] == [one.name for one in true.storeys]
    assert len(made.climbs) == len(true.climbs), made.warnings
    for one, other in zip(made.storeys, true.storeys, strict=True):
        floors = [sum(room_polygon(r).area for r in s.plan.rooms) for s in (one, other)]
        assert floors[0] == pytest.approx(floors[1], rel=0.02)
    for climb, same in zip(made.climbs, true.climbs, strict=True):
        assert (
            climb.built.area_m.intersection(same.built.area_m).area > 0.5 * same.built.area_m.area
        )


@pytest.mark.parametrize(
    ("text", "rank"),
    [
        ("Ground Floor", 0.0), ("FIRST FLOOR", 1.0), ("2nd floor", 2.0), ("Basement", -1.0),
        ("Erdgeschoss", 0.0), ("1. Obergeschoss", 1.0), ("Lower Ground Floor", -1.0),
        ("Loft", 9.0), ("Kitchen", None), ("Approx. Gross Internal Floor Area", None),
        ("Bedroom 1", None), ("12.5 m", None),
    ],
)  # fmt: skip
def test_titles_name_storeys_and_nothing_else(text: str, rank: float | None) -> None:
    assert storey_rank(text) == rank


def test_a_title_goes_to_the_plan_beside_it() -> None:
    bounds = [np.array([[0.0, 0.0], [100.0, 200.0]]), np.array([[150.0, 0.0], [250.0, 200.0]])]

    def line(text: str, x: float) -> Text:
        corners = np.array([[x, 210.0], [x + 40, 210.0], [x + 40, 220.0], [x, 220.0]])
        return Text(text, corners, 1.0)

    found = titled(bounds, [line("First Floor", 30.0), line("Ground Floor", 180.0)])
    assert found == [(1.0, "First Floor"), (0.0, "Ground Floor")]
