"""Archives from strangers: nothing in them reaches a file but those of the folder given."""

from __future__ import annotations

import contextlib
import io
import os
import stat
import struct
import zipfile
import zlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from chord_usd.base.errors import AssetError, PlanError, StageError
from chord_usd.base.runtime import archives
from chord_usd.base.runtime.archives import Archive


def archive_of(path: Path, files: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name), data, method)
    return path


def unpacked(path: Path, folder: Path) -> dict[str, bytes]:
    folder.mkdir()
    with Archive(path, StageError) as archive:
        archive.unpack(folder)
    files = (file for file in folder.rglob("*") if file.is_file())
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def test_what_was_packed_is_what_is_unpacked(tmp_path: Path) -> None:
    files = {"a/b.usda": b"one", "a/c.png": bytes(5000), "d.txt": b"", "ä é/漢.obj": b"v 0 0 0"}
    path = archive_of(tmp_path / "a.zip", files, zipfile.ZIP_DEFLATED)
    assert unpacked(path, tmp_path / "out") == files
    with Archive(path, AssetError) as archive:
        assert archive.names == list(files)
        assert archive.read("a/b.usda") == b"one"


OUTSIDE = ("../x", "/x", "a/../../x", "..", "a/..", "\\x", "a\\..\\x", "C:/x", "C:x", "//h/x")


@pytest.mark.parametrize("name", [*OUTSIDE, "a\0b", "a\nb", "", "x" * 300, "a/" * 600 + "x"])
def test_names_that_are_none_are_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w") as archive:
        entry = zipfile.ZipInfo("x")
        # The constructor mends what a stranger's tool would not.
        entry.filename = name
        archive.writestr(entry, b"secret")
    for error in (PlanError, AssetError, StageError):
        with pytest.raises(error) as caught:
            Archive(path, error)
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)


DOUBLES = [("a", "a"), ("a.usda", "A.USDA"), ("é", "e\u0301"), ("a", "a/b"), ("x/./y", "x/y")]


@pytest.mark.parametrize("names", DOUBLES)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_one_file_twice_is_refused(tmp_path: Path, names: tuple[str, str]) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        for name in names:
            archive.writestr(name, name)
    with pytest.raises(StageError, match="refused"):
        Archive(tmp_path / "a.zip", StageError)


@pytest.mark.parametrize("kind", [stat.S_IFLNK, stat.S_IFIFO, stat.S_IFCHR, stat.S_IFBLK])
def test_links_and_devices_are_refused(tmp_path: Path, kind: int) -> None:
    entry = zipfile.ZipInfo("link")
    entry.external_attr = (kind | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr(entry, "/etc/passwd")
    with pytest.raises(StageError, match="link or a device"):
        Archive(tmp_path / "a.zip", StageError)


def test_encrypted_files_are_refused(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.zip", {"a": b"secret"})
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(data)
    with pytest.raises(StageError, match="encrypted"):
        Archive(path, StageError)


def raw_archive(packed: bytes, told_bytes: int, names: list[str]) -> bytes:
    """An archive of deflated data that every name refers to, with a size that is a lie."""
    crc = 0
    head = struct.pack("<4s5H3L2H", b"PK\x03\x04", 20, 0, 8, 0, 0, crc, len(packed), told_bytes,
                       len(names[0]), 0)  # fmt: skip
    body = head + names[0].encode() + packed
    listed = b"".join(
        struct.pack("<4s6H3L5H2L", b"PK\x01\x02", 20, 20, 0, 8, 0, 0, crc, len(packed), told_bytes,
                    len(name), 0, 0, 0, 0, 0, 0) + name.encode()
        for name in names
    )  # fmt: skip
    end = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, len(names), len(names), len(listed),
                      len(body), 0)  # fmt: skip
    return body + listed + end


def test_overlapping_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.zip"
    path.write_bytes(raw_archive(zlib.compress(bytes(1000))[2:-4], 1000, ["a", "b", "c"]))
    with pytest.raises(StageError, match="shares its bytes"):
        Archive(path, StageError)


def test_a_size_in_a_header_is_not_believed(tmp_path: Path) -> None:
    """8 MB that say they are ten bytes, and 990 that say they are 8 MB, end as errors."""
    for told, real in ((10, 8 * 2**20), (8 * 2**20, 990)):
        path = tmp_path / f"{told}.zip"
        path.write_bytes(
            raw_archive(zlib.compress(os.urandom(99) * (real // 99))[2:-4], told, ["a"])
        )
        with (
            Archive(path, PlanError) as archive,
            pytest.raises(PlanError, match=r"damaged|shorter"),
        ):
            archive.read("a")
        out = tmp_path / f"out{told}"
        out.mkdir()
        with Archive(path, PlanError) as archive, pytest.raises(PlanError):
            archive.unpack(out)
        assert sum(file.stat().st_size for file in out.iterdir()) <= max(told, real)


def test_reading_stops_at_the_limit(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.zip", {"a": bytes(2**20)})
    with Archive(path, PlanError) as archive:
        assert len(archive.read("a", 2**20)) == 2**20
        with pytest.raises(PlanError, match="more than 1,048,575 bytes"):
            archive.read("a", 2**20 - 1)


def test_bombs_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    zeros = archive_of(tmp_path / "z.zip", {"zeros": bytes(16 * 2**20)}, zipfile.ZIP_DEFLATED)
    with pytest.raises(AssetError, match="zip bomb"):
        Archive(zeros, AssetError)
    many = archive_of(tmp_path / "m.zip", {f"{n}": b"" for n in range(50)})
    monkeypatch.setattr(archives, "MOST_ENTRIES", 49)
    with pytest.raises(AssetError, match="in 50 files"):
        Archive(many, AssetError)
    monkeypatch.setattr(archives, "_DIRECTORY_BYTES", 1000)
    with pytest.raises(AssetError, match="its directory"):
        Archive(many, AssetError)


def test_what_is_there_already_is_not_overwritten(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.zip", {"a": b"theirs"})
    (tmp_path / "a").write_bytes(b"mine")
    with Archive(path, StageError) as archive, pytest.raises(FileExistsError):
        archive.unpack(tmp_path)
    assert (tmp_path / "a").read_bytes() == b"mine"


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.zip")  # nobody writes to it: whoever waits, waits for ever
    with pytest.raises(StageError, match="no regular file"):
        Archive(tmp_path / "a.zip", StageError)


def test_a_package_is_stored_as_it_is(tmp_path: Path) -> None:
    files = {"root.usda": b"#usda 1.0\n", "a.png": b"png"}
    with Archive(archive_of(tmp_path / "a.usdz", files), StageError) as archive:
        archive.require_package()
    packed = archive_of(tmp_path / "b.usdz", files, zipfile.ZIP_DEFLATED)
    with Archive(packed, StageError) as archive, pytest.raises(StageError, match="compressed"):
        archive.require_package()
    hidden = b"PK\x03\x04" + (tmp_path / "a.usdz").read_bytes()
    (tmp_path / "c.usdz").write_bytes(hidden)
    with Archive(tmp_path / "c.usdz", StageError) as archive, pytest.raises(StageError):
        archive.require_package()


def _sample() -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("root.usda", b"#usda 1.0\n" * 9)
        archive.writestr("sub/a.png", bytes(range(99)))
    return data.getvalue()


SAMPLE = _sample()


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.tuples(st.integers(0, len(SAMPLE) - 1), st.integers(0, 255)), max_size=6))
@example(changes=[])
def test_any_bytes_end_in_an_error_or_inside_the_folder(
    tmp_path_factory: pytest.TempPathFactory, changes: list[tuple[int, int]]
) -> None:
    folder = tmp_path_factory.mktemp("fuzz")
    data = bytearray(SAMPLE)
    for place, value in changes:
        data[place] = value
    (folder / "a.zip").write_bytes(data)
    (folder / "out").mkdir()

    with contextlib.suppress(StageError), Archive(folder / "a.zip", StageError) as archive:
        archive.unpack(folder / "out")
        archive.require_package()
    unpacked = any((folder / "out").iterdir())
    assert unpacked or bytes(data) != SAMPLE, "a sound archive is unpacked"
    assert {one.name for one in folder.iterdir()} == {"a.zip", "out"}
