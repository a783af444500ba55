"""Whatever a verb is told to write to: files of somebody else and its own inputs stay.

The verbs and their outputs are read off the parser, so that a new one cannot be forgotten.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from chord_usd.base.runtime.files import hash_file
from chord_usd.cli import UNUSABLE, main
from tests.strangers_verbs import INPUTS, OUTPUTS, make_home

EDITED_IN_PLACE = ("regenerate", "--output")


FOLDERS = [
    (verb, option) for verb, option, kind in OUTPUTS if kind in ("output_folder", "output_run")
]
FILES = [
    (verb, option) for verb, option, kind in OUTPUTS if kind in ("output_file", "output_package")
]
SAME_FILE = [
    (verb, option)
    for verb, option in FILES
    if any(Path(word).suffix for word in INPUTS[verb]) and (verb, option) != EDITED_IN_PLACE
]


def test_every_verb_that_writes_is_tried() -> None:
    assert {verb for verb, _, _ in OUTPUTS} == set(INPUTS)


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory, furnished_house) -> Path:
    return make_home(tmp_path_factory.mktemp("home"), furnished_house)


@pytest.fixture
def home(template: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "home"
    shutil.copytree(template, folder, symlinks=True)
    monkeypatch.chdir(folder)
    return folder


def content(folder: Path) -> dict[str, str]:
    """Every file, folder and link, and what is in it."""

    def told(path: Path) -> str:
        if path.is_symlink():
            return f"-> {path.readlink()}"
        return hash_file(path) if path.is_file() else "folder"

    return {str(path.relative_to(folder)): told(path) for path in folder.rglob("*")}


def refused(home: Path, verb: str, *words: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Run it; it must end with one error line and leave everything as it was."""
    before = content(home)
    capsys.readouterr()
    options = words if "-o" in words or "--output" in words else (*words, *("-o", "new/out.usda"))
    if verb.startswith(("assets", "evaluate", "dataset stats")) and "-o" not in words:
        options = words
    code = main([*verb.split(), *INPUTS[verb], *options, "--progress", "none"])
    told = capsys.readouterr().err
    assert code == UNUSABLE, told
    assert re.fullmatch(r"error: .+\n", told)
    assert "unexpected" not in told
    assert content(home) == before


@pytest.mark.parametrize(("verb", "option"), FOLDERS, ids=lambda value: value)
@pytest.mark.parametrize("where", ["mine", ".", "library/..", "houses", "link", "plan.png"])
def test_a_folder_of_somebody_else_is_never_taken(
    verb: str, option: str, where: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if where == "link":
        (home / "link").symlink_to("mine")
    refused(home, verb, "-o", where, capsys=capsys)


SPELLINGS: dict[str, Callable[[Path], str]] = {
    "itself": lambda path: path.name,
    "dots": lambda path: f"mine/../{path.name}",
    "absolute": lambda path: str(path.absolute()),
    "link": lambda path: linked(path, os.symlink),
    "hard link": lambda path: linked(path, os.link),
}


def linked(path: Path, link: Callable[[Path, Path], None]) -> str:
    other = path.with_name(f"other{path.suffix}")
    link(path, other)
    return other.name


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize(("verb", "option"), SAME_FILE, ids=lambda value: value)
def test_no_output_is_its_own_input(
    verb: str, option: str, spelling: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = next(Path(word) for word in INPUTS[verb] if Path(word).suffix)
    words = [option, SPELLINGS[spelling](home / given)]
    refused(home, verb, *(words if option != "--output" else ["-o", words[1]]), capsys=capsys)


@pytest.mark.parametrize("kind", ["folder", "link", "pipe"])
@pytest.mark.parametrize(
    ("verb", "option"),
    [(verb, option) for verb, option in FILES if not verb.startswith(("evaluate", "assets"))],
    ids=lambda value: value,
)
def test_what_is_no_plain_file_is_no_output(
    verb: str, option: str, kind: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    suffix = {"plan from-text": ".png", "plan from-outline": ".png", "export": ".usdz"}
    target = home / f"target{suffix.get(verb, '.usda') if option == '--output' else '.png'}"
    if kind == "folder":
        target.mkdir()
    elif kind == "link":
        target.symlink_to(home / "mine" / "thesis.txt")
    else:
        os.mkfifo(target)
    words = [option if option != "--output" else "-o", target.name]
    refused(home, verb, *words, capsys=capsys)


def test_files_beside_a_house_do_not_replace_those_of_somebody_else(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("materials", "mine/house_architecture"):
        (home / name).mkdir(exist_ok=True)
    architecture = home / "mine" / "house_architecture" / "Exterior.usdc"
    architecture.write_bytes(b"drawn by hand")
    refused(home, "stage", "-o", "mine/house.usda", capsys=capsys)
    digest = hashlib.sha256(b"drawn by hand").hexdigest()
    assert hash_file(architecture) == digest
