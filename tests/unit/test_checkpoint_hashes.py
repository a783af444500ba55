"""Checkpoints that are damaged, elsewhere or of another kind are told, never run."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime import checksums
from chord_usd.base.runtime.checksums import (
    SUMMED_FILES,
    SUMS_FILE,
    check_file,
    checkpoint_files,
    checkpoint_hash,
)
from chord_usd.base.runtime.files import hash_file
from chord_usd.base.runtime.locations import (
    CHECKPOINTS_VARIABLE,
    checkpoint_folder,
    name_checkpoint,
    untrained_in_use,
)
from chord_usd.base.runtime.networks import content_hash, granted_threads
from chord_usd.line.layout.description import read_description
from chord_usd.line.planning.sketcher import load_sketcher
from tests.every import for_every

SHIPPED = Path(__file__).parents[2] / "checkpoints"
NAMES = sorted(folder.name for folder in SHIPPED.iterdir() if folder.is_dir())
STRANGE = (None, True, -1, 10**400, 0.5, "x", [], ["x"], {}, [[1]])


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the smallest checkpoint, without hashes."""
    folder = tmp_path_factory.mktemp("checkpoints") / "bubbles"
    shutil.copytree(SHIPPED / "bubbles", folder)
    (folder / SUMS_FILE).unlink()
    return folder


def flip(path: Path, bit: int) -> None:
    data = bytearray(path.read_bytes())
    data[bit // 8 % len(data)] ^= 1 << bit % 8
    path.write_bytes(data)


@for_every("name", NAMES)
def test_what_ships_is_what_its_hashes_say(name: str) -> None:
    """Whoever changes a checkpoint by hand runs `sha256sum` on what runs again."""
    lines = (SHIPPED / name / SUMS_FILE).read_text().splitlines()
    there = [file for file in SUMMED_FILES if (SHIPPED / name / file).is_file()]
    assert [line.split("  ")[1] for line in lines] == there
    assert {"config.json", "network.onnx", "weights.safetensors"} <= set(there)
    for line in lines:
        expected, file = line.split("  ")
        assert hash_file(SHIPPED / name / file) == expected


@pytest.mark.parametrize("file", ["weights.safetensors", "network.onnx"])
@pytest.mark.parametrize("part", [0.0, 0.5, 1.0])
def test_one_flipped_bit_is_told(file: str, part: float, tmp_path: Path) -> None:
    folder = tmp_path / "bubbles"
    shutil.copytree(SHIPPED / "bubbles", folder)
    load_sketcher(folder)
    flip(folder / file, int(part * ((folder / file).stat().st_size * 8 - 1)))
    with pytest.raises(CheckpointError, match=r"damaged or was changed.*SHA-256"):
        load_sketcher(folder)


def test_damaged_hashes_are_told(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text("{}")
    for text in (b"\xff", b"abc  config.json\n", b"\n"):
        (tmp_path / SUMS_FILE).write_bytes(text)
        with pytest.raises(CheckpointError, match="hashes are damaged"):
            check_file(tmp_path / "config.json")


def test_hashes_follow_what_is_written_and_a_crash_leaves_none(tmp_path: Path) -> None:
    for text in ("1", "2"):
        with checkpoint_files(tmp_path):
            (tmp_path / "config.json").write_text(text)
        check_file(tmp_path / "config.json")
    with pytest.raises(OSError, match="crash"), checkpoint_files(tmp_path):
        (tmp_path / "config.json").write_text("3")
        raise OSError("crash")
    check_file(tmp_path / "config.json")
    assert not (tmp_path / SUMS_FILE).exists()


def test_a_file_is_hashed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """generate hashes weights for their provenance anyway: the check costs nothing more."""
    shutil.copytree(SHIPPED / "bubbles", tmp_path / "bubbles")
    read = []
    monkeypatch.setattr(checksums, "hash_file", lambda path: read.append(path) or hash_file(path))
    weights = tmp_path / "bubbles" / "weights.safetensors"
    check_file(weights)
    assert content_hash(weights.parent) == checkpoint_hash(weights)[:16]
    assert read == [weights]


@settings(max_examples=40)
@given(bit=st.integers(0, 8 * 4000))
def test_a_damaged_header_without_hashes_is_an_error_or_harmless(small: Path, bit: int) -> None:
    """The header of a safetensors file says what lies where, as JSON."""
    weights = small / "weights.safetensors"
    flip(weights, bit)
    try:
        load_sketcher(small)
    except CheckpointError:
        pass
    finally:
        flip(weights, bit)


@pytest.mark.parametrize("length", [0, 1, 1000, 50_000])
@pytest.mark.parametrize("file", ["weights.safetensors", "network.onnx"])
def test_a_truncated_file_without_hashes_is_told(small: Path, file: str, length: int) -> None:
    whole = (small / file).read_bytes()
    (small / file).write_bytes(whole[:length])
    try:
        with pytest.raises(CheckpointError):
            load_sketcher(small)
    finally:
        (small / file).write_bytes(whole)


def _keys(values: dict) -> list[tuple[str, ...]]:
    return [(key,) for key in values] + [("network", key) for key in values["network"]]


CONFIG = json.loads((SHIPPED / "plan2layout" / "config.json").read_text())


@for_every("path", _keys(CONFIG), ids=".".join)
def test_a_config_of_other_types_is_told_or_means_the_same(
    path: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "weights.safetensors").write_bytes(b"")
    for strange in STRANGE:
        values = json.loads(json.dumps(CONFIG))
        inner = values[path[0]] if len(path) > 1 else values
        right, inner[path[-1]] = inner[path[-1]], strange
        (tmp_path / "config.json").write_text(json.dumps(values))
        try:
            found = read_description(tmp_path)
        except CheckpointError:
            continue
        # Numbers may be others, lists shorter; anything may be said of the training.
        like = strange in ({}, []) or type(right) in (bool, int, float) or path == ("training",)
        assert like, (strange, found)


def test_a_deep_config_is_told(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text("[" * 100_000)
    with pytest.raises(CheckpointError):
        read_description(tmp_path)


@pytest.mark.parametrize("make", [lambda path: None, lambda path: path.write_text("x")])
def test_a_named_folder_that_is_none_is_told(
    make: Callable[[Path], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make(tmp_path / "own")
    monkeypatch.setenv(CHECKPOINTS_VARIABLE, str(tmp_path / "own"))
    with pytest.raises(CheckpointError, match=r"folder.*own") as told:
        checkpoint_folder("bubbles")
    assert CHECKPOINTS_VARIABLE in str(told.value)


@pytest.mark.parametrize("files", [(), ("notes.txt",), ("checkpoint/weights.safetensors",)])
def test_a_named_folder_without_networks_is_refused(
    files: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, such a folder gave the house of the shipped networks, byte for byte."""
    for file in files:
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text("x")
    monkeypatch.setenv(CHECKPOINTS_VARIABLE, str(tmp_path))
    with pytest.raises(CheckpointError, match="holds no networks"):
        checkpoint_folder("bubbles")


def test_a_run_of_training_is_accepted_and_a_short_one_is_warned_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run, its checkpoint, and a folder of runs; content hashes are those of the run."""
    run = tmp_path / "runs" / "bubbles"
    shutil.copytree(SHIPPED / "bubbles", run / "checkpoint")
    name_checkpoint(run, "bubbles")
    for named in (run, run / "checkpoint", tmp_path / "runs"):
        monkeypatch.setenv(CHECKPOINTS_VARIABLE, str(named))
        assert checkpoint_folder("bubbles") == run / "checkpoint"
        assert checkpoint_folder("table") == SHIPPED / "table"
        assert untrained_in_use() == []
    config = json.loads((run / "checkpoint/config.json").read_text())
    config["training"]["steps"] = 1
    (run / "checkpoint/config.json").write_text(json.dumps(config))
    (warning,) = untrained_in_use()
    assert "bubbles" in warning
    assert "1 step:" in warning


def test_what_a_named_folder_lacks_is_what_ships(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(SHIPPED / "bubbles", tmp_path / "bubbles")
    monkeypatch.setenv(CHECKPOINTS_VARIABLE, str(tmp_path))
    assert checkpoint_folder("bubbles") == tmp_path / "bubbles"
    assert checkpoint_folder("table") == SHIPPED / "table"


@pytest.mark.parametrize("text", ["garbage", "", "-1", "²", "0", "1e9", "4,2"])
def test_threads_that_are_no_number_are_as_if_unsaid(
    text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", text)
    assert granted_threads() is None
