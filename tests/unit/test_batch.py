"""A batch: what is due, what is listed, what is shared. Houses are a few lines of text here."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import tarfile
from dataclasses import replace
from pathlib import Path

import batch_makers as makers
import pytest

from chord_usd.base.errors import OutputError, PlanError
from chord_usd.base.runtime.scratch import PREFIX
from chord_usd.cli import UNUSABLE, build_parser, main
from chord_usd.faces.batch.index import rows, write_parquet
from chord_usd.faces.batch.lock import locked
from chord_usd.faces.batch.make import STAGE_FILE
from chord_usd.faces.batch.records import HOUSE_RECORD, PICTURES_RECORD, Record, write_record
from chord_usd.faces.batch.run import Exports, find_due, run_batch
from chord_usd.faces.batch.shards import write_shards
from chord_usd.faces.batch.shared import keep_pictures, share_files
from chord_usd.faces.batch.work_units import list_units
from chord_usd.faces.commands.batch import settings_of
from chord_usd.line.pipeline import Settings


def test_houses_of_a_batch_get_the_roof_that_is_asked_for() -> None:
    asked = build_parser().parse_args(["batch", "plan.png", "-o", "houses", "--roof", "hip"])
    assert settings_of(asked).roof == "hip"
    assert main(["batch", "plan.png", "-o", "houses", "--roof", "thatch"]) == UNUSABLE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "houses"


class TestUnits:
    @pytest.fixture
    def plans(self, tmp_path: Path) -> Path:
        for name in ("a/plan.png", "b/plan.png", "b/second floor.v2.PNG", "b/notes.txt"):
            file = tmp_path / name
            file.parent.mkdir(exist_ok=True)
            file.write_text(name)
        return tmp_path

    def test_one_for_each_plan_and_seed_under_a_name_of_its_own(self, plans: Path) -> None:
        units = list_units([plans / "a", plans / "b"], 2, range(3, 5), Settings())
        assert [unit.name for unit in units[::2]] == [
            "a-plan-3", "b-plan-3", "second_floor_v2-3",
            "procedural_000000-3", "procedural_000001-3",
        ]  # fmt: skip
        assert [unit.seed for unit in units[:2]] == [3, 4]

    def test_the_recipe_follows_the_plan_and_the_settings(self, plans: Path) -> None:
        def recipe(settings: Settings) -> dict:
            return dict(list_units([plans / "a"], 0, [0], settings)[0].recipe)

        before = recipe(Settings())
        assert recipe(Settings(device="cpu")) == before
        assert recipe(Settings(steps=3)) != before
        (plans / "a/plan.png").write_text("another")
        assert recipe(Settings()) != before

    @pytest.mark.parametrize(
        ("names", "what"),
        [
            (["missing.png"], "no such file"),
            (["empty"], "holds no plan"),
            (["a/plan.png", "c/a/plan.png"], "2 plans have this name"),
        ],
    )
    def test_plans_that_are_no_use_are_told_before_anything_is_made(
        self, plans: Path, names: list[str], what: str
    ) -> None:
        (plans / "empty").mkdir()
        (plans / "c/a").mkdir(parents=True)
        (plans / "c/a/plan.png").write_text("another")
        with pytest.raises(PlanError, match=what):
            list_units([plans / name for name in names], 0, [0], Settings())


class TestResume:
    def test_finished_houses_are_kept(self, folder: Path) -> None:
        makers.batch(folder, makers.units("a", "b"))
        done = makers.batch(folder, makers.units("a", "b", "c"))
        assert makers.made(folder) == ["a", "b", "c"]
        assert [unit.name for unit in done.kept] == ["a", "b"]

    @pytest.mark.parametrize(
        ("file", "damage"),
        [
            *((STAGE_FILE, damage) for damage in ("missing", "short", "zeroed", "flipped")),
            ("assets/Chair/Chair.usda", "missing"),
            (HOUSE_RECORD, "missing"),
            (HOUSE_RECORD, "short"),
        ],
    )
    def test_a_damaged_house_is_made_again_and_no_other(
        self, folder: Path, file: str, damage: str
    ) -> None:
        units = makers.units("a", "b")
        makers.batch(folder, units)
        target = folder / "b" / file
        data = bytearray(target.read_bytes())
        if damage == "flipped":
            data[len(data) // 2] ^= 1
        changed = {"short": data[: len(data) // 2], "zeroed": bytes(len(data)), "flipped": data}
        target.unlink()
        if damage != "missing":
            target.write_bytes(changed[damage])
        makers.batch(folder, units)
        assert makers.made(folder) == ["a", "b", "b"]
        assert find_due(units, makers.order(folder)) == ()

    def test_other_settings_make_other_houses(self, folder: Path) -> None:
        makers.batch(folder, makers.units("a", "b"))
        others = [replace(unit, recipe={"steps": 3}) for unit in makers.units("a")]
        makers.batch(folder, [*others, makers.unit("b")])
        assert makers.made(folder) == ["a", "b", "a"]

    def test_what_a_killed_worker_half_wrote_is_swept(self, folder: Path) -> None:
        makers.batch(folder, makers.units("a"))
        (folder / "a" / "pictures").mkdir()
        code = (
            "import os, sys, pathlib; from chord_usd.base.runtime.scratch import Scratch\n"
            "made = [Scratch(pathlib.Path(one)) for one in sys.argv[1:]]; os.kill(os.getpid(), 9)"
        )
        places = [folder, folder / "a", folder / "a" / "pictures"]
        subprocess.run([sys.executable, "-c", code, *places], check=False)
        assert len(list(folder.rglob(f"{PREFIX}*"))) == 3
        makers.batch(folder, makers.units("a"))
        assert list(folder.rglob(f"{PREFIX}*")) == []


class TestOneAtATime:
    def test_a_second_batch_in_one_folder_is_refused(self, folder: Path) -> None:
        folder.mkdir()
        with locked(folder), pytest.raises(OutputError, match=f"process {os.getpid()}"):
            makers.batch(folder, makers.units("a"))
        assert makers.made(folder) == []
        makers.batch(folder, makers.units("a"))

    def test_the_command_line_says_so_in_one_line(
        self, folder: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        folder.mkdir()
        with locked(folder):
            assert main(["batch", "--synth", "1", "-o", str(folder)]) == UNUSABLE
        told = capsys.readouterr().err
        assert re.fullmatch(r"error: .+another batch is at work here.+\n", told)

    def test_a_batch_that_was_killed_holds_nothing(self, folder: Path) -> None:
        folder.mkdir()
        code = (
            "import os, pathlib, chord_usd.faces.batch.lock as lock\n"
            f"with lock.locked(pathlib.Path({str(folder)!r})): os._exit(9)"
        )
        assert subprocess.run([sys.executable, "-c", code]).returncode == 9
        assert list(folder.iterdir())
        with locked(folder):
            pass
        assert not list(folder.iterdir())


def test_failures_are_listed_and_the_rest_is_made(folder: Path) -> None:
    done = makers.batch(folder, makers.units("a", "unreadable", "bug", "b"), makers.troubled)
    assert [unit.name for unit in done.made] == ["a", "b"]
    told = {result.unit.name: result.why for result in done.failures}
    assert told == {
        "bug": "unexpected ZeroDivisionError: two lines",
        "unreadable": "unreadable: shows no rooms",
    }
    listed = [json.loads(line) for line in (folder / "index.jsonl").read_text().splitlines()]
    assert [(row["house"], row["status"]) for row in listed] == [
        ("a", "done"), ("b", "done"), ("bug", "failed"), ("unreadable", "failed"),
    ]  # fmt: skip
    kept = json.loads((folder / "failures" / "bug.json").read_text())
    assert any("ZeroDivisionError" in line for line in kept["log"])


def test_a_house_whose_plan_cannot_be_read_any_more_is_not_listed_as_done(folder: Path) -> None:
    """Its older house is there; neither this run nor one of other plans takes it for an answer."""
    makers.batch(folder, makers.units("unreadable"))
    changed = [makers.unit("unreadable", seed=1)]
    assert makers.batch(folder, changed, makers.troubled).holding == 0
    makers.batch(folder, makers.units("b"))
    assert [(row["house"], row["status"]) for row in rows(folder)] == [
        ("b", "done"), ("unreadable", "failed"),
    ]  # fmt: skip
    makers.batch(folder, changed)
    assert [row["status"] for row in rows(folder)] == ["done", "done"]
    assert list((folder / "failures").glob("*.json")) == []


def test_the_index_of_a_data_set_holds_its_own_houses_alone(folder: Path) -> None:
    makers.batch(folder, makers.units("a", "b"))
    done = makers.batch(folder, makers.units("a"), exports=Exports(named_only=True))
    assert done.holding == 1
    listed = [json.loads(line) for line in (folder / "index.jsonl").read_text().splitlines()]
    assert [row["house"] for row in listed] == ["a"]


def test_a_house_that_takes_too_long_fails_and_the_rest_is_made(folder: Path) -> None:
    order = replace(makers.order(folder), timeout_s=0.3)
    units = makers.units("a", "long", "b")
    done = run_batch(units, order, makers.Here(), load=makers.troubled(folder))
    assert makers.made(folder) == ["a", "b"]
    assert "long: took longer than 0.005 minutes" in done.failures[0].why


class TestFullDisk:
    def test_it_ends_the_batch_and_keeps_what_is_finished(self, folder: Path) -> None:
        with pytest.raises(OutputError, match=r"the disk is full; 1 of 3 houses were made"):
            makers.batch(folder, makers.units("a", "full", "b"), makers.troubled)
        assert makers.made(folder) == ["a"]
        assert sorted(path.name for path in folder.iterdir()) == ["a", "assets"]


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["missing.png"],
        ["--synth", "0"],
        ["--synth", "1", "--gpus", "0.5"],
        ["--synth", "1", "--address", "head:6379"],
        ["--synth", "1", "--engine", "dask"],
        ["--synth", "1", "--renders", "--passes", "colour"],
    ],
    ids=" ".join,
)
def test_an_unusable_command_line_makes_nothing(
    words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["batch", *words, "-o", str(folder)]) == UNUSABLE
    assert re.fullmatch(r"error: .+\n", capsys.readouterr().err)
    assert not folder.exists()


class TestSharing:
    @pytest.fixture
    def house(self, tmp_path: Path) -> Path:
        return self.write(tmp_path / "house", b"chair")

    @staticmethod
    def write(house: Path, data: bytes) -> Path:
        (house / "assets/Chair").mkdir(parents=True)
        (house / "assets/Chair/Chair.usda").write_bytes(data)
        return house

    def test_houses_share_one_copy_on_disk(self, folder: Path) -> None:
        makers.batch(folder, makers.units("a", "b"))
        files = [folder / name / "assets/Chair/Chair.usda" for name in ("", "a", "b")]
        assert len({file.stat().st_ino for file in files}) == 1

    def test_each_keeps_what_it_has_where_a_name_means_another_file(
        self, tmp_path: Path, house: Path
    ) -> None:
        other = self.write(tmp_path / "other", b"stool")
        for one in (house, other):
            share_files(one, tmp_path)
        assert (house / "assets/Chair/Chair.usda").read_bytes() == b"chair"
        assert (other / "assets/Chair/Chair.usda").read_bytes() == b"stool"
        assert (tmp_path / "assets/Chair/Chair.usda").read_bytes() == b"chair"
        assert [file.name for file in (house / "assets/Chair").iterdir()] == ["Chair.usda"]

    @pytest.mark.parametrize("name", ["assets", "assets/Chair"])
    @pytest.mark.parametrize("kind", ["file", "link"])
    def test_what_somebody_has_in_place_of_a_folder_stays(
        self, tmp_path: Path, house: Path, name: str, kind: str
    ) -> None:
        """A file ended every house of a batch; through a link it wrote into another folder."""
        taken = tmp_path / "batch" / name
        taken.parent.mkdir(parents=True)
        (tmp_path / "elsewhere").mkdir()
        if kind == "link":
            taken.symlink_to(tmp_path / "elsewhere")
        else:
            taken.write_text("a list")
        share_files(house, tmp_path / "batch")
        assert list((tmp_path / "elsewhere").iterdir()) == []
        assert taken.is_symlink() or taken.read_text() == "a list"
        assert (house / "assets/Chair/Chair.usda").read_bytes() == b"chair"

    def test_pictures_outlive_their_house(self, tmp_path: Path, house: Path) -> None:
        (house / "pictures").mkdir()
        (house / "pictures/Top.png").write_bytes(b"from above")
        keep_pictures(house, tmp_path / "new", "pictures")
        assert (tmp_path / "new/pictures/Top.png").read_bytes() == b"from above"


class TestExports:
    @pytest.fixture
    def houses(self, folder: Path) -> Path:
        makers.batch(folder, makers.units("a", "b"))
        pictures = folder / "a" / "pictures"
        pictures.mkdir()
        for name in ("Top.png", "Top.exr", "Top.json", "coco.json"):
            (pictures / name).write_text(name)
        files = {f"pictures/{file.name}": "0" for file in pictures.iterdir()}
        write_record(Record({}, files), folder / "a" / PICTURES_RECORD)
        return folder

    def test_the_index_has_a_row_for_each_house_and_picture(self, houses: Path) -> None:
        listed = rows(houses)
        assert [(row["kind"], row["house"], row["path"]) for row in listed] == [
            ("house", "a", f"a/{STAGE_FILE}"),
            ("picture", "a", "a/pictures/Top.png"),
            ("house", "b", f"b/{STAGE_FILE}"),
        ]
        assert listed[0]["files"] == [
            f"a/{name}" for name in (STAGE_FILE, "layout.png", "plan.png", "scene.json")
        ]
        for row in (listed[0], listed[2]):
            for file, digest in zip(row["files"], row["sha256"], strict=True):
                assert hashlib.sha256((houses / file).read_bytes()).hexdigest() == digest

    def test_parquet_says_the_same(self, houses: Path) -> None:
        parquet = pytest.importorskip("pyarrow.parquet", reason="extra parquet")
        listed = rows(houses)
        table = parquet.read_table(write_parquet(listed, houses)).to_pylist()
        assert [
            {key: row[key] for key in told} for told, row in zip(listed, table, strict=True)
        ] == (listed)
        assert table[1]["rooms"] is None

    def test_shards_hold_every_sample_whole_and_are_the_same_every_time(self, houses: Path) -> None:
        listed = rows(houses)
        shards = write_shards(listed, houses, shard_bytes=1)
        before = [shard.read_bytes() for shard in shards]
        assert [shard.name for shard in shards] == [
            "houses-000000.tar", "houses-000001.tar", "pictures-000000.tar",
        ]  # fmt: skip
        members = []
        for shard in shards:
            with tarfile.open(shard) as tar:
                members.append([member.name for member in tar])
        assert members == [
            ["a.layout.png", "a.plan.png", "a.scene.json"],
            ["b.layout.png", "b.plan.png", "b.scene.json"],
            ["a-Top.exr", "a-Top.json", "a-Top.png"],
        ]
        (houses / "a" / "plan.png").touch()
        again = write_shards(listed, houses, shard_bytes=1)
        assert [shard.read_bytes() for shard in again] == before

    def test_exports_are_asked_for(self, folder: Path) -> None:
        done = makers.batch(folder, makers.units("a"), exports=Exports(shards=True))
        assert [file.name for file in done.files] == ["index.jsonl", "houses-000000.tar"]
