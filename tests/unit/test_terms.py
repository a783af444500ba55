"""Messages in the terms of each surface: no option of the command line reaches another."""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from chord_usd import cli
from chord_usd.base.errors import ChordError, OutputError, StageError, WordedError
from chord_usd.base.runtime.verb_calls import answer_of
from chord_usd.base.scene.settings import OPTIONS, Settings
from chord_usd.base.scene.styles import style_named
from chord_usd.base.terms import SURFACES, VARIABLE, named, names, worded, wording_for
from chord_usd.faces.commands.paths import UsageError
from tests.every import for_every

ROOT = Path(__file__).parents[2]
OTHERS = [surface for surface in SURFACES if surface != "command"]
REACHED = [
    file
    for place in ("base", "library", "line", "faces/page", "api.py")
    for file in sorted([ROOT / "chord_usd" / place, *(ROOT / "chord_usd" / place).rglob("*.py")])
    if file.suffix == ".py"
] + sorted((ROOT / "blender_addon").rglob("*.py"))
"""Code whose messages reach the page, Blender, Python and agents."""

COMMAND_LINE = re.compile(rf"(?<![\w-])--[a-z]|\bchord-usd (?:{'|'.join(cli.VERBS)})\b")
OPENED = re.compile(rf"{COMMAND_LINE.pattern}|--\Z")
"""As it is before a name in braces, too."""
ONE_WORD = re.compile(r"(?:[\w.]+ )?--[a-z-]*(?:=\S*)?\Z")
"""An argument for another program, unless it is in a message."""
REFERENCE = re.compile(r"<([a-z_]+(?: [a-z]+)?)[=>]")


def _said(file: Path) -> Iterator[tuple[int, str, bool]]:
    """Line, text, and whether it is in a message, of all texts of a module but docstrings."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    notes = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else ""
            called = node.func.id if isinstance(node.func, ast.Name) else called
            if called.endswith(("Error", "error", "refused", "not_understood", "with_step")):
                for part in ast.walk(node):
                    if isinstance(part, ast.Constant) and isinstance(part.value, str):
                        yield part.lineno, part.value, True
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in notes:
            yield node.lineno, node.value, False


@for_every("file", REACHED)
def test_no_message_holds_words_of_the_command_line(file):
    for line, text, is_message in _said(file):
        if is_message or not ONE_WORD.match(text):
            assert not (OPENED if is_message else COMMAND_LINE).search(text), (
                f"line {line}: {text!r}"
            )
        for name in REFERENCE.findall(text) if is_message else ():
            assert name in names(), f"line {line}: <{name}> is not in terms.tsv"


def test_the_table_holds_every_setting_and_no_option_for_others_than_the_command_line():
    for row in OPTIONS.values():
        assert named(row.name, to="command").split(" ")[0] == f"--{row.word}"
        assert named(row.name, to="python").split("=")[0] == row.name
    for name, cells in names().items():
        for surface in OTHERS:
            said = ChordError("x", where=f"<{name}=v>", try_=(f"<{name}>", f"<{name}=v>"))
            assert not COMMAND_LINE.search(said.sentence(surface)), (name, surface)
        assert cells["command"] or name == "no_worker", name


def test_each_surface_words_an_error_in_its_terms():
    with pytest.raises(ChordError) as caught:
        style_named("modem", 0)
    error = caught.value
    assert (error.code, error.field, error.value) == ("unusable", "style", "modem")
    assert "--style: there is no style 'modem'" in error.sentence("command")
    assert error.sentence("command").endswith("Try: --style modern")
    assert error.suggestions("python") == ("style=modern",)
    assert error.suggestions("page") == ("Style: modern",)
    error = OutputError("is taken", where="a/b.usda", try_=("<overwrite>", "another name"))
    assert error.sentence("page") == "is taken. Try: another name"
    assert error.sentence("python") == "a/b.usda: is taken. Try: overwrite=True, or another name"


def test_what_a_surface_lacks_is_left_out_and_what_users_wrote_stays():
    assert worded("<port=0>, which takes any", "page") == ""
    assert worded("<b>bold</b> <seed>", "page") == "<b>bold</b> Seed"
    error = StageError("has no '--x'", where="the sentence", expected="no <lists>", try_="<force>")
    assert error.sentence("panel") == "the sentence: has no '--x'"


def test_python_names_its_own_arguments():
    with pytest.raises(ChordError, match=r"^m_per_px: cannot be 90; expected") as caught:
        Settings(m_per_px=90)
    assert caught.value.value == 90


def test_the_command_line_words_errors_for_who_calls_it(capsys, monkeypatch):
    words = ["generate", "plan.png", "-o", "house.usda", "--seed", "x", "--progress", "json"]
    assert cli.main(words) == 2
    plain = capsys.readouterr().err
    assert plain.startswith("error: argument --seed: ")
    monkeypatch.setenv(VARIABLE, "panel")
    assert cli.main(words) == 2
    said = capsys.readouterr().err.splitlines()
    fields = json.loads(said[0])["error"]
    assert fields["code"] == "usage"
    assert said[1] == f"error: {fields['sentence']}"
    assert fields["sentence"].startswith("argument Seed: ")
    with pytest.raises(WordedError) as caught:
        answer_of("generate", 2, "", said)
    assert caught.value.as_json() == fields


def test_own_words_of_the_command_line_are_none_elsewhere():
    error = UsageError("contradicts --gpu-only", where="--device cpu", try_="--scale M_PER_PX")
    assert "--" not in error.sentence("page")
    assert "--device cpu: contradicts --gpu-only" in error.sentence("command")


def test_wording_for_ends_with_its_block(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    with wording_for("page"):
        assert named("seed") == "Seed"
    assert named("seed") == "seed"
