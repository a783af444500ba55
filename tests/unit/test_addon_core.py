"""What the Blender panel decides, without Blender."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from blender_addon.core import commands, edits, layer, library, report
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
    room_path,
    shown_names,
    storeys,
    usd_paths,
)

ROOT = Path(__file__).parents[2]

FURNISH = {"seed": 3}
SETTINGS = commands.GenerateSettings("PLAN", "", "", FURNISH)


def test_core_does_without_blender() -> None:
    code = "import sys, blender_addon.core.commands, blender_addon.core.job; assert 'bpy' not in "
    subprocess.run([sys.executable, "-c", code + "sys.modules"], check=True, cwd=ROOT)


def test_the_extension_is_built_by_the_python_named_without_setting_it_up() -> None:
    def steps(*names: str) -> str:
        command = ["make", "-B", "-n", "extension", "PYTHON=python3.11", *names]
        return subprocess.run(command, capture_output=True, check=True, text=True, cwd=ROOT).stdout

    assert "pip install" in steps()
    assert "pip install" not in steps("BIN=/srv/bpy/bin")
    assert "/srv/bpy/bin/python" in steps("BIN=/srv/bpy/bin")


def test_names_are_as_short_as_no_other_has_them() -> None:
    rooms = "/House/Rooms"
    wanted = {
        "/House": "House",
        rooms: "Rooms",
        f"{rooms}/Study_0": "Study_0",
        f"{rooms}/Study_0/Furniture/Desk_0": "Desk_0",
        f"{rooms}/Study_0/Furniture/Chair_0": "Study_0 Chair_0",
        f"{rooms}/Hall_0/Furniture/Chair_0": "Hall_0 Chair_0",
        f"{rooms}/Hall_0/Architecture/Door_0/Frame": "Hall_0 Door_0 Frame",
        f"{rooms}/Hall_0/Architecture/Door_1/Frame": "Hall_0 Door_1 Frame",
        "/House/Cameras/Study_0": "Camera Study_0",
    }
    assert shown_names(wanted) == wanted


def script(folder: Path, body: str) -> Path:
    """An executable Python script."""
    file = folder / "chord usd é"  # spaces and letters that are not ASCII
    file.write_text(f"#!{sys.executable}\n{body}\n", encoding="utf-8")
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return file


def test_a_history_is_listed_with_the_latest_change_first() -> None:
    changes = [
        {"number": 1, "verb": "begin", "words": "the house as it was"},
        {"number": 2, "verb": "outside", "words": ""},
        {"number": 4, "verb": "edit", "words": "no rug"},
    ]
    assert report.past({"number": 2, "changes": changes}) == [
        (4, "4: edit no rug"),
        (2, "2: by hand, or by another program (now)"),
        (1, "1: As it was"),
    ]


def test_planning_numbers_are_said_in_their_units_the_worst_room_first() -> None:
    finding = {
        "rule": "beside the bed",
        "source": "HUD",
        "items": ["/House/Rooms/B_0/Furniture/Bed_0"],
    }
    metres = {**finding, "unit": "m", "have_m": 0.55, "need_m": 0.6}
    endless = {**finding, "unit": "m", "have_m": None, "need_m": 2.0}
    turned = {**finding, "unit": "deg", "have": 10.67, "need": 8, "items": []}
    rooms = [
        {"path": "/House/Rooms/A_0", "rules": 9, "rules_kept": 8, "findings": [turned]},
        {"path": "/House/Rooms/B_0", "rules": 9, "rules_kept": 7, "findings": [metres, endless]},
    ]
    home = {"path": "", "rules": 3, "rules_kept": 3, "findings": []}
    assert report.planning({"design": {"rooms": rooms, "home": home}}) == [
        report.Finding("B_0, beside the bed: 55 cm, not 60 cm (HUD)", tuple(finding["items"])),
        report.Finding("B_0, beside the bed: endless, not 200 cm (HUD)", tuple(finding["items"])),
        report.Finding("A_0, beside the bed: 11°, not 8° (HUD)", ("/House/Rooms/A_0",)),
    ]
    assert report.planning({}) == []


def test_what_an_import_has_rounded_is_saved_as_it_was() -> None:
    here = ((1.0, 0.0, 0.0, 0.1), (0.0, 1.0, 0.0, 0.2), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    near = ((1.0, 0.0, 0.0, 0.1000001), *here[1:])
    far = ((1.0, 0.0, 0.0, 0.2), *here[1:])
    saved = edits.Changes(pieces={"/a": edits.Edit(here, far)}, lights={"/l": 2.0})
    rounded = edits.Changes(pieces={"/a": edits.Edit(near, far)}, lights={"/l": 2.00001})
    moved = edits.Changes(pieces={"/a": edits.Edit(near, near)}, lights={"/l": 3.0})
    assert edits.as_saved(rounded, saved) == saved
    assert edits.as_saved(moved, saved) == moved


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
    assert kept == {"HOME": "/me", "PYTHONUTF8": "1", "CHORD_USD_SURFACE": "panel"}


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
    furnish = {
        "seed": 3, "steps": 8, "asset_folders": str(tmp_path), "tabletop": False,
        "dressing": False, "m_per_px": 0.0125, "part": 2, "roof": "hip", "style": "modern",
    }  # fmt: skip
    settings = commands.GenerateSettings("PLAN", str(plan), "", furnish)
    pictures = commands.RenderSettings(("Bedroom_0",), 16, (640, 2160), ("rgb", "depth"))
    layer.write_changes(house, edits.Changes(locked=(BED,)))
    for arguments in (
        commands.generate(settings, house),
        commands.regenerate(house, "Bedroom_0", furnish, keep=["Bed_0"]),
        commands.edit(house, "-turn the sofa", str(tmp_path), only_read=True),
        commands.check(house),
        commands.describe(house),
        commands.nearest("bed", (1.6, 2.0, 0.9), tmp_path, str(tmp_path)),
        commands.build_assets(tmp_path),
        commands.render(house, tmp_path / "pictures", pictures),
        commands.farm(house, tmp_path / "job", pictures),
    ):
        build_parser().parse_args(arguments)


def test_usual_values_are_no_words(
    tmp_path: Path,
) -> None:
    plan = tmp_path / "plan.png"
    plan.touch()
    bare = commands.GenerateSettings("PLAN", str(plan), "", FURNISH)
    assert "--roof" not in commands.generate(bare, tmp_path / "house.usda")


def test_what_the_program_is_told_is_the_edited_house(tmp_path: Path) -> None:
    house = tmp_path / "house.usda"
    house.touch()
    assert "--edits" not in commands.regenerate(house, "Bedroom_0", FURNISH)
    file = layer.write_changes(house, edits.Changes(locked=(BED,)))
    for words in (
        commands.regenerate(house, "Bedroom_0", FURNISH), commands.edit(house, "remove the bed")
    ):  # fmt: skip
        assert words[1] == str(house), "the house itself is written"
        assert words[words.index("--edits") + 1] == str(file)
    assert commands.check(house)[1] == str(file)


def test_wishes_reach_the_program_as_they_were_written(tmp_path: Path) -> None:
    from chord_usd.cli import build_parser

    house = tmp_path / "house.usda"
    house.touch()
    wishes = commands.RoomWishes(" -desk, two chairs ", "sofa")
    words = commands.regenerate(house, "Bedroom_0", FURNISH, ["Bed_0"], wishes)
    taken = build_parser().parse_args(words)
    assert (taken.wanted, taken.without) == (["-desk, two chairs"], ["sofa"])
    blank = commands.regenerate(house, "Bedroom_0", FURNISH, [], commands.RoomWishes(" ", ""))
    taken = build_parser().parse_args(blank)
    assert taken.wanted is taken.without is None


def test_passes_are_those_of_the_program() -> None:
    from chord_usd.line.image.options import PASSES

    assert set(commands.PASSES) == set(PASSES)


def test_plans_are_those_that_the_program_reads() -> None:
    from chord_usd.faces.batch.work_units import PLAN_SUFFIXES
    from chord_usd.line.plan.vector import SUFFIXES

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


def test_a_storey_is_a_collection_around_its_rooms() -> None:
    upstairs = "/House/Rooms/Storey_1/Bedroom_1"
    paths = {
        "a": "/House/Rooms/Storey_0/Bedroom_0/Furniture/Bed_0",
        "b": f"{upstairs}/Furniture/Desk_0/Items/Laptop_0",
        "c": "/House/Exterior/Storey_1/Geometry/Facade",
        "d": f"{upstairs}/Lights/AreaLight",
    }
    assert room_names(paths.values()) == ["Bedroom_0", "Bedroom_1"]
    assert [is_piece(path) for path in paths.values()] == [True, False, False, False]
    assert piece_of(paths["b"]) == f"{upstairs}/Furniture/Desk_0"
    assert room_path(paths.values(), "Bedroom_1") == upstairs
    assert storeys(paths.values()) == ["Storey_0", "Storey_1"]
    house = collection_tree(paths)
    assert list(house.branches) == ["Storey_0", "Storey_1"]
    assert list(house.branches["Storey_1"].branches) == ["Bedroom_1"]
    assert house.branches["Storey_1"].objects == ["c"]


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


BED = "/House/Rooms/Bedroom_0/Furniture/Bed_0"
ITEM = f"{BED}/Items/Book_0"
ROOM = "/House/Rooms/Bedroom_0"


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
    assert report.is_offered(contents, BED, "colour", "Terrazzo")
    for choice in (("", "", ""), (BED, "colour", "Oak"), ("/House", "colour", "Terrazzo")):
        assert not report.is_offered(contents, *choice)
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
