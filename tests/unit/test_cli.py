"""The command line: quick to answer, one line per error, exit codes as documented."""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from chord_usd import cli
from chord_usd.base.errors import ChordError
from chord_usd.base.runtime import interrupts
from chord_usd.cli import build_parser, main
from chord_usd.faces.commands import check
from chord_usd.faces.commands.common import Outcome
from chord_usd.faces.commands.render import look_of, words_of
from tests.conftest import RunCli
from tests.every import for_every
from tests.verbs import ACTIONS


def test_the_parser_imports_nothing_heavy() -> None:
    code = (
        "import sys, chord_usd.cli; chord_usd.cli.build_parser();"
        "print([m for m in ('numpy', 'PIL', 'cv2', 'torch', 'pxr', 'shapely') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["fly"],
        ["generate"],
        ["generate", "plan.png"],
        ["generate", "plan.png", "-o", "h.usda", "--seed", "-1"],
        ["generate", "plan.png", "-o", "h.usda", "--seed", "x"],
        ["generate", "plan.png", "-o", "h.usda", "--scale", "nan"],
        ["generate", "plan.png", "-o", "h.usda", "--steps", "0"],
        ["generate", "plan.png", "-o", "h.usda", "--layout", "l.png"],
        ["render", "h.usda", "-o", "x", "--resolution", "0x10"],
        ["render", "h.usda", "-o", "x", "--resolution", "wide"],
        ["render", "h.usda", "-o", "x", "--tile", "4/4"],
        ["plan", "read"],
        ["plan", "draw", "missing.json", "-o", "x.png"],
        ["stage", "missing.json", "-o", "x.usda"],
        ["generate", "missing.png", "-o", "x.usda"],
    ],
    ids=" ".join,
)
def test_an_unusable_command_line_is_one_error_line(
    words: list[str],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(words) == cli.UNUSABLE
    told = capsys.readouterr()
    assert told.out == ""
    assert re.fullmatch(r"error: .+\n", told.err)
    assert "unexpected" not in told.err
    assert list(tmp_path.iterdir()) == []


INTEGERS = [
    (prog, action)
    for prog, action in ACTIONS
    if callable(action.type) and "whole_number" in action.type.__qualname__
]


def test_whole_numbers_are_read_in_one_way() -> None:
    assert len(INTEGERS) > 20
    assert not [prog for prog, action in ACTIONS if action.type in (int, float)]


@for_every(("prog", "action"), INTEGERS, ids=lambda case: f"{case[0]} {case[1].option_strings}")
def test_every_whole_number_has_a_range(prog: str, action: argparse.Action) -> None:
    """Told before a model is loaded, in a short line."""
    assert callable(action.type)
    for text in ("100000000000", "9" * 31, "9" * 5000, "-1", "1e3", "", "0x10", "nan"):
        with pytest.raises(argparse.ArgumentTypeError) as caught:
            action.type(text)
        assert len(str(caught.value)) < 80
    if action.default is not None:
        assert action.default == 0 or action.type(str(action.default)) == action.default


class TestOutcomes:
    """main around a verb that does what the test says."""

    @pytest.fixture
    def run_verb(self, monkeypatch: pytest.MonkeyPatch):
        def run(behaviour, *words: str) -> int:
            monkeypatch.setattr(check, "run", lambda options: behaviour())
            return main(["check", __file__, *words])

        return run

    def test_done(self, run_verb, capsys: pytest.CaptureFixture[str]) -> None:
        assert run_verb(lambda: Outcome("all well", {"valid": True})) == cli.DONE
        assert capsys.readouterr().out == "all well\n"

    def test_a_check_that_does_not_hold(self, run_verb) -> None:
        assert run_verb(lambda: Outcome("no", holds=False)) == cli.NOT_HELD

    def test_json_is_one_object_even_if_a_library_prints(
        self, run_verb, capsys: pytest.CaptureFixture[str]
    ) -> None:
        def chatty() -> Outcome:
            sys.stdout.write("a library says hello\n")
            return Outcome("text", {"valid": True})

        run_verb(chatty, "--json")
        assert json.loads(capsys.readouterr().out) == {"valid": True}

    def test_an_interrupt(self, run_verb, capsys: pytest.CaptureFixture[str]) -> None:
        def interrupted() -> Outcome:
            raise KeyboardInterrupt

        assert run_verb(interrupted) == interrupts.INTERRUPTED
        assert "Traceback" not in capsys.readouterr().err

    def test_an_interrupt_while_a_dataclass_is_made(self, tmp_path: Path) -> None:
        """The process ends with our code, not of the signal, wherever Ctrl-C finds it."""
        (tmp_path / "job.py").write_text(
            "import os, signal, sys\n"
            "from chord_usd import cli\n"
            "from chord_usd.faces.commands import describe\n"
            "def run(options):\n"
            "    exec('os.kill(os.getpid(), signal.SIGINT)\\nsignal.pause()')\n"
            "describe.run = run\n"
            "sys.exit(cli.main(['describe', 'job.py']))\n"
        )
        done = subprocess.run(
            [sys.executable, "-m", "job"],
            cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert (done.returncode, done.stdout) == (interrupts.INTERRUPTED, "")
        assert done.stderr == "error: interrupted, nothing was written\n"

    @pytest.mark.parametrize(
        "error",
        [
            ChordError("is broken", where="a.png", expected="a plan", try_="another"),
            FileNotFoundError(2, "No such file", "a.png"),
            MemoryError(),
            ZeroDivisionError("two\nlines"),
        ],
        ids=lambda error: type(error).__name__,
    )
    def test_errors_are_one_line(
        self, run_verb, error: Exception, capsys: pytest.CaptureFixture[str]
    ) -> None:
        def failing() -> Outcome:
            raise error

        assert run_verb(failing) == cli.UNUSABLE
        assert re.fullmatch(r"error: .+\n", capsys.readouterr().err)

    @pytest.mark.parametrize(
        ("said", "words"),
        [
            ("I/O error: No space left on device (os error 28)", "the disk is full. Try: free"),
            ("CUDA out of memory. Tried to allocate 2 GiB", "out of memory. Try: "),
            ("CUDA error: unspecified launch failure\nmore of it", "can no longer be used. Try: "),
        ],
    )
    def test_what_libraries_say_of_the_machine_is_put_plainly(
        self, run_verb, said: str, words: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        def failing() -> Outcome:
            raise RuntimeError(said)

        assert run_verb(failing) == cli.UNUSABLE
        line = capsys.readouterr().err
        assert words in line
        assert "unexpected" not in line

    def test_debug_shows_the_traceback(self, run_verb, capsys: pytest.CaptureFixture[str]) -> None:
        def failing() -> Outcome:
            raise ChordError("is broken")

        assert run_verb(failing, "--debug") == cli.UNUSABLE
        assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "size_px"),
    [
        ([], (1280, 720)),
        (["--quality", "draft"], (640, 360)),
        (["--quality", "draft", "--resolution", "64x32"], (64, 32)),
    ],
)
def test_drafts_are_small_unless_told(words: list[str], size_px: tuple[int, int]) -> None:
    options = build_parser().parse_args(["render", "house.usda", "-o", "pictures", *words])
    assert look_of(options)["resolution_px"] == size_px
    assert f"{size_px[0]}x{size_px[1]}" in words_of(options), "farms are told so, too"


def test_a_value_that_argparse_would_drop_is_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["train", "outline2plan", "--seed=--", "-o", "run"]) == 2
    assert capsys.readouterr().err.startswith("error: argument --seed: expected one argument")


@pytest.mark.parametrize(
    "words",
    [
        ("generate", "{out}/plan.png", "-o", "{root}/h.usda"),
        ("generate", "{root}/link.png", "-o", "{root}/h.usda"),
        ("generate", "{root}/plan.png", "-o", "{root}/h.usda", "--sky", "{out}/sky.exr"),
        ("generate", "{root}/plan.png", "-o", "{root}/h.usda", "--assets", "{out}"),
        ("render", "{root}/h.usda", "-o", "{root}/p", "--sky", "{root}/../out/sky.exr"),
    ],
)
def test_a_run_reads_its_open_folder_only(
    words: tuple[str, ...], run_cli: RunCli, tmp_path: Path
) -> None:
    """What a page or an agent asks for, whatever the option is called."""
    root, out = tmp_path / "root", tmp_path / "out"
    for folder in (root, out):
        folder.mkdir()
        for name in ("plan.png", "sky.exr", "h.usda"):
            (folder / name).write_bytes(b"secret")
    (root / "link.png").symlink_to(out / "plan.png")
    given = [word.format(root=root, out=out) for word in words]
    done = run_cli(*given, env={"CHORD_USD_ROOT": str(root)})
    assert done.returncode == 2
    assert "outside the folder that is open" in done.stderr


@pytest.mark.parametrize("option", ["--camera", "--passes"])
@pytest.mark.parametrize("text", ["", " , "])
def test_an_empty_list_of_names_is_no_list_of_all(
    option: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["render", str(tmp_path / "house.usda"), f"{option}={text}", "-o", str(tmp_path / "o")]
    assert main(words) == 2
    assert "is empty" in capsys.readouterr().err
