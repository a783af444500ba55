"""What the Blender panel decides, without Blender."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from blender_addon.core import commands, edits, layer, library, report, swaps
from blender_addon.core.claim import Claims
from blender_addon.core.errors import InputError
from blender_addon.core.job import Job, Outcome, last_report, plain_error
from blender_addon.core.program import ProgramError, clean_environment, command_of, find_program
from blender_addon.core.state import panel_state, wrapped
from blender_addon.core.tree import (
    collection_tree,
    is_light,
    is_piece,
    is_placed,
    piece_of,
    room_names,
    room_of,
    usd_paths,
)

ROOT = Path(__file__).parents[2]

FURNISH = commands.FurnishSettings(seed=3)
SETTINGS = commands.GenerateSettings("PLAN", "", "", FURNISH)


def test_core_does_without_blender() -> None:
    code = "import sys, blender_addon.core.commands, blender_addon.core.job; assert 'bpy' not in "
    subprocess.run([sys.executable, "-c", code + "sys.modules"], check=True, cwd=ROOT)


def script(folder: Path, body: str) -> Path:
    """An executable Python script."""
    file = folder / "chord usd é"  # spaces and letters that are not ASCII
    file.write_text(f"#!{sys.executable}\n{body}\n", encoding="utf-8")
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return file


def test_the_program_is_found_and_says_its_version(tmp_path: Path) -> None:
    program = find_program(str(script(tmp_path, "print('chord-usd 1.2.3')")))
    assert program.version == (1, 2, 3)


def test_the_program_is_asked_what_it_can(tmp_path: Path) -> None:
    body = "import sys\nprint('chord-usd 1.2.3' if '--version' in sys.argv else '  --text T')"
    assert find_program(str(script(tmp_path, body))).abilities == {"--text"}


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("print('chord-usd 0.0.9')", "too old"),
        ("print('Python 3.11.2')", "is not chord-usd"),
        ("raise SystemExit('no such module')", "is not chord-usd"),
    ],
)
def test_a_wrong_program_is_refused_with_what_to_do(tmp_path: Path, body: str, words: str) -> None:
    with pytest.raises(ProgramError, match=words):
        find_program(str(script(tmp_path, body)))


def test_the_program_is_found_where_it_usually_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HOME", "PATH", "VIRTUAL_ENV"):
        monkeypatch.setenv(name, str(tmp_path / "nowhere"))
    with pytest.raises(ProgramError, match=r"No chord-usd was found\. Install chord-usd"):
        find_program("")
    folder = tmp_path / ".venv" / "bin"
    folder.mkdir(parents=True)
    script(tmp_path, "print('chord-usd 1.2.3')").rename(folder / "chord-usd")
    monkeypatch.setenv("VIRTUAL_ENV", str(tmp_path / ".venv"))
    assert find_program("").version == (1, 2, 3)
    assert find_program(str(tmp_path / ".venv")).version == (1, 2, 3)


def test_a_missing_program_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match="There is no file"):
        find_program(str(tmp_path / "nowhere"))
    with pytest.raises(ProgramError, match="no chord-usd in the folder"):
        find_program(str(tmp_path))


def test_a_python_runs_the_package() -> None:
    assert command_of(Path(sys.executable))[1:] == ("-m", "chord_usd")


def test_blenders_own_python_does_not_leak() -> None:
    kept = clean_environment({"PYTHONHOME": "/blender", "PYTHONPATH": "/addons", "HOME": "/me"})
    assert kept == {"HOME": "/me", "PYTHONUTF8": "1"}


def test_a_job_reports_progress_and_its_result(tmp_path: Path) -> None:
    told = json.dumps({"step": "layout", "done": 3, "total": 20})
    body = f"import sys\nsys.stderr.write('{told}\\nwarning: dark\\n')\nprint('{{\"rooms\": 7}}')"
    job = Job([str(script(tmp_path, body))])
    job.start()
    assert job.wait(20.0) == Outcome({"rooms": 7})
    assert job.progress is not None
    assert job.progress.share == pytest.approx(0.15)


def test_a_failed_job_gives_the_programs_own_sentence(tmp_path: Path) -> None:
    body = "import sys\nsys.stderr.write('error: no closed room found\\n')\nsys.exit(2)"
    job = Job([str(script(tmp_path, body))])
    job.start()
    assert job.wait(20.0).error == "no closed room found"


def test_a_killed_job_is_told_as_such(tmp_path: Path) -> None:
    job = Job([str(script(tmp_path, "import os\nos.kill(os.getpid(), 9)"))])
    job.start()
    assert "killed" in job.wait(20.0).error


def test_a_cancelled_job_is_no_failure(tmp_path: Path) -> None:
    job = Job([str(script(tmp_path, "import time\ntime.sleep(60)"))])
    job.start()
    job.cancel()
    assert job.wait(20.0) == Outcome(None, cancelled=True)
    assert not job.poll()


def test_a_program_that_cannot_start_ends_the_job(tmp_path: Path) -> None:
    job = Job([str(tmp_path / "nowhere")])
    job.start()
    assert not job.poll()
    assert "cannot be started" in job.wait(1.0).error


def test_the_last_error_line_counts() -> None:
    assert plain_error(["error: a", "lines", "error: b"]) == "b"
    assert plain_error(["Killed"]) == "Killed"
    assert plain_error([]) == ""


def test_missing_fields_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Choose a floor plan"):
        commands.generate(SETTINGS, tmp_path / "house.usda")
    gone = commands.GenerateSettings("PLAN", str(tmp_path / "gone.png"), "", FURNISH)
    with pytest.raises(InputError, match="not there"):
        commands.generate(gone, tmp_path / "house.usda")
    wordless = commands.GenerateSettings("TEXT", "", "  ", FURNISH)
    with pytest.raises(InputError, match="Describe"):
        commands.generate(wordless, tmp_path / "house.usda")
    shapeless = commands.GenerateSettings("OUTLINE", "", "two bedrooms", FURNISH)
    with pytest.raises(InputError, match="Choose an open plan"):
        commands.generate(shapeless, tmp_path / "house.usda")
    with pytest.raises(InputError, match="Generate it again"):
        commands.check(tmp_path / "house.usda")


def test_commands_are_ones_that_chord_usd_takes(tmp_path: Path) -> None:
    from chord_usd.cli import build_parser

    plan, house = tmp_path / "plän 1.png", tmp_path / "house.usda"
    plan.touch()
    house.touch()
    furnish = commands.FurnishSettings(3, 8, str(tmp_path), tabletop=False)
    settings = commands.GenerateSettings("PLAN", str(plan), "", furnish, 0.0125, part=2)
    pictures = commands.RenderSettings(("Bedroom_0",), 16, (640, 2160), ("rgb", "depth"))
    layer.write_changes(house, edits.Changes(locked=(BED,)))
    for arguments in (
        commands.generate(settings, house),
        commands.regenerate(house, "Bedroom_0", furnish, keep=["Bed_0"]),
        commands.check(house),
        commands.describe(house),
        commands.nearest("bed", (1.6, 2.0, 0.9), tmp_path, str(tmp_path)),
        commands.build_assets(tmp_path),
        commands.render(house, tmp_path / "pictures", pictures),
        commands.farm(house, tmp_path / "job", pictures),
    ):
        build_parser().parse_args(arguments)


def test_what_the_program_is_told_is_the_edited_house(tmp_path: Path) -> None:
    house = tmp_path / "house.usda"
    house.touch()
    assert "--edits" not in commands.regenerate(house, "Bedroom_0", FURNISH)
    file = layer.write_changes(house, edits.Changes(locked=(BED,)))
    words = commands.regenerate(house, "Bedroom_0", FURNISH)
    assert words[1] == str(house), "the house itself is written"
    assert words[words.index("--edits") + 1] == str(file)
    assert commands.check(house)[1] == str(file)


def test_passes_are_those_of_the_program() -> None:
    from chord_usd.image.options import PASSES

    assert set(commands.PASSES) == set(PASSES)


def test_plans_are_those_that_the_program_reads() -> None:
    from chord_usd.batch.units import PLAN_SUFFIXES
    from chord_usd.plan.vector.formats import SUFFIXES

    assert {*SUFFIXES, ".pdf", ".json"} <= set(commands.PLAN_SUFFIXES)
    assert set(PLAN_SUFFIXES) == set(commands.PLAN_SUFFIXES)


def test_a_house_that_moved_with_its_blender_file_is_found(tmp_path: Path) -> None:
    house = tmp_path / "new" / "chord-usd" / "flat" / "house.usda"
    house.parent.mkdir(parents=True)
    house.touch()
    stored = str(tmp_path / "old" / "chord-usd" / "flat" / "house.usda")
    assert commands.found_house(stored, str(tmp_path / "new" / "flat.blend")) == house
    with pytest.raises(InputError, match="not there"):
        commands.found_house(stored, "")
    with pytest.raises(InputError, match="Generate or open"):
        commands.found_house("", "")


def test_one_blender_at_a_time_has_a_house(tmp_path: Path) -> None:
    mine, theirs = Claims(), Claims()
    assert mine.take(tmp_path / "flat")
    assert mine.take(tmp_path / "flat"), "again by the same"
    assert not theirs.take(tmp_path / "flat")
    assert theirs.take_new(tmp_path / "flat") == tmp_path / "flat 2"
    mine.release()
    assert theirs.take(tmp_path / "flat")
    theirs.release()
    assert not list(tmp_path.iterdir()), "nothing came into them"


def test_houses_lie_beside_the_blender_file() -> None:
    folder = commands.house_folder(str(Path("work") / "flat.blend"), "in/plan: 1.png", Path("t"))
    assert folder == Path("work") / "chord-usd" / "plan_ 1"
    assert commands.house_folder("", "", Path("t")) == Path("t") / "chord-usd" / "house"


PARENTS = {
    "House": None,
    "Rooms": "House",
    "Bedroom_0": "Rooms",
    "Furniture": "Bedroom_0",
    "Bed_0": "Furniture",
    "Bedroom_1": "Rooms",
    "Furniture.001": "Bedroom_1",
    "Bed_0.001": "Furniture.001",
    "Desk_0": "Furniture.001",
    "Items": "Desk_0",
    "Laptop_0": "Items",
    "Cameras": "House",
    "Bedroom_0.001": "Cameras",
}


def test_usd_paths_come_back_from_numbered_names() -> None:
    paths = usd_paths(PARENTS)
    assert paths["Bed_0.001"] == "/House/Rooms/Bedroom_1/Furniture/Bed_0"
    assert len(set(paths.values())) == len(paths)
    assert room_names(paths.values()) == ["Bedroom_0", "Bedroom_1"]
    assert [path for path in paths.values() if is_piece(path)] == [
        "/House/Rooms/Bedroom_0/Furniture/Bed_0",
        "/House/Rooms/Bedroom_1/Furniture/Bed_0",
        "/House/Rooms/Bedroom_1/Furniture/Desk_0",
    ]


def test_collections_mirror_the_stage() -> None:
    house = collection_tree(usd_paths(PARENTS))
    assert house.name == "House"
    assert list(house.branches) == ["Bedroom_0", "Bedroom_1", "Cameras"]
    furniture = house.branches["Bedroom_1"].branches["Furniture"]
    assert furniture.name == "Bedroom_1 Furniture"
    assert furniture.objects == ["Furniture.001", "Bed_0.001"]
    (desk,) = furniture.branches.values()
    assert desk.name == "Bedroom_1 Desk_0"
    assert desk.objects == ["Desk_0", "Items", "Laptop_0"]
    assert "Bedroom_0.001" in house.branches["Cameras"].objects


def test_findings_are_readable_and_lead_to_the_culprits() -> None:
    bed, door = "/House/Rooms/A_0/Furniture/Bed_0", "/House/Rooms/A_0/Architecture/Geometry/Door_1"
    certificate = {
        "valid": True,
        "collisions": [{"a": bed, "b": door, "depth_m": 0.1}],
        "blocked_openings": [door],
        "walkable": 0.91,
    }
    first, second = report.findings(certificate)
    assert first.text == "A_0/Bed_0 and A_0/Geometry/Door_1 collide"
    assert first.paths == (bed, door)
    assert second.text.endswith("is blocked")
    assert report.headline(certificate) == "2 findings; 91% of the floor is walkable"
    assert report.headline({"valid": True, "walkable": 1.0}).startswith("Certified")


def test_the_panel_has_four_states(tmp_path: Path) -> None:
    assert panel_state(None, "", "").phase == "EMPTY"
    assert panel_state(None, "house.usda", "").phase == "DONE"
    assert panel_state(None, "house.usda", "broken").phase == "FAILED"
    running = panel_state(Job(["chord-usd"]), "", "broken")
    assert running.phase == "RUNNING"
    assert not running.can_start


@pytest.mark.parametrize("text", ["", "short", "many words " * 12, "/a/very/long/path" * 9])
def test_lines_fit_the_sidebar_and_lose_nothing(text: str) -> None:
    lines = wrapped(text, 42)
    assert all(len(line) <= 42 for line in lines)
    assert "".join("".join(lines).split()) == "".join(text.split())


def moved(x: float) -> edits.Matrix:
    return ((1.0, 0.0, 0.0, x), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


BED, DESK = (f"/House/Rooms/Bedroom_{n}/Furniture/Bed_0" for n in (0, 1))


CHAIR = "/House/Rooms/Bedroom_0/Furniture/Chair_0"
ITEM = f"{BED}/Items/Book_0"


def test_only_what_was_touched_is_an_edit() -> None:
    was = {BED: moved(0.0), ITEM: moved(0.0), DESK: moved(1.0), CHAIR: moved(2.0)}
    assert edits.moves(was, was, {}) == {}
    now = {BED: moved(0.5), ITEM: moved(0.0), DESK: moved(1.0)}
    found = edits.moves(was, now, {})
    assert found == {
        BED: edits.Edit(moved(0.0), moved(0.5)),
        CHAIR: edits.Edit(moved(2.0), None),
    }
    assert list(edits.moves(was, {DESK: moved(1.0), CHAIR: moved(2.0)}, {})) == [BED], (
        "what stood on a removed piece is gone with it"
    )


def test_an_edit_that_is_undone_is_none_after_the_house_was_opened_again() -> None:
    changes = edits.Changes(pieces={BED: edits.Edit(moved(0.0), moved(0.5))})
    was = edits.placements_of_house({BED: moved(0.5), DESK: moved(1.0)}, changes)
    assert was == {BED: moved(0.0), DESK: moved(1.0)}
    assert edits.moves(was, {BED: moved(0.0), DESK: moved(1.0)}, {}) == {}


def test_an_edit_of_a_piece_that_the_house_has_no_more_is_passed_over() -> None:
    changes = edits.Changes(pieces={BED: edits.Edit(moved(0.0), moved(0.5))})
    assert edits.placements_of_house({DESK: moved(1.0)}, changes) == {DESK: moved(1.0)}


SWAP = edits.Swap(
    "assets/B/B.usda", (1.6, 2.0, 0.9), (0.0, 0.1), (1.6, 1.8, 1.0), {"colour": "oak"}
)
ROOM = "/House/Rooms/Bedroom_0"
ALL = edits.Changes(
    pieces={
        BED: edits.Edit(moved(0.0), moved(0.25), SWAP),
        CHAIR: edits.Edit(moved(2.0), moved(2.5)),
        DESK: edits.Edit(moved(1.0), None),
    },
    looks={ROOM: {"floorMaterial": "Oak"}, "/House": {"lighting": "evening"}},
    lights={f"{ROOM}/Lights/AreaLight": 2.0},
    locked=(BED,),
)


def test_a_room_furnished_anew_keeps_the_edits_of_what_is_locked() -> None:
    left = edits.without_room(ALL, "Bedroom_0")
    assert set(left.pieces) == {BED, DESK}
    assert left.looks == ALL.looks
    assert set(edits.without_room(ALL, "Bedroom_1").pieces) == {BED, CHAIR}


def test_the_edits_of_a_room_can_be_dropped() -> None:
    left = edits.as_it_was(ALL, "Bedroom_0")
    assert set(left.pieces) == {DESK}
    assert left.looks == {"/House": {"lighting": "evening"}}
    assert left.lights == {}


def test_what_is_done_while_the_program_works_is_carried_over() -> None:
    before = edits.Changes(
        pieces={CHAIR: edits.Edit(moved(2.0), moved(2.5)), DESK: ALL.pieces[DESK]}
    )
    wanted = edits.Changes(pieces={**before.pieces, BED: ALL.pieces[BED]})
    now = edits.Changes(
        pieces={BED: edits.Edit(moved(0.0), moved(9.0)), CHAIR: edits.Edit(moved(2.0), moved(3.0))},
        lights={"lamp": 2.0},
        locked=(DESK,),
    )
    merged = edits.carried_over(wanted, before, now)
    assert merged.pieces == {BED: ALL.pieces[BED], CHAIR: now.pieces[CHAIR]}
    assert merged.lights == {"lamp": 2.0}
    assert merged.locked == (DESK,)
    assert edits.carried_over(wanted, before, before) == wanted


def test_a_look_is_chosen_where_it_belongs() -> None:
    room = edits.with_look(ALL, ROOM, "wallMaterial", "Plaster")
    assert room.looks[ROOM] == {"floorMaterial": "Oak", "wallMaterial": "Plaster"}
    bed = edits.with_look(ALL, BED, "colour", "white")
    assert bed.swaps[BED].looks == {"colour": "white"}
    assert BED not in bed.looks
    assert edits.with_look(ALL, CHAIR, "colour", "white").looks[CHAIR] == {"colour": "white"}


def test_changes_come_back_from_their_layer(tmp_path: Path) -> None:
    house = tmp_path / "hôuse.usda"
    file = layer.write_changes(house, ALL)
    assert file is not None
    assert layer.opened_file(house) == file
    assert layer.house_of(file) == house == layer.house_of(house)
    assert layer.read_changes(house) == ALL
    assert layer.write_changes(house, edits.Changes()) is None
    assert layer.opened_file(house) == house
    assert layer.read_changes(house).is_nothing


@pytest.mark.parametrize("text", ["#usda 1.0", "", "string chord_edits = '''{}'''"])
def test_a_foreign_layer_is_left_alone(tmp_path: Path, text: str) -> None:
    house = tmp_path / "house.usda"
    layer.edits_file(house).write_text(text, encoding="utf-8")
    assert layer.read_changes(house).is_nothing


def test_a_swapped_model_stands_as_the_piece_did() -> None:
    """Quarter turn, scaled by two: the offset turns with it, the scale is the model's own."""
    turned: edits.Matrix = (
        (0.0, -2.0, 0.0, 5.0), (2.0, 0.0, 0.0, 3.0), (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    )  # fmt: skip
    placed = swaps.placed(turned, None, SWAP, (1.6, 1.8, 0.5))
    assert placed[0] == pytest.approx((0.0, -1.0, 0.0, 4.9))
    assert placed[1] == pytest.approx((1.0, 0.0, 0.0, 3.0))
    assert placed[2] == pytest.approx((0.0, 0.0, 2.0, 0.0))
    again = swaps.placed(placed, SWAP, SWAP, (1.6, 1.8, 0.5))
    assert edits.same(placed, again), "swapping does not drift"
    assert swaps.raised(placed, 0.2)[2][3] == pytest.approx(0.2)


NEAREST = {
    "id": "Bed_A", "usd": "lib/Bed_A/Bed_A.usda", "size_m": [1.6, 1.8, 0.5],
    "fits": {"center_m": [0.0, 0.1, 0.0], "size_m": [1.6, 1.8, 0.5]},
    "looks": {"colour": ["oak", "white"]}, "picture": "",
}  # fmt: skip


def test_a_swap_keeps_the_colour_where_the_model_has_it() -> None:
    (model,) = swaps.candidates({"assets": [NEAREST]})
    assert model.label == "Bed A, 1.60 × 1.80 m"
    assert model.picture is None
    assert swaps.swap_for(model, (1.6, 2.0, 0.9), "x", "white").looks == {"colour": "white"}
    assert swaps.swap_for(model, (1.6, 2.0, 0.9), "x", "blue").looks == {"colour": "oak"}


def test_a_model_is_copied_beside_the_house_once(tmp_path: Path) -> None:
    usd = tmp_path / "lib" / "Bed_A" / "Bed_A.usda"
    usd.parent.mkdir(parents=True)
    usd.write_text("#usda 1.0", encoding="utf-8")
    house = tmp_path / "höuse" / "house.usda"
    for _ in range(2):
        assert swaps.bring_model(usd, house) == "assets/Bed_A/Bed_A.usda"
    assert [file.name for file in (house.parent / "assets").iterdir()] == ["Bed_A"]
    assert (house.parent / "assets" / "Bed_A" / "Bed_A.usda").is_file()


def test_what_stands_in_a_room_is_told_apart() -> None:
    assert is_placed(BED)
    assert is_placed(ITEM)
    assert piece_of(ITEM) == BED
    assert room_of(ITEM) == "Bedroom_0"
    assert is_light(f"{ROOM}/Lights/AreaLight")
    for path in (ROOM, f"{ROOM}/Furniture", "/House/Cameras/Top"):
        assert not is_placed(path)
        assert piece_of(path) == ""
    assert room_of("/House/Cameras/Top") == ""


def test_looks_are_listed_where_there_is_a_choice() -> None:
    several = {"chosen": "OakPlank", "offered": ["OakPlank", "Terrazzo"]}
    contents = {
        "looks": {"lighting": {"chosen": "day", "offered": ["day"]}},
        "rooms": [
            {
                "path": ROOM,
                "looks": {"floorMaterial": several},
                "furniture": [{"component": BED, "asset": "Bed_A", "looks": {"colour": several}}],
            }
        ],
    }
    room, bed = report.looks(contents)
    assert (room.path, room.label, room.chosen) == (ROOM, "Floor", "OakPlank")
    assert (bed.path, bed.label) == (BED, "Colour")
    assert report.models(contents) == {BED: "Bed_A"}
    assert report.spaced("OakPlank_2") == "Oak Plank 2"
    assert report.spaced("TVCabinet_0") == "TV Cabinet 0"


def test_catalogs_stay_the_same() -> None:
    text = library.catalogs(["bed", "dining_table"])
    assert text == library.catalogs(["dining_table", "bed"])
    assert f"{library.catalog_id('bed')}:CHOrD furniture/Bed:CHOrD furniture-Bed" in text
    assert library.command("/blender", "python", Path("x"))[0] == "/blender"
    assert library.command("", "python", Path("x"))[0] == "python"


def test_the_last_report_counts() -> None:
    assert last_report(["Blender 5.0", '{"a": 1}', "Blender quit"]) == {"a": 1}
    assert last_report(["[1]", "none"]) is None
