"""What the Blender panel decides, without Blender."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from blender_addon.core import commands, edits, report
from blender_addon.core.job import Job, Outcome, plain_error
from blender_addon.core.program import ProgramError, clean_environment, command_of, find_program
from blender_addon.core.state import panel_state, wrapped
from blender_addon.core.tree import collection_tree, is_piece, room_names, usd_paths

ROOT = Path(__file__).parents[2]

SETTINGS = commands.GenerateSettings("PLAN", "", "", seed=3, steps=0, assets="")


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


def test_a_missing_program_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match="There is no file"):
        find_program(str(tmp_path / "nowhere"))
    with pytest.raises(ProgramError, match="no chord-usd in the folder"):
        find_program(str(tmp_path))


def test_a_python_runs_the_package() -> None:
    assert command_of(Path(sys.executable))[1:] == ("-m", "chord_usd")


def test_blenders_own_python_does_not_leak() -> None:
    kept = clean_environment({"PYTHONHOME": "/blender", "PYTHONPATH": "/addons", "HOME": "/me"})
    assert kept == {"HOME": "/me"}


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
    with pytest.raises(commands.InputError, match="Choose a floor plan"):
        commands.generate(SETTINGS, tmp_path / "house.usda")
    gone = commands.GenerateSettings("PLAN", str(tmp_path / "gone.png"), "", 3, 0, "")
    with pytest.raises(commands.InputError, match="not there"):
        commands.generate(gone, tmp_path / "house.usda")
    wordless = commands.GenerateSettings("TEXT", "", "  ", 3, 0, "")
    with pytest.raises(commands.InputError, match="Describe"):
        commands.generate(wordless, tmp_path / "house.usda")
    with pytest.raises(commands.InputError, match="Generate it again"):
        commands.check(tmp_path / "house.usda")


def test_commands_are_ones_that_chord_usd_takes(tmp_path: Path) -> None:
    from chord_usd.cli import build_parser

    plan, house = tmp_path / "plän 1.png", tmp_path / "house.usda"
    plan.touch()
    house.touch()
    settings = commands.GenerateSettings("PLAN", str(plan), "", 3, 8, str(tmp_path))
    for arguments in (
        commands.generate(settings, house),
        commands.regenerate(house, "Bedroom_0", 5),
        commands.check(house),
        commands.render(house, tmp_path / "pictures", ["Bedroom_0"], 16, (640, 360)),
    ):
        build_parser().parse_args(arguments)


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
    assert "Bed_0.001" in furniture.objects
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


def test_only_what_was_touched_is_an_edit() -> None:
    before = {BED: moved(0.0), DESK: moved(1.0), "/House/Rooms/Bedroom_0/Furniture/X": moved(2.0)}
    after = {BED: moved(0.5), DESK: moved(1.0)}
    found = edits.changes(before, after)
    assert found == {
        BED: edits.Edit(moved(0.5)),
        "/House/Rooms/Bedroom_0/Furniture/X": edits.Edit(None),
    }
    assert edits.without_room(found, "Bedroom_0") == {}
    assert edits.without_room(found, "Bedroom_1") == found


def test_edits_come_back_from_their_layer(tmp_path: Path) -> None:
    house = tmp_path / "hôuse.usda"
    saved = {BED: edits.Edit(moved(0.25)), DESK: edits.Edit(None)}
    file = edits.write_edits(house, saved)
    assert file is not None
    assert edits.opened_file(house) == file
    assert edits.read_edits(house) == saved
    assert edits.write_edits(house, {}) is None
    assert edits.opened_file(house) == house
    assert edits.read_edits(house) == {}


def test_a_foreign_layer_is_left_alone(tmp_path: Path) -> None:
    house = tmp_path / "house.usda"
    edits.edits_file(house).write_text("#usda 1.0", encoding="utf-8")
    assert edits.read_edits(house) == {}
