"""What a command line names is settled before anything takes time: in every verb that writes.

Networks, Blender and the reading of stages are shut off here; whatever gets so far is a failure.
"""

from __future__ import annotations

import os
import shutil
from collections import namedtuple
from pathlib import Path

import pytest

from chord_usd import cli
from chord_usd.base.errors import ChordError
from chord_usd.cli import UNUSABLE, build_parser
from chord_usd.faces.commands.common import Outcome
from chord_usd.faces.commands.paths import check_paths, named_paths, output_file
from tests.strangers_verbs import INPUTS, OUTPUTS, make_home

FREE = ("MD", "FILE")
"""Words for outputs that may have any suffix: reports, and records of a run."""

FILES = [(verb, option) for verb, option, kind in OUTPUTS if kind == "output_file"]
WRITTEN = [one[:2] for one in OUTPUTS]
FOLDERS = [one[:2] for one in OUTPUTS if one[2] in ("output_folder", "output_package")]
READ = [verb for verb, words in INPUTS.items() if any("." in word for word in words)]


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory, furnished_house) -> Path:
    return make_home(tmp_path_factory.mktemp("home"), furnished_house)


@pytest.fixture(autouse=True)
def home(template: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of inputs to work in, where no verb begins to work."""
    folder = Path(shutil.copytree(template, tmp_path / "home"))
    monkeypatch.chdir(folder)

    def too_far(options: object) -> Outcome:
        raise AssertionError("a verb began to work")

    monkeypatch.setattr(cli, "_run", too_far)
    return folder


def words_of(verb: str, option: str, path: str) -> list[str]:
    """A command line with one output there, and all that the verb must have."""
    words = [*verb.split(), *INPUTS[verb]]
    needs = any(one[0] == verb and one[1] == "--output" for one in OUTPUTS)
    if needs and option != "--output":
        words += ["-o", _fitting(verb)]
    return [*words, f"{option}={path}"]


def _fitting(verb: str) -> str:
    """A name for the main output of a verb."""
    parser = build_parser([verb.split()[0]])
    for suffix in ("", ".usda", ".png", ".json", ".gz"):
        try:
            options = parser.parse_args([*verb.split(), *INPUTS[verb], "-o", f"made{suffix}"])
            check_paths(options.parser, options)
        except ChordError:
            continue
        return f"made{suffix}"
    raise AssertionError(f"no name fits {verb}")


def refused(capsys: pytest.CaptureFixture[str], words: list[str]) -> str:
    assert cli.main(words) == UNUSABLE
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    return told


def test_every_file_that_is_written_has_its_suffix() -> None:
    for verb, option in FILES:
        words = words_of(verb, option, "made")
        options = build_parser([words[0]]).parse_args(words)
        (named,) = (
            one
            for one in named_paths(options.parser, options)
            if one.option == option and one.role is output_file
        )
        (action,) = (one for one in options.parser._actions if option in one.option_strings)
        assert named.suffixes or action.metavar in FREE, f"{verb} {option}"


@pytest.mark.parametrize(("verb", "option"), FILES)
def test_a_wrong_suffix_is_refused(
    verb: str, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = words_of(verb, option, "made.docx")
    options = build_parser([words[0]]).parse_args(words)
    suffixes = [one.suffixes for one in named_paths(options.parser, options)]
    if any(suffixes):
        told = refused(capsys, words)
        assert ".docx" in told
        assert "expected ." in told or "expected one of ." in told


@pytest.mark.parametrize("verb", READ)
def test_an_input_that_is_not_there_is_refused(
    verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    option = next(option for name, option, _ in OUTPUTS if name == verb)
    words = words_of(verb, option, _fitting(verb) if option == "--output" else "made.png")
    gone = [f"nowhere/{word}" if "." in word and word in INPUTS[verb] else word for word in words]
    told = refused(capsys, gone)
    assert "nowhere/" in told
    assert "no such file" in told


@pytest.mark.parametrize(("verb", "option"), FOLDERS)
def test_a_folder_that_holds_something_is_refused(
    verb: str, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "thesis.txt" in refused(capsys, words_of(verb, option, "mine"))


@pytest.mark.parametrize(("verb", "option"), WRITTEN)
def test_a_full_disk_is_told_first(
    verb: str, option: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = words_of(verb, option, f"made{_suffix(verb, option)}")
    usage = namedtuple("usage", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage(100, 99, 1))
    assert "the disk is full" in refused(capsys, words)


def _suffix(verb: str, option: str) -> str:
    """One that this output may have."""
    suffixes = (".png", ".usda", ".json", ".glb", ".gz", "")
    return next(one for one in suffixes if _passes(words_of(verb, option, f"made{one}")))


def _passes(words: list[str]) -> bool:
    options = build_parser([words[0]]).parse_args(words)
    try:
        check_paths(options.parser, options)
    except ChordError:
        return False
    return True


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
@pytest.mark.parametrize(("verb", "option"), WRITTEN)
def test_a_folder_that_is_read_only_is_told_first(
    verb: str, option: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "mine").chmod(0o500)
    name = f"mine/made{_suffix(verb, option)}"
    assert "permission denied" in refused(capsys, words_of(verb, option, name))


def test_a_sky_is_an_input(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["generate", "plan.png", "-o", "made.usda", "--sky"]
    assert "no such file" in refused(capsys, [*words, "nowhere.exr"])
    assert _passes([*words, "noon"])
