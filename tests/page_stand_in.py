"""Verbs of a page that take no time, and how its server is talked to."""

from __future__ import annotations

import json
import os
import struct
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import anyio
from starlette.testclient import TestClient

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.verb_calls import Answer, ReportProgress
from chord_usd.cli import build_parser
from chord_usd.faces.commands.paths import check_paths
from chord_usd.faces.page.application import make_application
from chord_usd.faces.page.gate import COOKIE

HERE, TOKEN = "http://127.0.0.1:8321", "secret"
SOON_S = 60.0
"""A state that has not come by then does not come, however busy the machine is."""

ROOT = Path(__file__).parents[1]
PLAN = ROOT / "tests" / "fixtures" / "furnished_house.json"
PNG = (ROOT / "examples" / "studio.png").read_bytes()
BED = "/House/Rooms/Bedroom_0/Furniture/Bed_0"


def as_glb(stage: str) -> bytes:
    """A GLB with one room and no meshes."""
    nodes = [{"name": "Bedroom_0", "extras": {"path": "/House/Rooms/Bedroom_0"}}]
    text = json.dumps({"asset": {"version": "2.0"}, "nodes": nodes, "of": stage}).encode()
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text


def stage_of(glb: bytes) -> str:
    return str(json.loads(glb[20:])["of"])


class StandIn:
    """Verbs that take no time: command lines are understood as the verbs would, outputs are small.

    A plan's text travels into all that is made of it, so that houses can be told apart.
    """

    def __init__(self, seconds: float = 0.0) -> None:
        self.lines: list[list[str]] = []
        self.seconds = seconds

    async def __call__(self, words: Sequence[str], root: Path, told: ReportProgress) -> Answer:
        before = Path.cwd()
        os.chdir(root)
        try:
            options = build_parser(words).parse_args([*words, "--progress", "none"])
            check_paths(options.parser, options)
            self.lines.append(list(words))
            return await self._done(options, root, told)
        finally:
            os.chdir(before)

    async def _done(self, options: Any, root: Path, told: ReportProgress) -> Answer:
        await told(options.verb, 1, 2)
        if self.seconds:
            await anyio.sleep(self.seconds)
        data: dict[str, Any] = {}
        if options.verb == "plan":
            source = getattr(options, "image", None) or getattr(options, "outline", "")
            seed = getattr(options, "text", "") or root.joinpath(source).read_bytes().hex()
            plan = {**json.loads(PLAN.read_text()), "seed": seed}
            root.joinpath(options.output).write_text(json.dumps(plan))
            if getattr(options, "drawing", None):
                root.joinpath(options.drawing).write_bytes(PNG)
                data["drawing"] = {"m_per_px": 0.02, "origin_m": [0, 0], "height_px": 100}
        elif options.verb == "generate":
            if "impossible" in (options.furniture or ""):
                raise ChordError("finds no place")
            plans = [json.loads(root.joinpath(plan).read_text()) for plan in options.plan]
            seed = " ".join(plan.get("seed", "") for plan in plans)
            stage = f"#usda 1.0\n# {seed}"
            root.joinpath(options.output).write_text(stage)
            root.joinpath(options.view).write_bytes(as_glb(stage))
            data = {"style": "modern", "certificate": None}
            if len(plans) > 1:
                data["storeys"] = [
                    {"name": f"Storey {at}", "elevation_m": 3.0 * at, "shift_m": [0.0, 0.0]}
                    for at in range(len(plans))
                ]
        elif options.verb == "regenerate":
            old = root.joinpath(options.stage).read_text()
            stage = f"{old}\n# {options.room} {options.keep}"
            root.joinpath(options.output).write_text(stage)
            root.joinpath(options.view).write_bytes(as_glb(stage))
            data = {"seed": 1, "certificate": {"holds": True}}
        elif options.verb == "export":
            target = root.joinpath(options.output)
            if options.package == "mujoco":
                target.mkdir()
                target = target / "house.xml"
            stage = root.joinpath(options.stage).read_text()
            target.write_bytes(as_glb(stage) if target.suffix == ".glb" else stage.encode())
        elif options.verb == "render":
            root.joinpath(options.output).mkdir(parents=True)
            root.joinpath(options.output, "Top.png").write_bytes(PNG)
            data = {"pictures": [f"{options.output}/Top.png"]}
        elif options.verb == "edit":
            stage = f"#usda 1.0\n# {options.sentence}"
            root.joinpath(options.output).write_text(stage)
            root.joinpath(options.view).write_bytes(as_glb(stage))
            data = {"rooms": ["Bedroom_0"], "moved": [BED], "removed": [], "taken_over": [BED]}
        elif options.verb == "assets":
            model = root / "library" / "Bed_Other" / "Bed_Other.usda"
            model.parent.mkdir(parents=True, exist_ok=True)
            model.write_text("#usda 1.0\n")
            told_of = {"id": "Bed_Other", "usd": str(model), "size_m": [2, 1.5, 1]}
            fits = {"center_m": [0, 0, 0], "size_m": [2, 1.4, 1]}
            looks = {"colour": ["oak"]}
            data = {"assets": [{**told_of, "fits": fits, "looks": looks, "shared": []}]}
            root.joinpath(options.pictures).mkdir(exist_ok=True)
            root.joinpath(options.pictures, "Bed_Other.png").write_bytes(PNG)
        elif options.verb == "check":
            data = {"holds": True, "collisions": []}
        return Answer(data, True)


def browser(root: Path, run: StandIn) -> TestClient:
    """A browser that has opened the address with the token."""
    application = make_application(root, token=TOKEN, run=run)
    return TestClient(application, base_url=HERE, cookies={f"{COOKIE}-8321": TOKEN})


def until_over(page: TestClient, house: str, jobs: int = 1) -> dict[str, Any]:
    """The house once all its jobs are over."""
    end_s = time.monotonic() + SOON_S
    while time.monotonic() < end_s:
        shown = page.get(f"/api/houses/{house}").json()
        states = [job["state"] for job in shown["jobs"]]
        if len(states) >= jobs and not {"queued", "running"} & set(states):
            return shown
        time.sleep(0.01)
    raise AssertionError(states)


def ask(page: TestClient, house: str, kind: str, **given: Any) -> dict[str, Any]:
    answer = page.post(f"/api/houses/{house}/jobs", json={"kind": kind, "given": given})
    assert answer.status_code == 200, answer.text
    return answer.json()


def dropped(page: TestClient, name: str = "plan.png", data: bytes = PNG) -> str:
    answer = page.post("/api/houses", params={"name": name}, content=data)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])
