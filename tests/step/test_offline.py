"""No verb looks up a name, talks to another machine or opens a port to one, or needs an extra."""

from __future__ import annotations

import json
import os
import shlex
import socket
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from string import Formatter

import cv2
import numpy as np
import pytest
import trimesh

from tests.core_packages import core_environment
from tests.network_trace import run_traced
from tests.verbs import VERBS

ROOT = Path(__file__).parents[2]
CLI = [sys.executable, "-m", "chord_usd.cli"]
ONE = "--n 1 --steps 1"
TRAIN = "-o {out} --minutes 0.001 --batch 1"

QUICK: dict[str, str] = {
    "generate": "{plan} -o {out}/house.usda --steps 1 --redraws 0",
    "plan read": "{plan} -o {out}/plan.json",
    "plan draw": "{scene} -o {out}/plan.png",
    "plan from-text": "'one bedroom' -o {out}/plan.json --steps 1",
    "layout": "{plan} -o {out}/layout.png --steps 1",
    "graph": "{layout} -o {out}/scene.json",
    "stage": "{scene} -o {out}/house.usda",
    "render": "{house} -o {out} --camera Top --samples 1 --resolution 32x32",
    "farm bundle": "{house} -o {out}/bundle",
    "farm due": "{job} -o {out}/pictures",
    "check": "{house}",
    "completion": "bash",
    "describe": "{house}",
    "export": "{house} --for gltf -o {out}/house.glb",
    "diff": "{house} {house}",
    "history": "{changed}",
    "undo": "{changed}",
    "redo": "{undone}",
    "edit": "{house} unlock_the_bed_in_bedroom_1 -o {out}/edited.usda",
    "mcp": "--root {out}",
    "serve": "--root {out}/houses --port 0",
    "dataset synth": "-o {out}/houses --count 1 --rasters",
    "dataset import": "{houses} -o {out}/houses",
    "dataset clean": "{houses} -o {out}/houses",
    "dataset stats": "{houses} --plot {out}/plot.png",
    "dataset split": "{houses} -o {out}/split.json",
    "dataset keep": "{houses} -o {out}/kept.jsonl.gz",
    "dataset draw": "{houses} -o {out}/sheet.png",
    "dataset release": "--count 1 -o {out}/release --workers 1 --steps 1 --redraws 0 --no-dressing",
    "dataset twins": "{houses} -o {out}/twins --count 1",
    "train detector": f"{TRAIN} --score-houses 1",
    "evaluate detector": "--houses 1 --generated 0",
    "evaluate scenes": "{houses}",
    "assets list": "",
    "assets nearest": "table --size 1x1x1",
    "assets show": "Lamp_Shade --sheet {out}/sheet.png",
    "assets add": "{models} -o {out}/own",
    "assets export": "Book_Lying --for simready -o {out}/props",
    "assets grasps": "Book_Lying",
    "looks list": "",
    "looks show": "planks --picture {out}/planks.png",
    "looks sheet": "plaster -o {out}/sheet.png",
}
"""A small working example of each verb."""

SLOW: dict[str, str] = {
    "plan from-outline": "{open_plan} --scale 0.05 -o {out}/plan.json --steps 1",
    "batch": "--synth 1 -o {out}/houses --workers 1 --steps 1 --redraws 0 --no-tabletop",
    "regenerate": "{house} --room Bathroom_0 -o {out}/house.usda --steps 1 --no-tabletop",
    "train plan2layout": f"{TRAIN} --workers 0",
    "train table": f"{TRAIN} --workers 0",
    "train text2plan": f"{TRAIN} --workers 0",
    "train outline2plan": f"{TRAIN} --workers 0",
    "train bubbles": f"{TRAIN} --houses 2",
    "train lists": TRAIN,
    "train boxes": TRAIN,
    "train reader": f"{TRAIN} --workers 0",
    "train symbols": f"{TRAIN} --workers 0",
    "train next": "--dry-run",
    "evaluate layouts": ONE,
    "evaluate ood": "--n 1 --draws 1 --per-room 1",
    "evaluate speed": f"{ONE} --sampler ddim",
    "evaluate diversity": f"{ONE} --seeds 2",
    "evaluate plans": "--count 1",
    "evaluate tabletops": f"{ONE} --houses 1",
    "evaluate text": ONE,
    "evaluate outlines": ONE,
    "assets build": "-o {out}/assets",
}
"""They import nothing that the others do not, and take minutes."""

EXTRAS = ("train", "mcp", "serve", "assets grasps")
"""Verbs that train, talk to agents and browsers, or simulate."""

OF_EACH_COMMIT = ("layout", "plan read", "export", "mcp", "serve")
"""A verb of each kind: networks, OCR, files of others, servers."""

ALL = {**QUICK, **SLOW}

WAIT_S = 6
"""ONNX Runtime looks up its host some seconds after a session is made."""

LOAD_AND_WAIT = f"""
import time
from chord_usd.line.pipeline.planner import SKETCH_CHECKPOINT, checkpoint_folder
from chord_usd.line.planning.sketcher import load_sketcher
from chord_usd.line.plan.text import warm_up
network = load_sketcher(checkpoint_folder(SKETCH_CHECKPOINT))
warm_up()
time.sleep({WAIT_S})
"""

RAY = """
import sys
from pathlib import Path
from tests import batch_makers as makers
from chord_usd.faces.batch.ray_engine import RayEngine
from chord_usd.faces.batch.run import run_batch
folder = Path(sys.argv[1])
engine = RayEngine(None, 1, cpus=1, gpus=0.0, folder=folder)
run_batch(makers.units("a"), makers.order(folder), engine, load=makers.honest(folder))
assert makers.made(folder) == ["a"]
"""


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a user who never ran anything has."""
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="module")
def environment(home: Path) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("XDG_")}
    # What the tests themselves have set in this process must not help.
    for name in ("ORT_DISABLE_TELEMETRY", "RAY_USAGE_STATS_ENABLED", "HF_HUB_OFFLINE"):
        kept.pop(name, None)
    return {
        **kept,
        "HOME": str(home),
        "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests"))),
    }


@pytest.fixture(scope="module")
def inputs(
    run_cli: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path_factory: pytest.TempPathFactory,
) -> Callable[[str], Path]:
    """What the examples start from by its name, made by the verbs when it is first asked for."""
    base = tmp_path_factory.mktemp("inputs")

    def by_verb(*words: object) -> Path:
        assert run_cli(*words).returncode == 0
        return Path(str(words[words.index("-o") + 1]))

    def open_plan() -> Path:
        drawn = np.full((256, 256, 3), 255, np.uint8)
        cv2.rectangle(drawn, (30, 40), (220, 200), (0, 0, 0), 5)
        cv2.imwrite(str(base / "open.png"), drawn)
        return base / "open.png"

    def changed(name: str) -> Path:
        house = by_verb("stage", made("scene"), "-o", base / name / "house.usda")
        by_verb("edit", house, "lock the bed in bedroom 1", "-o", house)
        return house

    def undone() -> Path:
        house = changed("undone")
        assert run_cli("undo", house).returncode == 0
        return house

    def models() -> Path:
        (base / "models").mkdir()
        trimesh.creation.box((0.5, 0.9, 0.5)).export(base / "models" / "chair.obj")
        row = {"file": "chair.obj", "category": "chair", "licence": "CC0-1.0", "author": "Jo"}
        (base / "models" / "manifest.json").write_text(json.dumps([row]))
        return base / "models"

    makers: dict[str, Callable[[], Path]] = {
        "plan": lambda: ROOT / "examples" / "studio.png",
        "scene": lambda: ROOT / "tests" / "fixtures" / "furnished_house.json",
        "house": lambda: by_verb("stage", made("scene"), "-o", base / "house.usda"),
        "job": lambda: by_verb("farm", "bundle", made("house"), "-o", base / "job"),
        "layout": lambda: by_verb("layout", made("plan"), "-o", base / "layout.png", "--steps", 1),
        "houses": lambda: by_verb("dataset", "synth", "-o", base / "houses", "--count", 2),
        "changed": lambda: changed("changed"),
        "undone": undone,
        "models": models,
        "open_plan": open_plan,
    }

    @cache
    def made(name: str) -> Path:
        return makers[name]()

    return made


def test_every_verb_has_an_example() -> None:
    assert sorted([*QUICK, *SLOW]) == sorted(VERBS)


@pytest.mark.parametrize(
    "what",
    [
        "socket.getaddrinfo('example.invalid', 80)",
        "socket.create_server(('0.0.0.0', 0))",
        "socket.create_server(('::', 0), family=socket.AF_INET6)",
        "socket.socket().listen()",
        "socket.socket(type=socket.SOCK_DGRAM).connect(('192.0.2.1', 9))",
        "socket.socket(type=socket.SOCK_DGRAM).sendto(b'x', ('192.0.2.1', 9))",
        "socket.socket().connect(('192.0.2.1', 9))",
    ],
)
def test_the_check_sees_what_leaves(what: str, tmp_path: Path) -> None:
    """Also in a child process, and with or without a network: the system call is seen."""
    script = f"import socket\nsocket.setdefaulttimeout(1)\ntry: {what}\nexcept OSError: pass"
    child = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {script!r}])"
    done, left = run_traced([sys.executable, "-c", child], tmp_path / "trace", os.environ)
    assert done.returncode == 0, done.stderr
    assert left


@pytest.mark.parametrize("family", [socket.AF_INET, socket.AF_INET6])
def test_the_check_lets_loopback_pass(family: int, tmp_path: Path) -> None:
    host = {socket.AF_INET: "127.0.0.1", socket.AF_INET6: "::1"}[socket.AddressFamily(family)]
    script = (
        f"import socket\ns = socket.create_server(({host!r}, 0), family={int(family)})\n"
        "socket.create_connection(s.getsockname()[:2]).sendall(b'x')"
    )
    done, left = run_traced([sys.executable, "-c", script], tmp_path / "trace", os.environ)
    if family == socket.AF_INET6 and "Cannot assign" in done.stderr:
        pytest.skip("no IPv6 here")
    assert done.returncode == 0, done.stderr
    assert left == []


@pytest.mark.parametrize(
    "verb",
    [
        pytest.param(verb, marks=() if verb in OF_EACH_COMMIT else pytest.mark.acceptance)
        for verb in ALL
    ],
)
def test_nothing_leaves(
    verb: str, inputs: Callable[[str], Path], environment: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    named = {name for _, name, _, _ in Formatter().parse(ALL[verb]) if name} - {"out"}
    words = shlex.split(ALL[verb].format(out=out, **{name: inputs(name) for name in named}))
    if verb == "mcp":
        pytest.importorskip("mcp", reason="the extra mcp is not installed")
    if verb == "serve" and not find_spec("nicegui"):
        pytest.skip("the extra web is not installed")
    # All others run without extras, too.
    core = {} if verb.startswith(EXTRAS) else core_environment()
    # A server ends when it is told to.
    until = ["timeout", "--preserve-status", str(WAIT_S)] if verb == "serve" else []
    command = [*until, *CLI, *verb.split(), *words]
    done, left = run_traced(command, tmp_path / "trace", {**environment, **core})
    assert done.returncode in (0, 1), done.stderr
    assert left == []


def test_networks_report_nothing_later_either(
    home: Path, environment: dict[str, str], tmp_path: Path
) -> None:
    """As a library, and with the time that the look-up of ONNX Runtime's reports takes."""
    command = [sys.executable, "-c", LOAD_AND_WAIT]
    done, left = run_traced(command, tmp_path / "trace", environment)
    assert done.returncode == 0, done.stderr
    assert left == []
    assert not list(home.glob(".cache/Microsoft*"))


def test_a_ray_cluster_of_this_machine_is_on_loopback(
    environment: dict[str, str], tmp_path: Path
) -> None:
    pytest.importorskip("ray", reason="the extra ray is not installed")
    command = [sys.executable, "-c", RAY, tmp_path / "houses"]
    done, left = run_traced(command, tmp_path / "trace", environment)
    assert done.returncode == 0, done.stderr
    assert left == []
