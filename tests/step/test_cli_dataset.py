"""The dataset verbs, one after the other on one folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from chord_usd.cli import DONE, UNUSABLE, main

HOUSES = 3


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dataset") / "houses"
    words = ["dataset", "synth", "-o", str(folder), "--count", str(HOUSES), "--seed", "5"]
    assert main([*words, "--rasters", "--progress", "none"]) == DONE
    return folder


def told(capsys: pytest.CaptureFixture[str], *words: object) -> dict:
    capsys.readouterr()
    assert main([*map(str, words), "--json", "--progress", "none"]) == DONE
    return json.loads(capsys.readouterr().out)


def test_synth_names_houses_by_their_seed(houses: Path) -> None:
    suffixes = (".json", ".layout.png", ".plan.png")
    expected = sorted(f"house_{seed:06d}{suffix}" for seed in (5, 6, 7) for suffix in suffixes)
    assert sorted(path.name for path in houses.glob("house_*")) == expected


def test_a_house_depends_on_its_seed_alone(houses: Path, tmp_path: Path) -> None:
    main(["dataset", "synth", "-o", str(tmp_path / "one"), "--count", "1", "--seed", "6"])
    name = "house_000006.json"
    assert (tmp_path / "one" / name).read_bytes() == (houses / name).read_bytes()


def test_stats_count_what_is_there(houses: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = told(capsys, "dataset", "stats", houses)
    files = [json.loads(path.read_text()) for path in sorted(houses.glob("*.json"))]
    assert data["houses"] == HOUSES
    assert sum(data["rooms"].values()) == sum(len(file["rooms"]) for file in files)
    assert sum(data["items"].values()) == sum(len(file["furniture"]) for file in files)
    assert 0.0 <= data["empty_room_rate"] < 1.0


def test_import_copies_a_folder_of_houses(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told(capsys, "dataset", "import", houses, "-o", tmp_path / "copy")["houses"] == HOUSES
    for path in houses.glob("*.json"):
        assert (tmp_path / "copy" / path.name).read_bytes() == path.read_bytes()


def test_split_puts_every_house_into_one_part(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told(capsys, "dataset", "split", houses, "-o", tmp_path / "split.json")
    split = json.loads((tmp_path / "split.json").read_text())
    assert sorted(split["train"] + split["test"]) == sorted(p.stem for p in houses.glob("*.json"))


def test_draw_makes_a_picture(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told(capsys, "dataset", "draw", houses, "-o", tmp_path / "s.png")["houses"] == HOUSES
    assert (tmp_path / "s.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("verb", ["stats", "split", "draw", "import"])
def test_a_folder_without_houses_is_refused(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = [] if verb == "stats" else ["-o", str(tmp_path / "out")]
    assert main(["dataset", verb, str(tmp_path / "none"), *output]) == UNUSABLE
    assert capsys.readouterr().err.startswith("error: ")
    assert list(tmp_path.iterdir()) == []


def test_broken_files_are_passed_over_counted_and_listed(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "mixed"
    folder.mkdir()
    for path in houses.glob("*.json"):
        (folder / path.name).write_bytes(path.read_bytes())
    (folder / "broken.json").write_text("{")
    data = told(capsys, "dataset", "import", folder, "-o", tmp_path / "read")
    assert data["houses"] == HOUSES
    assert list(data["skipped"]) == ["broken"]
    assert told(capsys, "dataset", "stats", folder)["houses"] == HOUSES
    assert main(["dataset", "stats", str(folder), "--progress", "none"]) == DONE
    assert "warning: broken: is not JSON" in capsys.readouterr().err


def test_boxes_of_others_become_houses_in_which_nothing_collides(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = {
        "class_labels": ["double_bed", "nightstand", "ceiling_lamp"],
        "translations": [[0, 0.5, 0], [1.0, 0.3, 0], [0, 2.5, 0]],
        "sizes": [[0.9, 0.5, 1.0], [0.25, 0.3, 0.2], [0.2, 0.1, 0.2]],
        "angles": [[0.0], [0.0], [0.0]],
        "floor_plan_vertices": [[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]],
        "floor_plan_faces": [[0, 1, 2], [0, 2, 3]],
        "scene_type": "bedroom",
    }
    (tmp_path / "room.json").write_text(json.dumps(room))
    folder = tmp_path / "houses"
    words = ["dataset", "import", tmp_path / "room.json", "-o", folder, "--arrange"]
    assert told(capsys, *words)["arranged"] == {"pieces": 2, "moved": 2, "left_out": 0}
    assert json.loads((folder / "room.json").read_text())["leftOut"] == {"ceiling_lamp": 1}
    assert told(capsys, "dataset", "stats", folder)["scores"]["por"]["value"] == 0.0


def test_clean_leaves_good_houses_alone(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = told(capsys, "dataset", "clean", houses, "-o", tmp_path / "clean")
    assert data["houses"] == HOUSES
    assert data["removed"] == {}
    for path in houses.glob("*.json"):
        assert (tmp_path / "clean" / path.name).read_bytes() == path.read_bytes()


def test_stats_compare_with_other_houses(houses: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = told(capsys, "dataset", "stats", houses, "--against", houses)["against"]
    assert all(row["distance"] == 0.0 for row in rows)
