"""What an agent does first, through the protocol's own client; and what it may not do."""

from __future__ import annotations

import asyncio
import base64
import io
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.chord_json import read_plan, write_plan
from chord_usd.cli import build_parser
from chord_usd.faces.commands.paths import check_paths
from tests.bare_stage import write_bare_stage

pytest.importorskip("mcp", reason="the extra mcp is not installed")

from mcp import Client, StdioServerParameters, stdio_client

from chord_usd.base.runtime.house_history import Deed, recorded
from chord_usd.base.runtime.verb_calls import Answer, ReportProgress, run_verb
from chord_usd.faces.commands.agent_tools import MOST_PICTURES, PICTURE_PX, RunVerb, make_server

ROOT = Path(__file__).parents[2]
DRAWING = ROOT / "examples" / "studio.png"
PLAN = ROOT / "tests" / "fixtures" / "furnished_house.json"
HOUSE, EDITED = "flat/house.usda", "flat/edited.usda"
SERVER = [sys.executable, "-m", "chord_usd", "mcp", "--root"]

Say = Callable[..., Awaitable[tuple[dict[str, Any], list[Image.Image]]]]


async def stand_in(words: Any, root: Path, told: ReportProgress) -> Answer:
    """Verbs in this process; of those that take long, only the command line is understood."""
    options = build_parser(words).parse_args([*words, "--progress", "none"])
    check_paths(options.parser, options)
    await told(options.verb, 1, 2)
    if options.verb == "plan":
        write_plan(read_plan(PLAN), options.output)
        Image.new("RGB", (600, 400)).save(options.overlay)
        return Answer({"plan": str(options.output)}, True)
    if options.verb == "generate":
        options.output.parent.mkdir(exist_ok=True)
        write_bare_stage(read_plan(PLAN), options.output)
        Image.new("RGB", (1200, 900)).save(options.preview)
        return Answer({"stage": str(options.output)}, True)
    if options.verb == "regenerate":
        layer = options.stage.read_text().replace('Xform "Window_0"', 'Xform "Window_9"')
        with recorded(options.output, Deed("regenerate", options.room)):
            options.output.write_text(f"{layer}\n")
        return Answer({"stage": str(options.output), "room": options.room}, True)
    if options.verb == "render":
        names = [f"{options.output}/{number}.png" for number in range(MOST_PICTURES + 1)]
        options.output.mkdir()
        for name in names:
            Image.new("RGB", (1280, 720)).save(name)
        return Answer({"pictures": names}, True)
    outcome = options.run(options)
    return Answer(outcome.data, outcome.holds)


def talk(root: Path, what: Callable[[Say], Awaitable[None]], run: RunVerb = stand_in) -> None:
    """Let a client talk to a server in this process."""

    async def session() -> None:
        async with Client(make_server(root, run)) as client:

            async def say(tool: str, **given: Any) -> tuple[dict[str, Any], list[Image.Image]]:
                answer = await client.call_tool(tool, given)
                text, *pictures = answer.content
                if answer.is_error:
                    raise ChordError(text.text)
                drawn = [Image.open(io.BytesIO(base64.b64decode(one.data))) for one in pictures]
                return json.loads(text.text), drawn

            await what(say)

    asyncio.run(session())


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is open, with a plan in it; and beside it, one that is not."""
    opened = tmp_path / "open"
    opened.mkdir()
    shutil.copy(DRAWING, opened / "drawn.png")
    (tmp_path / "secret.usda").write_text("#usda 1.0\n")
    monkeypatch.chdir(opened)
    return opened


REALLY = [pytest.param(run_verb, id="real", marks=pytest.mark.acceptance)]


@pytest.mark.parametrize("run", [pytest.param(stand_in, id="stand-in"), *REALLY])
def test_ten_things_that_an_agent_does_first(root: Path, run: RunVerb) -> None:
    """With the real verbs it takes minutes."""

    async def session(say: Say) -> None:
        read, (overlay,) = await say("read_plan", drawing="drawn.png", plan="plan.json")
        assert read["plan"] == "plan.json"
        assert overlay.width > 100
        made, (preview,) = await say("furnish", house=HOUSE, plan="plan.json", steps=4)
        assert made["stage"] == HOUSE
        assert max(preview.size) == PICTURE_PX
        held, (seen,) = await say("look", house=HOUSE)
        assert max(seen.size) == PICTURE_PX
        room = next(one["name"] for one in held["rooms"] if one["name"].startswith("Bathroom"))
        before = (root / HOUSE).read_bytes()
        said = "put a basket in the bathroom"
        if run is run_verb:  # bare rooms have no furniture to edit, which a dry run tries
            told, _ = await say("edit", house=HOUSE, sentence=said, dry_run=True)
            assert told["rooms"] == [room]
        with pytest.raises(ChordError, match="--paint it blue"):
            await say("edit", house=HOUSE, sentence="--paint it blue")
        assert (root / HOUSE).read_bytes() == before
        changed, _ = await say("refurnish_room", house=HOUSE, room=room, steps=1)
        assert changed["room"] == room
        assert (root / HOUSE).read_bytes() != before
        shutil.copy(root / HOUSE, root / EDITED)
        undone, _ = await say("undo", house=HOUSE)
        assert [undone[key] for key in ("number", "undo", "redo")] == [1, None, 2]
        assert [one["verb"] for one in undone["changes"]] == ["begin", "regenerate"]
        assert (root / HOUSE).read_bytes() == before
        told, _ = await say("diff", before=HOUSE, after=EDITED)
        assert told["changes"]
        certified, _ = await say("check", house=HOUSE)
        assert certified["holds"] == (run is run_verb)  # bare rooms are empty
        package, _ = await say("export", house=HOUSE, package="dxf", output="flat/plan.dxf")
        assert (root / "flat" / "plan.dxf").stat().st_size == package["bytes"] > 0
        rendered, pictures = await say(
            "render", house=HOUSE, folder="pictures", samples=1, cameras=["Top"]
        )
        assert len(pictures) == min(len(rendered["pictures"]), MOST_PICTURES)
        assert all(max(picture.size) <= PICTURE_PX for picture in pictures)
        listed, _ = await say("list_files")
        assert listed["houses"] == [EDITED, HOUSE]
        assert {"drawn.png", "plan.json", *rendered["pictures"]} <= set(listed["files"])

    talk(root, session, run)


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("../secret.usda", "leads out"),
        ("flat/../../secret.usda", "leads out"),
        ("link.usda", "leads out"),
        ("folder/secret.usda", "leads out"),
        ("{tmp}/secret.usda", "no path below"),
        ("{tmp}/open/drawn.png", "no path below"),
        ("", "no path below"),
        ("a\0b", "control character"),
        ("a" * 300, "more than 255 bytes"),
        ("a/" * 3000 + "b", "more than 3900 bytes"),
        ("a\ud800b", "no path in UTF-8"),
        (".chord-usd.history/house.usda", "hidden"),
        ("nowhere.usda", "no such file"),
    ],
)
def test_paths_elsewhere_are_refused(root: Path, path: str, reason: str) -> None:
    (root / "link.usda").symlink_to(root.parent / "secret.usda")
    (root / "folder").symlink_to(root.parent)
    given = path.format(tmp=root.parent)

    async def session(say: Say) -> None:
        with pytest.raises(ChordError, match=reason):
            await say("look", house=given)
        with pytest.raises(ChordError, match=reason):
            await say("export", house=given, package="dxf", output="plan.dxf")
        if "such" not in reason:
            with pytest.raises(ChordError, match=reason):
                await say("read_plan", drawing="drawn.png", plan=given)
        assert (await say("list_files"))[0] == {
            "houses": [], "files": ["drawn.png"], "more": False,
        }  # fmt: skip

    talk(root, session)


def test_no_file_is_replaced(root: Path) -> None:
    async def session(say: Say) -> None:
        with pytest.raises(ChordError, match="is there already"):
            await say("read_plan", drawing="drawn.png", plan="drawn.png")
        with pytest.raises(ChordError, match="is there already"):
            await say("furnish", house="drawn.png", plan="drawn.png")
        with pytest.raises(ChordError, match="no folder"):
            await say("render", house="drawn.png", folder="drawn.png")

    talk(root, session)


@pytest.mark.parametrize("word", ["a\0b", "half \ud800", "x" * 200_000])
def test_a_word_that_no_process_takes_is_refused_in_a_sentence(root: Path, word: str) -> None:
    async def told(step: str, done: int, total: int) -> None:
        del step, done, total

    async def session() -> None:
        with pytest.raises(ChordError, match=r"is too long|half a character") as caught:
            await run_verb(["edit", "house.usda", word], root, told)
        assert len(str(caught.value)) < 200

    asyncio.run(session())


def test_values_are_no_options_and_mistakes_are_told(root: Path) -> None:
    async def session(say: Say) -> None:
        await say("furnish", house="-o.usda", plan="drawn.png", furniture="--seed=7")
        with pytest.raises(ChordError, match="there is no style"):
            await say("furnish", house="b.usda", plan="drawn.png", style="--json")
        with pytest.raises(ChordError, match="no such file"):
            await say("furnish", house="b.usda", plan="drawn.png", sky="mine.exr")

    talk(root, session)


def test_a_stage_may_not_refer_to_files_elsewhere(root: Path) -> None:
    """In the verb's process, which is told what is open."""
    (root / "sly.usda").write_text("#usda 1.0\n(\n    subLayers = [@../secret.usda@]\n)\n")

    async def session(say: Say) -> None:
        with pytest.raises(ChordError, match="refers to files outside"):
            await say("look", house="sly.usda")

    talk(root, session, run_verb)


def test_calls_on_one_house_wait_and_on_two_do_not(root: Path) -> None:
    for name in ("one.usda", "two.usda"):
        (root / name).write_text("#usda 1.0\n")
    at_work: list[str] = []
    together: set[tuple[str, ...]] = set()
    both = asyncio.Event()

    async def slow(words: Any, root: Path, told: ReportProgress) -> Answer:
        at_work.append(words[1])
        together.add(tuple(sorted(at_work)))
        if len(set(at_work)) == 2:
            both.set()
        await asyncio.wait_for(both.wait(), 60.0)  # however late the other call comes
        await asyncio.sleep(0.05)
        at_work.remove(words[1])
        return Answer({}, True)

    async def session(say: Say) -> None:
        calls = [say("check", house=name) for name in ("one.usda", "one.usda", "two.usda")]
        await asyncio.gather(*calls)

    talk(root, session, slow)
    assert ("./one.usda", "./two.usda") in together
    assert ("./one.usda", "./one.usda") not in {pair[:2] for pair in together}


def test_a_call_that_is_not_wanted_any_more_ends_its_verb(root: Path) -> None:
    """plan from-text takes seconds; nothing of it is left."""

    async def session() -> None:
        begun = asyncio.Event()

        async def told(step: str, done: int, total: int) -> None:
            begun.set()

        words = ["dataset", "synth", "--count=500", "--output=./houses"]
        call = asyncio.create_task(run_verb(words, root, told))
        await begun.wait()
        call.cancel()
        with pytest.raises(asyncio.CancelledError):
            await call

    asyncio.run(session())
    assert [path.name for path in root.iterdir()] == ["drawn.png"]


def test_as_a_program_it_says_nothing_but_the_protocol(root: Path) -> None:
    write_bare_stage(read_plan(PLAN), root / "house.usda")
    environment = {"PYTHONPATH": str(ROOT)}

    async def session() -> None:
        started = StdioServerParameters(
            command=SERVER[0], args=[*SERVER[1:], str(root)], env=environment
        )
        async with Client(stdio_client(started)) as client:
            steps = []

            async def progress(done: float, total: float | None, step: str | None) -> None:
                steps.append(step)

            answer = await client.call_tool(
                "look", {"house": "house.usda"}, progress_callback=progress
            )
            assert not answer.is_error
            assert [one.type for one in answer.content] == ["text", "image"]
            assert "describe" in steps

    asyncio.run(session())
    hello = {"jsonrpc": "2.0", "id": 1, "method": "ping"}
    done = subprocess.run(
        [*SERVER, str(root), "--json"], input=json.dumps(hello) + "\n", capture_output=True,
        text=True, timeout=60, check=False, env={**os.environ, **environment},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert [json.loads(line)["id"] for line in done.stdout.splitlines()] == [1]


def test_a_folder_that_is_not_there_is_refused(root: Path) -> None:
    done = subprocess.run([*SERVER, "nowhere"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("error: nowhere: cannot be read (no such file)")
