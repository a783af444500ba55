"""The certificate of a dressed house: what hangs, lies and stands where it may is no fault, and
what floats, runs into something or stands in the way is named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from chord_usd.base.scene.types import Box, Facts, Item, SceneGraph
from tests.step.test_check import BED, SHOES, SOUND, check, house

# The bedroom of the house is x 0 to 4, y 2.24 to 6.24; its window at x 0, y 4.6 to 5.8.


def thing(category: str, at: tuple, size: tuple, yaw: float = 0.0, room: str = "a",
          rests_on: str | None = None) -> Item:  # fmt: skip
    box = Box(at, size, yaw)
    return Item(
        f"{room}/dressing/{category}_0", category, box, room, facts=Facts(rests_on=rests_on)
    )


DRESSING = {
    one.category: one
    for one in (
        thing("picture", (3.984, 3.5, 1.3), (0.5, 0.03, 0.7), yaw=-90),
        thing("rug", (2.8, 4.4, 0.0), (2.0, 1.6, 0.004)),
        thing("ceiling_lamp", (2.0, 4.2, 2.6), (0.4, 0.4, 0.1)),
        thing("curtain", (0.1, 4.4, 0.0), (0.3, 0.1, 2.4), yaw=90),
        thing("cushion", (3.0, 6.0, 0.88), (0.5, 0.15, 0.4), rests_on=BED.id),
        thing("floor_plant", (3.7, 2.6, 0.0), (0.4, 0.4, 1.2)),
        thing("bowl", (3.4, 0.2, 1.0), (0.2, 0.2, 0.08), room="hall", rests_on=SHOES.id),
    )
}


def dressed(**moved: Box | Item) -> SceneGraph:
    """The sound house with this dressing, some of it elsewhere."""
    own = {
        name: moved.get(name, one) if isinstance(moved.get(name, one), Item)
        else replace(one, box=moved[name])
        for name, one in DRESSING.items()
    }  # fmt: skip
    return replace(house(*SOUND), dressing=tuple(own.values()))


def test_a_dressed_house_holds_and_its_furniture_scores_as_before(tmp_path: Path) -> None:
    report = check(tmp_path, dressed())
    assert report.holds, report
    bare = check(tmp_path / "bare", house(*SOUND))
    assert (report.por, report.piou, report.pairs) == (bare.por, bare.piou, bare.pairs)
    assert (report.objects.total, report.objects.by_kind) == (5 + 7, {"bedroom": 10})
    assert report.dressing.items == 7
    assert (report.dressing.windows_dressed, report.dressing.textured_area) == (1.0, 0.0)
    assert (bare.dressing.items, bare.dressing.windows_dressed, bare.objects.least) == (0, 0, 4)


@pytest.mark.parametrize(
    ("fault", "category", "at", "yaw"),
    [
        ("unsupported", "picture", (3.978, 3.5, 1.3), -90),  # 7 mm off its wall
        ("unsupported", "ceiling_lamp", (2.0, 4.2, 2.4), 0),
        ("unsupported", "curtain", (0.1, 3.4, 0.1), 90),
        ("unsupported", "cushion", (3.0, 6.0, 1.5), 0),
        ("unsupported", "bowl", (3.4, 0.2, 1.1), 0),
        ("unsupported", "floor_plant", (3.7, 2.6, 0.1), 0),
        ("out_of_room", "rug", (3.5, 4.4, 0.0), 0),
        ("blocked_openings", "floor_plant", (1.8, 2.6, 0.0), 0),
        ("blocked_openings", "picture", (0.02, 5.2, 1.3), 90),
        ("blocked_openings", "curtain", (1.8, 2.3, 0.0), 180),
    ],
)
def test_each_fault_is_named(
    fault: str, category: str, at: tuple, yaw: float, tmp_path: Path
) -> None:
    box = DRESSING[category].box
    report = check(tmp_path, dressed(**{category: replace(box, center_m=at, yaw_deg=yaw)}))
    assert getattr(report, fault), report
    assert not report.holds


def test_what_stands_in_something_collides_but_not_on_a_rug(tmp_path: Path) -> None:
    plant = replace(DRESSING["floor_plant"].box, center_m=(3.0, 5.4, 0.0))
    (found,) = check(tmp_path, dressed(floor_plant=plant)).collisions
    assert {found.a.split("/")[-1], found.b.split("/")[-1]} == {"Bed_0", "FloorPlant_0"}


def test_what_stands_on_the_floor_is_walked_around_and_what_hangs_high_is_not(
    tmp_path: Path,
) -> None:
    wide = thing("floor_plant", (2.0, 3.4, 0.0), (4.0, 0.2, 1.0))
    assert check(tmp_path, dressed(floor_plant=wide)).walkable < 1.0
    lamp = Box((2.0, 3.4, 2.6), (4.0, 0.2, 0.1), 0.0)
    assert check(tmp_path / "lamp", dressed(ceiling_lamp=lamp)).walkable == 1.0
