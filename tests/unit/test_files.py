"""Outputs appear whole or not at all."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from chord_usd.errors import OutputError
from chord_usd.runtime import files
from chord_usd.runtime.files import deliver, output_folder, write_atomic


def everything_in(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes() if p.is_file() else b"<folder>"
        for p in folder.rglob("*")
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


def test_output_folder_replaces_the_older_one_as_a_whole(tmp_path: Path) -> None:
    for name in ("first", "second"):
        with output_folder(tmp_path / "out") as folder:
            (folder / name).write_text(name)
    assert sorted(everything_in(tmp_path)) == ["out", "out/second"]


def test_output_folder_keeps_the_older_one_on_failure(tmp_path: Path) -> None:
    with output_folder(tmp_path / "out") as folder:
        (folder / "first").write_text("first")
    with pytest.raises(ValueError, match="stop"), output_folder(tmp_path / "out") as folder:
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
    monkeypatch.setattr(files, "_NEARLY_FULL_BYTES", 1 << 62)
    with pytest.raises(OutputError, match="disk is full"), deliver() as delivery:
        delivery.place(tmp_path / "house.usda")
        raise RuntimeError("usd writer: bad stream")
    assert everything_in(tmp_path) == {}
