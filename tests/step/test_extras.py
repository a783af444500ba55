"""What needs an extra says which; nothing else needs one (tests/conftest.py, test_offline.py)."""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from chord_usd.base.errors import MissingExtraError
from chord_usd.base.runtime import extras
from chord_usd.line.layout.device import choose_device
from tests.core_packages import EXTRAS, PROJECT, ROOT, closure, core_environment
from tests.verbs import VERBS

RunCli = Callable[..., subprocess.CompletedProcess[str]]

PLAN = ROOT / "examples" / "studio.png"
TRAINING = [verb for verb in VERBS if verb.startswith("train ")]
OTHERS = {
    "train text2plan --text-encoder tests": "train",
    f"layout {PLAN} --sampler dpm": "train",
    "batch --synth 1 --engine ray": "ray",
    "batch --synth 1 --parquet": "parquet",
}


@pytest.mark.parametrize(
    ("verb", "extra"), [*((verb, "train") for verb in TRAINING), *OTHERS.items()]
)
def test_one_line_names_the_extra(verb: str, extra: str, run_cli: RunCli, tmp_path: Path) -> None:
    output = tmp_path / ("out.png" if verb.startswith("layout") else "out")
    done = run_cli(*verb.split(), "-o", output, cwd=ROOT)
    assert done.returncode == 2
    (line,) = (line for line in done.stderr.splitlines() if not re.match(r"\w+: [\d.]+ s", line))
    assert line.startswith("error: ")
    assert f"Try: pip install '.[{extra}]'" in line
    assert not list(tmp_path.iterdir())


def test_scores_of_realism_are_an_extra(run_cli: RunCli) -> None:
    done = run_cli("evaluate", "layouts", "--n", 1, "--fid")
    assert done.returncode == 2
    assert "Try: pip install '.[evaluate]' in a clone of chord-usd, or --no-fid" in done.stderr


def test_tools_for_agents_are_an_extra(run_cli: RunCli, tmp_path: Path) -> None:
    done = run_cli("mcp", "--root", tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Try: pip install '.[mcp]'" in done.stderr


def test_the_page_is_an_extra(run_cli: RunCli, tmp_path: Path) -> None:
    done = run_cli("serve", "--root", tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Try: pip install '.[web]'" in done.stderr


def test_a_cuda_device_without_torch_is_named_or_done_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(ctypes, "CDLL", lambda _name: None)  # as if there were a driver
    monkeypatch.setitem(sys.modules, "torch", None)
    assert choose_device("auto") == "cpu"
    with pytest.raises(MissingExtraError, match=r"pip install '\.\[train\]'.*, or device=cpu"):
        choose_device("cuda")


def test_the_core_is_light() -> None:
    """What costs gigabytes, or seconds to import, is an extra."""
    heavy = {"torch", "torchvision", "diffusers", "transformers", "onnx", "ray", "pyarrow"}
    assert heavy & closure(PROJECT["dependencies"]) == set()
    assert heavy <= set(core_environment()["CHORD_USD_TEST_REFUSED"].split())


def test_extras_bring_what_is_said_of_them() -> None:
    """Of the packages that are installed here."""
    brought = {
        module: {canonicalize_name(name) for name in names}
        for module, names in packages_distributions().items()
    }
    for module, extra in extras.EXTRAS.items():
        wanted = {canonicalize_name(Requirement(line).name) for line in EXTRAS[extra]}
        assert module not in brought or wanted & brought[module], module


def test_every_extra_that_is_named_exists() -> None:
    told = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "chord_usd").rglob("*.py")]
    names = re.compile(r"'\.\[([a-z,]+)\]'")
    found = {
        name
        for file in told
        for group in names.findall(file.read_text())
        for name in group.split(",")
    }
    assert found
    assert found <= set(EXTRAS)
    assert set(extras.EXTRAS.values()) <= set(EXTRAS)
