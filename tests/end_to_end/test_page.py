"""The page in a real browser, with the real verbs: from a plan that is dropped to a download."""

from __future__ import annotations

import io
import re
import shutil
import socket
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

if not shutil.which("chromium"):
    pytest.skip("there is no chromium: apt-get install chromium", allow_module_level=True)
if not (find_spec("nicegui") and find_spec("playwright")):
    pytest.skip("the extras web and dev are not installed", allow_module_level=True)

import uvicorn
from PIL import Image
from playwright.sync_api import Locator, Page, Request, expect, sync_playwright
from pxr import Usd

from chord_usd.base.runtime.verb_calls import Answer, ReportProgress
from chord_usd.base.runtime.warm_calls import WarmVerbs
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.types import ByteArray
from chord_usd.faces.page.application import make_application
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.storey_houses import random_storeys

PLAN = Path(__file__).parents[2] / "examples" / "studio.png"
QUICK = ("--steps=1", "--redraws=0", "--no-tabletop", "--no-dressing")
SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
LONGEST_MS = 300_000
"""A state that never comes is a failure; a busy machine is none."""

EYE_LEVELS = 16
"""Values of a channel, of 255, by which a pixel has changed for an eye."""

SEEN_SHARE, SAME_SHARE = 0.01, 0.002
"""Shares of pixels that differ: of two pictures that differ, and of two of the same."""

SCRIPT = "<img src=x onerror=document.title='taken'>"


class Quickly(WarmVerbs):
    """The verbs themselves; the house is the simplest that they make."""

    async def __call__(self, words: Sequence[str], root: Path, told: ReportProgress) -> Answer:
        more = QUICK if words[0] == "generate" else ()
        return await super().__call__([*words, *more], root, told)


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        application = make_application(tmp_path, token="secret", run=Quickly())
        config = uvicorn.Config(application, log_config=None)
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/?token=secret"
        server.should_exit = True
        thread.join(20)


@pytest.fixture
def page() -> Iterator[Page]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(SOFTWARE)
        )
        tab = browser.new_page(viewport={"width": 760, "height": 480})
        tab.set_default_timeout(LONGEST_MS)
        expect.set_options(timeout=LONGEST_MS)
        yield tab
        browser.close()


def drop(page: Page, file: Path) -> None:
    """As a hand drops a file out of a folder."""
    page.evaluate(
        """([bytes, name]) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([Uint8Array.from(bytes)], name));
            const area = document.querySelector(".drop");
            area.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer }));
        }""",
        [list(file.read_bytes()), file.name],
    )


def drag_up(page: Page, canvas: Locator) -> None:
    """Drag what is in the middle of the view."""
    place = canvas.bounding_box()
    assert place
    x, y = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 40, steps=2)
    page.mouse.up()


def until(page: Page, holds: Callable[[], object]) -> None:
    """Wait for a state that is not in the page's document."""
    end_s = time.monotonic() + LONGEST_MS / 1000
    while not holds():
        assert time.monotonic() < end_s, "the state did not come"
        page.wait_for_timeout(200)


def looked_at(page: Page) -> ByteArray:
    """The middle of the view, clear of what lies over its rim, as RGB."""
    place = page.locator("canvas").bounding_box()
    assert place
    x, y, wide, high = (place[name] for name in ("x", "y", "width", "height"))
    shot = page.screenshot(
        clip={"x": x + wide / 4, "y": y + high / 4, "width": wide / 2, "height": high / 2}
    )
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))


def differing(one: ByteArray, other: ByteArray) -> float:
    """The share of pixels of which an eye sees that they differ; 1 where the sizes differ."""
    if one.shape != other.shape:
        return 1.0
    return float((np.abs(one.astype(int) - other.astype(int)).max(axis=2) > EYE_LEVELS).mean())


def settled(page: Page, holds: Callable[[ByteArray], bool]) -> ByteArray:
    """The view once it no longer changes and is as it should be."""
    seen = [looked_at(page)]

    def is_still() -> bool:
        seen.append(looked_at(page))
        return differing(*seen[-2:]) < SAME_SHARE and holds(seen[-1])

    until(page, is_still)
    return seen[-1]


def saved_pieces(page: Page, address: str) -> dict[str, Any]:
    """The pieces changed by hand, as the server has them."""
    script = "async (address) => (await (await fetch(address)).json()).edits.pieces"
    return dict(page.evaluate(script, address))


JOBS_ARE_OVER = """async () => {
    const asked = async (address) => (await fetch(address)).json();
    const { houses } = await asked("/api/houses");
    const shown = await Promise.all(houses.map(({ id }) => asked(`/api/houses/${id}`)));
    const isOver = ({ state }) => !["queued", "running"].includes(state);
    return shown.every(({ jobs }) => jobs.every(isOver));
}"""
"""A job that is not over has a line above the view, which makes the view smaller."""

JOINED_AGAIN = """async () => {
    const model = await import("/page/plan_model.js");
    const outline = [[0, 0], [900, 0], [900, 400], [600, 400], [600, 700], [0, 700]];
    const room = { roomId: "a", roomKind: "living", wallPoints: structuredClone(outline) };
    const plan = { rooms: [room], windowsDoors: [] };
    model.splitRoom(plan, room, 0, [300, 0]);
    const wall = room.wallPoints.findIndex((_, index) => model.edgeOf(room, index).out[0] > 0.9);
    model.addOpening(plan, room, wall, [290, 350], "door");
    model.addOpening(plan, room, 0, [100, 0], "window");
    model.joinRooms(plan, room, wall, [290, 200]);
    return {
        rooms: plan.rooms.length,
        corners: room.wallPoints.length,
        area: model.areaM2(room),
        openings: plan.windowsDoors.map((opening) => opening.type),
        beyond: model.joinRooms(plan, room, 0, [100, 0]),
    };
}"""
"""A room cut in two, and made one again by taking away that wall with its door."""


def test_from_drop_to_download(page: Page, address: str) -> None:
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
    page.goto(address)
    page.get_by_label("Furnish it at once").uncheck()
    drop(page, PLAN)

    # The reading, corrected: a wall dragged and dragged back, a room that is called as a script.
    areas = page.locator("svg text tspan:nth-child(2)")
    expect(areas.first).to_be_visible()
    before = areas.all_text_contents()
    expect(page.locator("svg .wall").first).to_be_attached()
    wall = page.locator("svg .wall").first.bounding_box()
    assert wall
    # Near its end, where no window is.
    x, y = wall["x"] + wall["width"] * 0.1, wall["y"] + wall["height"] * 0.1
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 15, y + 15, steps=3)
    page.mouse.up()
    expect(areas).not_to_have_text(before)
    page.get_by_role("button", name="Undo").click()
    expect(areas).to_have_text(before)
    page.locator("svg .floor").first.focus()
    page.keyboard.press("Enter")
    page.get_by_label("Name").fill(SCRIPT)
    page.get_by_label("Name").press("Enter")
    expect(page.locator("svg text").first).to_contain_text("onerror")

    joined = page.evaluate(JOINED_AGAIN)
    assert joined == {
        "rooms": 1, "corners": 6, "area": 54.0, "openings": ["window"], "beyond": False,
    }  # fmt: skip

    page.locator("#furnish").click()
    canvas = page.locator("canvas[data-ready]")
    canvas.wait_for()
    expect(canvas).to_have_attribute("data-calls", re.compile(r"[1-9]"))
    assert int(canvas.get_attribute("data-calls") or 0) <= 400

    # A piece, dragged, and moved by keys into a wall: the change outlives the page.
    puts: list[str] = []
    page.on("request", lambda sent: puts.append(sent.url) if sent.method == "PUT" else None)
    page.get_by_text("Furniture:").click()
    undo = page.get_by_role("button", name="Undo")
    for piece in page.locator("[data-path]").all():
        piece.evaluate("node => node.click()")
        expect(page.locator("#piece")).to_be_visible()
        drag_up(page, canvas)
        if undo.is_enabled():  # else something hid it
            break
    undo.click()
    expect(undo).to_be_disabled()
    until(page, lambda: puts and not saved_pieces(page, puts[-1]))
    for _ in range(200):
        canvas.press("ArrowLeft")
        if canvas.get_attribute("data-wrong") == "true":
            break
    expect(page.locator("#piece [role=status]")).to_contain_text("Stands in")
    until(page, lambda: saved_pieces(page, puts[-1]))
    page.reload()
    canvas.wait_for()

    # The certificate is of the house as it is now: after a change it is asked for.
    page.get_by_role("tab", name="Certificate").click()
    page.get_by_role("button", name=re.compile("^Check")).click()
    expect(page.get_by_role("heading", name="The certificate")).to_be_visible()
    page.get_by_role("tab", name="Files").click()
    page.locator("[data-pack=usda]").click()
    with page.expect_download() as taken:
        page.get_by_text("Download house.zip").click()
    assert page.title() != "taken"
    assert wrong == []
    opens(taken.value.path())


def opens(packed: Path) -> None:
    """The house in a zip opens with the change that was made by hand."""
    folder = packed.with_name("unpacked")
    with zipfile.ZipFile(io.BytesIO(packed.read_bytes())) as archive:
        archive.extractall(folder)
    stage = Usd.Stage.Open(str(folder / "house" / "house.edits.usda"))
    (room, *_) = stage.GetPrimAtPath("/House/Rooms").GetChildren()
    pieces = room.GetChild("Furniture").GetChildren()
    assert any(piece.GetAttribute("xformOp:transform").HasAuthoredValue() for piece in pieces)


def test_storeys_are_read_furnished_and_hidden(page: Page, address: str, tmp_path: Path) -> None:
    files = []
    for index, storey in enumerate(random_storeys(np.random.default_rng(12), 2)):
        files.append(tmp_path / f"plan {index}.json")
        write_plan(storey.plan, files[-1])
    page.goto(address)
    page.get_by_label("Furnish it at once").uncheck()
    page.locator("#file").set_input_files(files)
    expect(page.locator("#storeys select")).to_have_value(re.compile("[0-9a-f]{12}"))
    page.locator("#storeys select").select_option(index=1)
    expect(page.locator("#title")).to_have_text("plan 1")
    page.locator("#storeys select").select_option(index=0)
    expect(page.locator("#title")).to_have_text("plan 0")
    page.get_by_label("Roof").select_option("hip")
    page.locator("#furnish").click()
    expect(page.locator("canvas")).to_have_attribute("data-ready", "1")
    until(page, lambda: page.evaluate(JOBS_ARE_OVER))
    shown = page.locator("#storey")
    shown.select_option(index=1)
    ground = settled(page, lambda _: True)
    shown.select_option(index=0)
    whole = settled(page, lambda now: differing(now, ground) > SEEN_SHARE)
    page.get_by_label("Roof").check()
    roofed = settled(page, lambda now: differing(now, whole) > SEEN_SHARE)
    shown.select_option(index=1)
    under_roof = settled(page, lambda now: differing(now, roofed) > SEEN_SHARE)
    page.get_by_label("Roof").uncheck()
    settled(page, lambda now: differing(now, under_roof) < SAME_SHARE)
    page.get_by_role("button", name="Walk").click()
    expect(page.locator("#pad")).to_be_visible()


def test_doubts_lead_to_their_places_and_a_click_puts_right(
    page: Page, address: str, tmp_path: Path
) -> None:
    plan = random_plan(np.random.default_rng(1))
    kinds = {room.kind: room.id for room in plan.rooms}
    bath, kitchen = kinds["bathroom"], kinds["kitchen"]
    doors = [opening.id for opening in plan.openings][:2]
    warnings = [f"{bath}: a wall may be missing", f"it is uncertain what {', '.join(doors)} are"]
    write_plan(replace(plan, extra={**plan.extra, "warnings": warnings}), tmp_path / "plan.json")
    page.goto(address)
    page.get_by_label("Furnish it at once").uncheck()
    page.locator("#file").set_input_files([tmp_path / "plan.json"])
    drawing = page.get_by_role("application")
    whole = drawing.get_attribute("viewBox")
    plans: list[Any] = []

    def keep(call: Request) -> None:
        if call.method == "PUT":
            plans.append(call.post_data_json)

    page.on("request", keep)

    page.get_by_role("button", name=f"{bath}: a wall").click()
    expect(page.locator("#doubts")).to_be_visible()
    expect(page.locator(".floor.chosen")).to_have_attribute("data-key", f"r{bath}")
    assert drawing.get_attribute("viewBox") != whole
    for door in doors:
        page.get_by_role("button", name="it is uncertain").click()
        expect(page.locator(".opening.chosen")).to_have_attribute("data-key", f"o{door}")

    page.get_by_role("button", name=f"{bath}: a wall").click()
    page.get_by_role("button", name="The kitchen is here").click()
    page.locator(f'[data-key="w{bath}/0"]').press("Enter")
    page.get_by_label("Length, cm").fill("431")
    page.get_by_label("Length, cm").press("Enter")
    until(page, lambda: plans and room_of(plans[-1], bath)["roomKind"] == "kitchen")
    assert room_of(plans[-1], kitchen)["roomKind"] == "bathroom"
    until(page, lambda: abs(face_cm(room_of(plans[-1], bath)) - 431) < 1)
    count = len(plans[-1]["plan"]["rooms"])
    page.get_by_role("button", name="Delete the room").click()
    until(page, lambda: len(plans[-1]["plan"]["rooms"]) == count - 1)


def room_of(body: Any, room_id: str) -> dict[str, Any]:
    return next(room for room in body["plan"]["rooms"] if room["roomId"] == room_id)


def face_cm(room: dict[str, Any]) -> float:
    """The length of a room's first face."""
    (ax, ay), (bx, by) = room["wallPoints"][:2]
    return float(np.hypot(bx - ax, by - ay))
