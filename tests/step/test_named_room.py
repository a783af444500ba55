"""One resolver for rooms: whatever name a room has, every verb takes it."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd

import chord_usd
from chord_usd.base.errors import StageError
from chord_usd.cli import UNUSABLE, main
from chord_usd.line.pipeline import one_room
from chord_usd.line.pipeline.named_room import named_room
from chord_usd.line.stage.read.titled_rooms import titled_rooms

SAID = ("Bedroom_1", "bedroom_1", "Bedroom 2", "the second bedroom", "bedroom two")


@pytest.mark.parametrize("said", SAID)
def test_a_room_goes_by_all_of_its_names(said: str, staged_house: Path) -> None:
    assert named_room(staged_house, said) == "Bedroom_1"


def test_every_room_goes_by_its_title_and_by_its_prim(staged_house: Path) -> None:
    house = chord_usd.open(staged_house)
    titled = titled_rooms(staged_house)
    assert {room.id: room.name for room in house.rooms} == {
        name: room.name for name, room in titled.items()
    }
    for name, room in titled.items():
        assert named_room(staged_house, room.name) == named_room(staged_house, name) == name


def test_a_printed_name_is_known_and_one_of_several_is_refused(
    staged_house: Path, tmp_path: Path
) -> None:
    layer = tmp_path / "over.usda"
    stage = Usd.Stage.CreateNew(str(layer))
    stage.GetRootLayer().subLayerPaths.append(str(staged_house))
    stage.SetDefaultPrim(stage.GetPrimAtPath("/House"))
    for name in ("Kitchen_0", "Bathroom_0"):
        stage.OverridePrim(f"/House/Rooms/{name}").SetDisplayName("Nook")
    stage.OverridePrim("/House/Rooms/Bedroom_0").SetDisplayName("Anna's room")
    stage.GetRootLayer().Save()
    assert named_room(layer, "anna's room") == "Bedroom_0"
    with pytest.raises(StageError, match="2 rooms; expected one of Bathroom_0, Kitchen_0"):
        named_room(layer, "Nook")


@pytest.mark.parametrize("verb", ["regenerate", "render", "turntable"])
def test_every_verb_asks_the_same_resolver(
    verb: str, staged_house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    option = "--turntable" if verb == "turntable" else "--room"
    words = ["regenerate" if verb == "regenerate" else "render", str(staged_house), option]
    target = str(tmp_path / ("house.usda" if verb == "regenerate" else "pictures"))

    class MeantError(Exception):
        pass

    def seen(*_: object, **__: object) -> None:
        raise MeantError

    monkeypatch.setattr("chord_usd.line.image.render.render_stage", seen)
    monkeypatch.setattr(one_room, "load_models", seen)
    assert main([*words, "Bedroom 9", "-o", target, "--progress", "none"]) == UNUSABLE
    assert "Try: --room 'Bedroom " in capsys.readouterr().err
    assert main([*words, "Bedroom 2", "-o", target, "--progress", "none"]) == UNUSABLE
    assert "MeantError" in capsys.readouterr().err
