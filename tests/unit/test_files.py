"""Outputs appear whole or not at all."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from chord_usd.base.errors import OutputError
from chord_usd.base.runtime import files, interrupts
from chord_usd.base.runtime.files import deliver, output_folder, write_atomic
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.scratch import LOCK_FILE, PREFIX, scratch_folder
from chord_usd.base.runtime.targets import MANIFEST_FILE, FolderMode, begin_run


def everything_in(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes() if p.is_file() else b"<folder>"
        for p in folder.rglob("*")
        if p.name != MANIFEST_FILE
    }


@pytest.mark.parametrize("data", [b"\x00bytes", "text, ü"])
def test_write_atomic_writes_just_the_file(tmp_path: Path, data: bytes | str) -> None:
    write_atomic(tmp_path / "new" / "a.json", data)
    expected = data if isinstance(data, bytes) else data.encode()
    assert everything_in(tmp_path) == {"new": b"<folder>", "new/a.json": expected}


def test_write_atomic_replaces_the_older_file(tmp_path: Path) -> None:
    write_atomic(tmp_path / "a", "old")
    write_atomic(tmp_path / "a", "new")
    assert everything_in(tmp_path) == {"a": b"new"}


def test_an_output_path_that_is_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="is a folder"):
        write_atomic(tmp_path, "x")


def test_a_parent_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="cannot be written"):
        write_atomic(tmp_path / "file" / "a", "x")


@pytest.mark.parametrize("stop", [KeyboardInterrupt, ValueError, SystemExit])
def test_a_stopped_delivery_leaves_everything_as_it_was(
    tmp_path: Path, stop: type[BaseException]
) -> None:
    (tmp_path / "old.usda").write_text("old")
    before = everything_in(tmp_path)
    with pytest.raises(stop), deliver() as delivery:
        stage = delivery.place(tmp_path / "old.usda")
        stage.write_text("new")
        (stage.parent / "assets").mkdir()
        (stage.parent / "assets" / "bed.usda").write_text("bed")
        delivery.place(tmp_path / "deep" / "er" / "layout.png").write_bytes(b"png")
        raise stop
    assert everything_in(tmp_path) == before


def test_a_failure_in_the_middle_of_the_moves_is_undone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "b"):
        (tmp_path / name).write_text(f"old {name}")
    before = everything_in(tmp_path)
    real_replace, calls = Path.replace, []

    def replace(self: Path, target: Path) -> Path:
        calls.append(target)
        if len(calls) == 2:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real_replace(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(OutputError, match="disk is full"), deliver() as delivery:
        delivery.place(tmp_path / "a").write_text("new a")
        delivery.place(tmp_path / "b").write_text("new b")
    assert everything_in(tmp_path) == before


def test_a_delivery_merges_folders_beside_its_target(tmp_path: Path) -> None:
    for name in ("one", "two"):
        with deliver() as delivery:
            stage = delivery.place(tmp_path / f"{name}.usda")
            stage.write_text(name)
            (stage.parent / "assets").mkdir()
            (stage.parent / "assets" / f"{name}.usda").write_text(name)
            (stage.parent / "assets" / "shared.usda").write_text("shared")
    assert sorted(everything_in(tmp_path)) == [
        "assets",
        "assets/one.usda",
        "assets/shared.usda",
        "assets/two.usda",
        "one.usda",
        "two.usda",
    ]


def test_a_folder_that_was_one_output_is_replaced_only_where_that_is_asked_for(
    tmp_path: Path,
) -> None:
    modes: list[FolderMode] = ["new", "replace", "replace"]
    for name, mode in zip(("first", "deep/second", "deep/third"), modes, strict=True):
        with output_folder(tmp_path / "out", mode) as folder:
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(name)
    assert sorted(everything_in(tmp_path)) == ["out", "out/deep", "out/deep/third"]
    assert not (tmp_path / MANIFEST_FILE).exists()
    with pytest.raises(OutputError, match="overwrite=True"), output_folder(tmp_path / "out"):
        pass


STRANGERS = {"thesis.txt": "years of work", "pictures/cat.png": "a cat", "ours.txt": "not yours"}


def strangers_folder(folder: Path) -> dict[str, bytes]:
    """A folder with files of somebody else, and what is in it."""
    for name, text in STRANGERS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return everything_in(folder)


@pytest.mark.parametrize("mode", FolderMode.__args__)
def test_a_folder_with_anything_of_somebody_else_is_never_replaced(
    mode: FolderMode, tmp_path: Path
) -> None:
    before = strangers_folder(tmp_path / "mine")
    with pytest.raises(OutputError, match="holds"), output_folder(tmp_path / "mine", mode) as new:
        (new / "ours.txt").write_text("ours")
    assert everything_in(tmp_path / "mine") == before


@pytest.mark.parametrize("mode", ["replace", "add"])
def test_what_somebody_adds_to_a_folder_of_ours_stays(mode: FolderMode, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with output_folder(out) as folder:
        for name in ("a", "b", "c"):
            (folder / name).write_text("ours")
    (out / "thesis.txt").write_text("years of work")
    (out / "a").write_text("retouched by hand")
    with output_folder(out, mode) as folder:
        (folder / "b").write_text("new")
    expected = {"thesis.txt": b"years of work", "a": b"retouched by hand", "b": b"new"}
    assert everything_in(out) == (expected | {"c": b"ours"} if mode == "add" else expected)
    with pytest.raises(OutputError, match="changed since"), output_folder(out, mode) as folder:
        (folder / "b").write_text("newest")
        (folder / "a").write_text("newest")
    assert everything_in(out)["b"] == b"new"


def test_files_beside_a_stage_take_the_place_of_nothing_of_somebody_else(tmp_path: Path) -> None:
    before = strangers_folder(tmp_path)
    with pytest.raises(OutputError, match=r"ours\.txt: was not written"), deliver() as delivery:
        stage = delivery.place(tmp_path / "house.usda")
        stage.write_text("house")
        (stage.parent / "ours.txt").write_text("ours")
    assert everything_in(tmp_path) == before


def test_files_beside_a_stage_take_the_place_of_our_own(tmp_path: Path) -> None:
    for text in ("first", "second"):
        with deliver() as delivery:
            stage = delivery.place(tmp_path / "house.usda")
            for file in (stage, stage.parent / "beside"):
                file.write_text(text)
    assert everything_in(tmp_path) == {"house.usda": b"second", "beside": b"second"}


def test_a_manifest_of_somebody_else_gives_no_right_beyond_its_folder(tmp_path: Path) -> None:
    (tmp_path / "key").write_text("secret")
    out = tmp_path / "out"
    with output_folder(out) as folder:
        (folder / "file").write_text("ours")
    digest = files.hash_file(tmp_path / "key")
    (out / "link").symlink_to(tmp_path)
    with (out / MANIFEST_FILE).open("a") as manifest:
        manifest.writelines(f"{digest}  {name}\n" for name in ("../key", "link/key", "/etc/passwd"))
    with output_folder(out, "replace") as folder:
        (folder / "file").write_text("new")
    assert (tmp_path / "key").read_text() == "secret"


@pytest.mark.parametrize("kind", ["link", "dangling link", "pipe", "folder"])
def test_what_is_no_plain_file_is_never_a_target(kind: str, tmp_path: Path) -> None:
    target = tmp_path / "target"
    (tmp_path / "thesis").write_text("years of work")
    if kind == "folder":
        target.mkdir()
    elif kind == "pipe":
        os.mkfifo(target)
    else:
        target.symlink_to(tmp_path / ("thesis" if kind == "link" else "gone"))
    with pytest.raises(OutputError, match=r"is a|is no"):
        write_atomic(target, "x")
    assert (tmp_path / "thesis").read_text() == "years of work"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["target", "thesis"]


def test_a_training_run_goes_on_in_its_own_folder_only(tmp_path: Path) -> None:
    before = strangers_folder(tmp_path / "mine")
    with pytest.raises(OutputError, match="holds"):
        begin_run(tmp_path / "mine")
    assert everything_in(tmp_path / "mine") == before
    for _ in range(2):
        begin_run(tmp_path / "run")
        (tmp_path / "run" / "weights").write_text("w")


def test_leftovers_of_the_killed_are_swept_and_those_at_work_are_not(tmp_path: Path) -> None:
    code = (
        "import os, sys; from pathlib import Path\n"
        "from chord_usd.base.runtime.scratch import Scratch\n"
        "(Scratch(Path(sys.argv[1])).folder / 'half').write_text('x'); os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code, tmp_path], check=False)
    (dead,) = tmp_path.glob(f"{PREFIX}*")
    strange = tmp_path / f"{PREFIX}mine"
    strange.mkdir()
    (strange / LOCK_FILE).write_text("a diary\n")
    with scratch_folder(tmp_path) as alive:
        assert not dead.exists()
        with scratch_folder(tmp_path):
            assert alive.exists()
    assert sorted(tmp_path.iterdir()) == [strange]


def test_output_folder_keeps_the_older_one_on_failure(tmp_path: Path) -> None:
    with output_folder(tmp_path / "out") as folder:
        (folder / "first").write_text("first")
    with (
        pytest.raises(ValueError, match="stop"),
        output_folder(tmp_path / "out", "replace") as folder,
    ):
        (folder / "second").write_text("second")
        raise ValueError("stop")
    assert sorted(everything_in(tmp_path)) == ["out", "out/first"]


def test_an_input_that_is_missing_is_not_called_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), deliver() as delivery:
        delivery.place(tmp_path / "out.png")
        (tmp_path / "plan.png").read_bytes()


def test_a_writer_that_fails_on_a_full_disk_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "NEARLY_FULL_BYTES", 1 << 62)
    with pytest.raises(OutputError, match="disk is full"), deliver() as delivery:
        delivery.place(tmp_path / "house.usda")
        raise RuntimeError("usd writer: bad stream")
    assert everything_in(tmp_path) == {}


def test_two_names_of_one_file_are_one_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "deep" / "below").mkdir(parents=True)
    (tmp_path / "link").symlink_to("deep/below")
    monkeypatch.chdir(tmp_path / "deep")
    real = tmp_path.resolve() / "deep" / "a.usda"
    for name in ("a.usda", "./a.usda", "../deep/a.usda", "below/../a.usda", "../link/../a.usda"):
        assert absolute(Path(name)).resolve() == real
        assert ".." not in absolute(Path(name)).parts
    assert absolute(Path("..")) == tmp_path.resolve()
    assert absolute(tmp_path / "link" / "b") == tmp_path / "link" / "b"


def test_a_deleted_working_folder_is_one_line(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    script = (
        "import os, sys; from chord_usd.cli import main; os.rmdir(os.getcwd());"
        "sys.exit(main(['check', '../house.usda', '--progress', 'none']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=gone, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("error: the working folder was deleted")
    assert done.stderr.count("\n") == 1


def test_what_is_kept_in_the_cache_is_not_told_as_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(interrupts, "delivered", [])
    write_atomic(tmp_path / "cache" / "assets" / "a.usda", "kept")
    write_atomic(tmp_path / "asked.usda", "written")
    assert interrupts.delivered == [tmp_path / "asked.usda"]
