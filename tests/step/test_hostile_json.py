"""CHOrD JSON, options, texts and paths as nobody should send them: read, or told in a sentence."""

from __future__ import annotations

import copy
import gc
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from chord_usd import cli
from chord_usd.base.errors import ChordError, PlanError, SceneError
from chord_usd.base.raster.raster_files import read_layout, write_raster
from chord_usd.base.scene.chord_json import read_plan, read_scene, scene_from_json
from chord_usd.base.scene.geometry import extent_m
from chord_usd.base.scene.limits import (
    LARGEST_HOUSE_M,
    MOST_CORNERS,
    MOST_ITEMS,
    MOST_OPENINGS,
    MOST_ROOMS,
)
from chord_usd.line.pipeline import draw_plan
from chord_usd.line.plan.picture import read_picture
from chord_usd.line.plan.read import read_plan_file
from chord_usd.line.planning.wording import read_wish
from chord_usd.line.stage.shell.walls import build_walls

HOUSE = json.loads((Path(__file__).parents[1] / "fixtures/furnished_house.json").read_text())
SECONDS = 2.0


def grid(rooms: int, corners: int = 4) -> dict[str, Any]:
    """So many square rooms with a door and a bed each, in rows; a wall of each may zigzag."""
    side = int(np.ceil(rooms**0.5))
    house: dict[str, Any] = {"rooms": [], "windowsDoors": [], "furniture": []}
    for index in range(rooms):
        x, y = index % side * 424, index // side * 424
        top = [
            [x + 400 - 400 * step / (corners - 3), y + 400 - 2 * (step % 2)]
            for step in range(corners - 2)
        ]
        outline = [[x, y], [x + 400, y], *top]
        house["rooms"].append(
            {"roomId": f"r{index}", "roomName": "bedroom", "roomType": 1, "wallPoints": outline}
        )
        box = {"length": 90, "width": 24, "height": 210, "rotate": 90}
        house["windowsDoors"].append({"type": "door", "pos": [x + 412, y + 200, 0], **box})
        house["furniture"].append({"type": "bed", "pos": [x + 200, y + 280, 0], **box})
    return house


def read_in_time(path: Path) -> bool:
    """Read a file as a scene and as a plan; whatever it holds, quickly and without a surprise.

    Returns whether both readers took it.
    """
    taken = True
    for read in (read_scene, read_plan):
        start, told = time.process_time(), str(path)
        try:
            read(path)
        except ChordError as error:
            told, taken = str(error), False
        assert told.startswith(str(path))
        assert len(told) < 1000
        assert time.process_time() - start < SECONDS
    return taken


# Mutations ---------------------------------------------------------------------------------------

ODD = st.one_of(
    st.sampled_from(
        [1e308, -1e308, 1e-308, float("nan"), float("inf"), 10**400, -1, 0, True, None, "", "\0",
         "\x1b[31m", "a" * 5000, [], {}, [[]], [[1, 2]] * 3, "r0", "../../etc", "＿", "𝔞"]
    ),
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=9),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
        max_leaves=6,
    ),
)  # fmt: skip


def places(value: object, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where there is something in parsed JSON."""
    keys = value.items() if isinstance(value, dict) else enumerate(value)  # type: ignore[arg-type]
    found = [path] if path else []
    for key, inner in keys:
        here = (*path, key)
        found += places(inner, here) if isinstance(inner, dict | list) else [here]
    return found


PLACES = places(HOUSE)


@settings(
    max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(changes=st.lists(st.tuples(st.sampled_from(PLACES), ODD | st.just(...)), max_size=3))
@example(changes=[])
def test_a_damaged_house_is_read_or_refused(
    changes: list[tuple[tuple[Any, ...], Any]], tmp_path: Path
) -> None:
    house = copy.deepcopy(HOUSE)
    for (*way, last), value in changes:
        part = house
        try:
            for key in way:
                part = part[key]
            if value is ...:
                del part[last]
            else:
                part[last] = value
        except (KeyError, IndexError, TypeError):
            continue  # an earlier change took it away
    file = tmp_path / "house.json"
    file.write_text(json.dumps(house))
    assert read_in_time(file) or house != HOUSE


@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(at=st.floats(0, 1), junk=st.binary(max_size=8), cut=st.integers(0, 40))
@example(at=0.0, junk=b" ", cut=0)
def test_damaged_bytes_are_read_or_refused(
    at: float, junk: bytes, cut: int, tmp_path: Path
) -> None:
    data = json.dumps(HOUSE).encode()
    spot = int(at * len(data))
    file = tmp_path / "house.json"
    file.write_bytes(data[:spot] + junk + data[spot + cut :])
    assert read_in_time(file) or junk.strip() or cut


def text_of(key: str, value: str) -> str:
    """The house with a raw text in place of the first value of a key."""
    text = json.dumps(grid(1))
    start = text.index(f'"{key}": ') + len(key) + 4
    end = min(text.index(mark, start) for mark in ",}")
    return text[:start] + value + text[end:]


REFUSED = {
    "deep": ('{"rooms": ' + "[" * 100_000 + "]" * 100_000 + "}", "nested too deeply"),
    "rather deep": ('{"rooms": ' + "[" * 200 + "]" * 200 + "}", "nested too deeply"),
    "deep objects": ('{"a":' * 50_000 + "1" + "}" * 50_000, "nested too deeply"),
    "a number of 5000 digits": (text_of("length", "9" * 5000), "length is inf"),
    "a seed of 100 digits": (
        json.dumps(
            grid(1) | {"provenance": {
                "inputHash": "", "checkpointHash": "", "seed": 10**100, "version": "",
                "configuration": {},
            }}
        ),
        "seed has 101 digits",
    ),
    "one key twice": ('{"rooms": [], "rooms": []}', "key 'rooms' twice"),
    "half a character": (text_of("roomId", '"\\ud800"'), "half a character"),
    "half a key": ('{"\\udfff": 1}', "half a character"),
    "turned far": (text_of("rotate", "1e308"), "rotate is 1e+308"),
    "not turned": (text_of("rotate", "NaN"), "rotate is nan"),
    "too long": (text_of("length", "1e308"), "length is 1e+308"),
    "too thin": (text_of("length", "1e-308"), "length is 1e-308"),
    "nowhere": (text_of("pos", "[NaN, 0, 0]").replace("[NaN, 0, 0], 200, 0]", "[NaN, 0, 0]"),
                "pos is nan"),
    "rooms without end": (json.dumps(grid(MOST_ROOMS + 1)), f"rooms holds {MOST_ROOMS + 1}"),
    "corners without end": (json.dumps(grid(1, 20_000)), "wallPoints holds 20000"),
    "many corners in all": (json.dumps(grid(30, MOST_CORNERS)), "have 30000 corners"),
    "furniture without end": (
        json.dumps(grid(1) | {"furniture": grid(1)["furniture"] * (MOST_ITEMS + 1)}),
        f"furniture holds {MOST_ITEMS + 1}",
    ),
    "doors without end": (
        json.dumps(grid(1) | {"windowsDoors": [{}] * (MOST_OPENINGS + 1)}),
        f"windowsDoors holds {MOST_OPENINGS + 1}",
    ),
    "a house from here to there": (
        json.dumps({"rooms": [
            grid(1)["rooms"][0], grid(1)["rooms"][0] | {
                "roomId": "far",
                "wallPoints": [[60_000, 0], [60_400, 0], [60_400, 400], [60_000, 400]],
            }], "windowsDoors": [], "furniture": []}),
        "the house is 604 m across",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_house_can_be_is_refused_in_time(name: str, tmp_path: Path) -> None:
    text, told = REFUSED[name]
    file = tmp_path / "house.json"
    file.write_text(text)
    start = time.process_time()
    with pytest.raises(SceneError) as caught:
        read_scene(file)
    assert time.process_time() - start < SECONDS
    assert told in str(caught.value)


def test_children_count_as_items(tmp_path: Path) -> None:
    house = grid(1)
    child = {"type": "laptop", "pos": [0, 0, 0], "length": 3, "width": 3, "height": 3, "rotate": 0}
    house["furniture"][0]["children"] = [child] * MOST_ITEMS
    with pytest.raises(SceneError, match="one too many"):
        scene_from_json(house)


def test_a_byte_order_mark_is_read_and_other_encodings_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "house.json"
    text = json.dumps(grid(1))
    file.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert len(read_scene(file).rooms) == 1
    for encoding in ("utf-16", "utf-32"):
        file.write_bytes(text.encode(encoding))
        with pytest.raises(SceneError, match="is not text"):
            read_scene(file)


@given(turns=st.integers(-2700, 2700), yaw=st.integers(-359, 359))
def test_angles_are_taken_modulo_a_turn(turns: int, yaw: int) -> None:
    house = grid(1)
    house["furniture"][0]["rotate"] = yaw + 360 * turns
    found = scene_from_json(house).items[0].box.yaw_deg
    assert (found - yaw) % 360 == 0
    assert abs(found) <= 360


@pytest.mark.alone
def test_twice_the_rooms_take_about_twice_as_long() -> None:
    """Reading and building walls: nothing goes through the whole house for each of its rooms."""

    def seconds(rooms: int) -> float:
        """The shorter of two: whatever else the machine does, or collects, only adds to one."""
        data = grid(rooms)
        taken = []
        for _ in range(2):
            gc.collect()
            start = time.process_time()
            build_walls(scene_from_json(data).plan)
            taken.append(time.process_time() - start)
        return min(taken)

    seconds(20)
    assert seconds(480) < 4 * 2.0 * seconds(120)


# Files that are none ------------------------------------------------------------------------------


def fifo(folder: Path) -> Path:
    os.mkfifo(folder / "plan.json")
    return folder / "plan.json"


def unix_socket(folder: Path) -> Path:
    where = os.open(folder, os.O_RDONLY)
    try:  # by a short name: sockets' names may have a hundred characters
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(f"/proc/self/fd/{where}/plan.png")
    finally:
        os.close(where)
    return folder / "plan.png"


def device(folder: Path) -> Path:
    (folder / "plan.svg").symlink_to("/dev/zero")
    return folder / "plan.svg"


def ten_gigabytes(folder: Path) -> Path:
    with (folder / "plan.pdf").open("wb") as file:
        file.truncate(10 * 2**30)
    return folder / "plan.pdf"


@pytest.mark.parametrize("make", [fifo, unix_socket, device, ten_gigabytes])
@pytest.mark.parametrize(
    "verb",
    ["generate IN -o OUT.usda", "plan read IN -o OUT.json", "plan draw IN -o OUT.png",
     "plan from-outline IN -o OUT.png", "layout IN -o OUT.png", "graph IN -o OUT.json",
     "stage IN -o OUT.usda", "check IN", "describe IN", "diff IN IN", "render IN -o OUT",
     "regenerate IN --room Bedroom_0 -o OUT.usda", "farm bundle IN -o OUT"],
)  # fmt: skip
def test_only_files_that_end_are_opened(
    make: Callable[[Path], Path], verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = make(tmp_path)
    before = set(tmp_path.iterdir())
    words = verb.replace("IN", str(path)).replace("OUT", str(tmp_path / "out")).split()
    assert cli.main(words) == cli.UNUSABLE
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith(f"error: {path}: ")
    assert any(word in told for word in ("pipe", "socket", "device", "MiB"))
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize("read", [read_plan_file, read_plan, read_scene, read_layout, read_picture])
def test_every_reader_looks_before_it_opens(read: Callable[[Path], Any], tmp_path: Path) -> None:
    """Callers need not be verbs."""
    with pytest.raises(ChordError, match="is a pipe"):
        read(fifo(tmp_path))


# Options and paths --------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", ["1e300", "11", "0.00001", "-1", "nan", "inf", "0", "9" * 5000])
def test_a_scale_has_a_range(scale: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["plan", "read", "p.png", f"--scale={scale}", "-o", "p.json"]) == cli.UNUSABLE
    told = capsys.readouterr().err
    assert "argument --scale" in told
    assert len(told) < 300


def test_a_plan_of_kilometres_is_refused(tmp_path: Path) -> None:
    picture = tmp_path / "plan.png"
    write_raster(draw_plan(scene_from_json(grid(9)).plan), picture)
    assert extent_m(read_plan_file(picture).rooms) < 20
    with pytest.raises(PlanError) as caught:
        read_plan_file(picture, 9.0)
    assert f"at most {LARGEST_HOUSE_M:.0f} m" in str(caught.value)


ODD_NAMES = ["a\nb.usda", "a\x1b[31mb.usda", "x:SDF_FORMAT_ARGS:a=b.usda", "a\\b.usda",
             "a" * 300 + ".usda", "\udce4.usda", "a\u2028b.usda"]  # fmt: skip


@pytest.mark.parametrize("name", ODD_NAMES, ids=ascii)
def test_outputs_that_not_everyone_can_name_are_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "house.json"
    file.write_text(json.dumps(grid(1)))
    assert cli.main(["stage", str(file), "-o", str(tmp_path / name)]) == cli.UNUSABLE
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert "unexpected" not in told
    assert "\x1b" not in told
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("locale", [{}, {"PYTHONUTF8": "0"}], ids=["C", "C without UTF-8"])
def test_names_beyond_ascii_in_a_locale_without_them(
    locale: dict[str, str], tmp_path: Path
) -> None:
    """Ids in files are Unicode whatever the locale; paths are where Python can tell what they are,
    and refused where not."""
    house = grid(1)
    house["rooms"][0] |= {"roomId": "Küche_漢😀", "roomName": "Küche"}
    scene = tmp_path / "house.json"
    scene.write_text(json.dumps(house, ensure_ascii=False), encoding="utf-8")
    environment = {**os.environ, "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", **locale}
    for name in ("plain.png", "häuser.png"):
        done = subprocess.run(
            [sys.executable, "-m", "chord_usd.cli", "plan", "draw", scene, "-o", tmp_path / name],
            env=environment, capture_output=True, check=False,
        )  # fmt: skip
        refused = bool(locale) and not name.isascii()
        assert done.returncode == (cli.UNUSABLE if refused else cli.DONE), done.stderr
        assert (tmp_path / name).exists() != refused
        assert b"unexpected" not in done.stderr


# Texts --------------------------------------------------------------------------------------------

CONTRADICTIONS = {
    "English": "two bedrooms, no bedrooms",
    "German": "zwei Schlafzimmer, keine Schlafzimmer",
    "French": "deux chambres, sans chambre",
    "Spanish": "dos dormitorios, sin dormitorios",
    "Portuguese": "dois quartos, sem quartos",
    "Swedish": "två sovrum, inga sovrum",
    "Finnish": "kaksi makuuhuonetta, ilman makuuhuonetta",
    "Chinese": "两卧室 无卧室",
}


@pytest.mark.parametrize("language", CONTRADICTIONS)
def test_what_is_asked_for_and_denied_is_told(language: str) -> None:
    text = CONTRADICTIONS[language]
    with pytest.raises(ChordError, match="asked for and denied"):
        read_wish(text)
    found = read_wish(f"{text}, 70 m2")
    assert not found.wish.counts
    assert any("asked for and denied" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    "text",
    ["minus 5 bedrooms", "-5 bedrooms", "a flat with −2 bathrooms", "minus drei Schlafzimmer",
     "moins deux chambres", "menos dos dormitorios", "menos três quartos", "minus två sovrum",
     "miinus kaksi makuuhuonetta", "负三室"],
)  # fmt: skip
def test_less_than_nothing_is_refused(text: str) -> None:
    with pytest.raises(ChordError, match="less than nothing"):
        read_wish(text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("two bedrooms and 3 swimming pools", "3 swimming pools"),
        ("a 50 m² flat of 120 m² with two bedrooms", "50 m²"),
        ("studio with three bedrooms", "a studio"),
        ("no kitchen, open kitchen, one bedroom", "kitchens"),
        ("two bedrooms, 1.5 bathrooms", "1.5"),
        ("a house of three rooms, 5 rooms", "3 rooms in all and 5"),
        ("two to three bedrooms", "2 and then 3"),
    ],
)
def test_what_is_not_heard_is_told(text: str, told: str) -> None:
    assert any(told in warning for warning in read_wish(text).warnings)


@pytest.mark.parametrize("text", ["a flat of 1e99 m²", "a flat of 1e999 m²", "flat, 9,9e9 m2"])
def test_an_area_in_powers_of_ten_is_read_whole(text: str) -> None:
    """The 99 of 1e99 was taken for the area."""
    with pytest.raises(ChordError, match="cannot be planned") as caught:
        read_wish(text)
    assert len(str(caught.value)) < 300
    assert read_wish("a flat of 1e2 m² with two bedrooms").wish.area_m2 == 100.0


def test_a_palace_in_a_cupboard_is_refused() -> None:
    with pytest.raises(ChordError, match="cannot be planned"):
        read_wish("a 5 m² flat with nine bedrooms")
    with pytest.raises(ChordError, match="more than fits"):
        read_wish("a 20 m² flat with nine bedrooms")


@settings(max_examples=150, deadline=None)
@given(
    st.text(max_size=200)
    | st.lists(
        st.sampled_from(
            ["two", "bedroom", "no", "m²", "9" * 400, "½", "-", ",", "平米", "LDK", "3"]
        )
    ).map(" ".join)
    | st.just("a" * 10**6)
    | st.just("bedroom\x00")
    | st.just("1," * 999)
)
def test_any_text_is_heard_or_refused_in_time(text: str) -> None:
    start = time.process_time()
    try:
        told = read_wish(text).summary
    except ChordError as error:
        told = str(error)
    assert told
    assert "\x00" not in told
    assert time.process_time() - start < SECONDS
