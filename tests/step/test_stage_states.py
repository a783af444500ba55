"""States of a written house: what the stage, its maps and the certificate say of them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from pxr import Usd, UsdGeom, UsdLux, UsdPhysics

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.states import read_states
from chord_usd.base.scene.units import wrap_deg
from chord_usd.cli import main
from chord_usd.line.pipeline.house_states import set_states
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.read.leaf_states import stated_doors


@pytest.fixture(scope="module")
def house(opening_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy; every test gives all of it the usual state first."""
    return Path(shutil.copytree(opening_house.parent, tmp_path_factory.mktemp("s") / "h")) / (
        opening_house.name
    )


def stated(house: Path, text: str) -> Usd.Stage:
    set_states(house, house, f"everything: usual; {text}")
    stage = Usd.Stage.Open(str(house))
    stage.Reload()
    return stage


def angle_deg(joint: UsdPhysics.RevoluteJoint) -> float:
    """How far the second body is turned about a joint that lies along z."""
    bodies = (joint.GetBody0Rel(), joint.GetBody1Rel())
    stage = joint.GetPrim().GetStage()
    prims = [stage.GetPrimAtPath(rel.GetTargets()[0]) for rel in bodies]
    cache = UsdGeom.XformCache()
    first, second = (cache.GetLocalToWorldTransform(prim) for prim in prims)
    turn = (second * first.GetInverse()).ExtractRotation()
    axis, angle = turn.GetAxis(), turn.GetAngle()
    return wrap_deg(float(angle * axis[2]))


def hinges(stage: Usd.Stage, of: str) -> list[UsdPhysics.RevoluteJoint]:
    return [UsdPhysics.RevoluteJoint(prim) for prim in stage.Traverse()
            if prim.IsA(UsdPhysics.RevoluteJoint) and of in str(prim.GetPath())]  # fmt: skip


def test_doors_stand_where_their_state_says_and_within_their_joints(house: Path) -> None:
    for state, share in (("open", 1.0), ("half open", 0.5), ("ajar", 1 / 6), ("closed", 0.0)):
        stage = stated(house, f"doors: {state}; windows: closed")
        doors = hinges(stage, "/Door_")
        assert doors
        for joint in doors:
            limits = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
            assert angle_deg(joint) == pytest.approx(max(limits, key=abs) * share, abs=0.01), state


def test_usual_takes_everything_back(house: Path) -> None:
    stage = stated(house, "doors: usual")
    assert not stated_doors(stage)
    noted = [prim for prim in stage.TraverseAll() if prim.HasAttribute("chord:state")]
    assert not noted


def test_furniture_that_opens_becomes_jointed_and_opens_as_far_as_it_is_free(house: Path) -> None:
    free = {entry.path: entry.free_share for entry in check_stage(house).opens}
    stage = stated(house, "furniture: open")
    leaves = [prim for prim in stage.Traverse() if prim.HasAttribute("chord:state")]
    assert {str(prim.GetPath()) for prim in leaves} == set(free)
    for joint in hinges(stage, "/Furniture/"):
        if str(joint.GetAxisAttr().Get()) == "Z":
            limits = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
            path = str(joint.GetBody1Rel().GetTargets()[0])
            wanted = max(limits, key=abs) * free[path]
            assert angle_deg(joint) == pytest.approx(wanted, abs=2.0), path


def test_a_certificate_is_about_the_house_while_it_is_shut(house: Path) -> None:
    stated(house, "lamps: usual")
    before = check_stage(house)
    stated(house, "everything: open; lights: off")
    after = check_stage(house)
    assert (after.faults, after.flaws) == (before.faults, before.flaws)


def test_lamps_are_on_or_off_at_every_time_of_day(house: Path) -> None:
    stage = stated(house, "lights: off; bedroom 1 lights: on")
    for time in ("day", "evening", "night"):
        stage.GetPrimAtPath("/House").GetVariantSet("lighting").SetVariantSelection(time)
        lights = [prim for prim in stage.Traverse() if prim.HasAPI(UsdLux.LightAPI)
                  and str(prim.GetPath()).startswith("/House/Rooms")]  # fmt: skip
        on = {str(prim.GetPath()).split("/")[3] for prim in lights
              if UsdLux.LightAPI(prim).GetIntensityAttr().Get() > 0}  # fmt: skip
        assert on == {"Bedroom_0"}, time


def test_subjects_name_rooms_pieces_and_prims(house: Path) -> None:
    def meant(subject: str, state: str) -> set[str]:
        (entry,) = set_states(house, house, f"{subject}: {state}", dry_run=True)
        return set(entry.paths)

    doors = meant("all doors", "open")
    assert meant("doors in bedroom 1", "open") == meant("Bedroom_0 doors", "closed") < doors
    assert meant("the front door", "open") < doors
    lamps = meant("lamps", "off")
    assert lamps < meant("lights", "off") == meant("everything", "off")
    some = next(iter(lamps)).split("/")
    assert meant(f"{some[3]}/{some[-1]}", "on") == {"/".join(some)}
    assert meant("living room", "off") >= meant("living room lamps", "off")


def test_what_is_not_there_is_refused_in_one_line(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = house.read_bytes()
    for said, expected in (
        ("lava lamp: off", "lamps"), ("attic doors: open", "Bedroom_0"),
        ("doors: on", "lamps"), ("doors: wide", "ajar"), ("doors", "SUBJECT: STATE"), (" ", ""),
    ):  # fmt: skip
        assert main(["edit", str(house), "--state", said, "--progress", "none"]) == 2, said
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert line.startswith("error: "), line
        assert expected in line, line
    assert main(["edit", str(house), "remove the sofa", "--state", "doors: open"]) == 2
    assert house.read_bytes() == before


def test_maps_follow_doors_that_have_a_state(house: Path, tmp_path: Path) -> None:
    reachable, free = {}, {}
    for state in ("usual", "open", "closed"):
        stated(house, f"doors: {state}")
        folder = tmp_path / state
        assert main(["export", str(house), "--for", "ros", "-o", str(folder), "-q"]) == 0
        record = json.loads((folder / "rooms.json").read_text())
        assert {door["state"] for door in record["doors"] if door["kind"] == "door"} == {
            None if state == "usual" else state
        }
        reachable[state] = {room["id"] for room in record["rooms"] if room["reachable"]}
        free[state] = (folder / "map.pgm").read_bytes().count(254)
    assert reachable["closed"] < reachable["open"] == reachable["usual"]
    assert max(free["open"], free["closed"]) < free["usual"]


def test_clauses_are_read() -> None:
    (first, second) = read_states("doors : Half-Open ;\n bedroom 1 lamp:OFF;")
    assert (first.subject, first.state) == ("doors", "half open")
    assert (second.subject, second.state) == ("bedroom 1 lamp", "off")
    with pytest.raises(ChordError, match="characters"):
        read_states("doors: open;" * 1000)


def test_an_edit_of_a_room_keeps_its_states(house: Path, tmp_path: Path) -> None:
    stated(house, "lamps: off; doors: ajar")
    target = tmp_path / "edited.usda"
    said = "remove all bedside tables in bedroom 1"
    assert main(["edit", str(house), said, "--force", "-o", str(target), "-q"]) < 2
    stage = Usd.Stage.Open(str(target))
    noted = {
        str(prim.GetAttribute("chord:state").Get()) for prim in stage.TraverseAll()
        if prim.HasAttribute("chord:state") and "Bedroom_0" in str(prim.GetPath())
    }  # fmt: skip
    assert noted == {"off", "ajar"}
