"""The page's server: what it does for its browser."""

from __future__ import annotations

import io
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import zipfile
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

if not find_spec("nicegui"):
    pytest.skip("the extra web is not installed", allow_module_level=True)

import uvicorn
from starlette.testclient import TestClient

from chord_usd.faces.page import serving
from chord_usd.faces.page.application import make_application
from tests.page_stand_in import (
    BED,
    PLAN,
    PNG,
    SOON_S,
    StandIn,
    ask,
    browser,
    dropped,
    stage_of,
    until_over,
)

ROOT = Path(__file__).parents[2]


def test_from_drop_to_download(page: TestClient, verbs: StandIn) -> None:
    house = dropped(page)
    shown = until_over(page, house)
    assert (shown["name"], shown["plan"], shown["drawing"]["height_px"]) == ("plan", 1, 100)
    assert page.get(f"/api/houses/{house}/drawing.png").content == PNG

    kept = page.get(f"/api/houses/{house}/plan").json()
    put = page.put(f"/api/houses/{house}/plan", json={"base": 1, "plan": kept["plan"]})
    assert put.json() == {"number": 2}
    ask(page, house, "furnish", seed=3, style="modern", roof="hip", furniture="Bedroom 1: desk")
    shown = until_over(page, house, 3)
    assert shown["shown"] == 1
    assert [job["kind"] for job in shown["jobs"]] == ["read", "furnish", "check"]
    assert verbs.lines[1][1].endswith("plans/0002.json")
    assert {"--seed=3", "--style=modern", "--roof=hip"} < set(verbs.lines[1])
    first = f"/api/houses/{house}/versions/1"
    view = page.get(f"{first}/view/view.glb")
    assert stage_of(view.content).startswith("#usda")

    ask(page, house, "refurnish", version=1, room="Bedroom_0", keep=["Bed_0"])
    ask(page, house, "render", version=1, camera="Top")
    for kind in ("usda", "mujoco", "ifc"):
        ask(page, house, "pack", version=1, **{"for": kind})
    shown = until_over(page, house, 9)
    assert [job["error"] for job in shown["jobs"]] == [""] * 9
    (one,) = shown["versions"]
    assert one["rooms"] == ["Bedroom_0"]
    assert page.get(f"{first}/{one['view']}").content != view.content
    assert shown["past"]["undo"] == "regenerate --room=Bedroom_0"
    assert page.get(f"{first}/pictures/{one['pictures'][0]}").content == PNG
    assert one["certificate"]["holds"]
    assert one["packs"] == ["house.ifc", "house.zip", "house_mujoco.zip"]
    packed = page.get(f"{first}/packs/house.zip")
    assert "plan.zip" in packed.headers["content-disposition"]
    assert zipfile.ZipFile(io.BytesIO(packed.content)).namelist() == ["house/house.usda"]
    page.patch(f"/api/houses/{house}", json={"shown": 1, "name": "<b>Mine</b>/../x"})
    assert page.get("/api/houses").json()["houses"][0] | {"made": 0} == {
        "id": house, "name": "x", "made": 0, "shown": 1,
    }  # fmt: skip
    assert page.delete(f"/api/houses/{house}").status_code == 200
    assert page.get("/api/houses").json() == {"houses": []}


def test_an_outline_is_divided(page: TestClient) -> None:
    house = dropped(page, "outline.json", PLAN.read_bytes())
    ask(page, house, "divide", text="two bedrooms")
    shown = until_over(page, house, 2)
    assert shown["plan"] == 2
    plan = page.get(f"/api/houses/{house}/plan").json()["plan"]
    assert plan["seed"] == "two bedrooms"


def test_twenty_at_once_are_not_mixed_up(page: TestClient) -> None:
    """All are queued, all are done, and each house is of its own text."""
    texts = [f"a flat of {20 + number} m²" for number in range(20)]
    houses = [page.post("/api/houses", json={"text": text}).json()["id"] for text in texts]
    for house in houses:
        ask(page, house, "furnish")
    for house, text in zip(houses, texts, strict=True):
        until_over(page, house, 2)
        view = page.get(f"/api/houses/{house}/versions/1/view/view.glb")
        assert stage_of(view.content) == f"#usda 1.0\n# {text}"


def test_what_fails_says_why_and_leaves_nothing(page: TestClient, tmp_path: Path) -> None:
    house = dropped(page)
    ask(page, house, "furnish", furniture="impossible")
    shown = until_over(page, house, 2)
    assert (shown["jobs"][1]["state"], shown["jobs"][1]["error"]) == ("failed", "finds no place")
    assert not list((tmp_path / house / "versions").iterdir())


def test_jobs_can_be_cancelled(tmp_path: Path) -> None:
    verbs = StandIn(seconds=30)
    with browser(tmp_path, verbs) as page:
        house = page.post("/api/houses", json={"text": "a flat"}).json()["id"]
        waiting = ask(page, house, "furnish")
        assert waiting["ahead"] == 1
        jobs = page.get(f"/api/houses/{house}").json()["jobs"]
        for job in jobs:
            assert page.delete(f"/api/jobs/{job['id']}").status_code == 200
        shown = until_over(page, house, 2)
        assert [job["state"] for job in shown["jobs"]] == ["cancelled"] * 2


def test_a_server_that_ended_says_so(tmp_path: Path) -> None:
    with browser(tmp_path, StandIn(30)) as page:
        house = page.post("/api/houses", json={"text": "a flat"}).json()["id"]
    with browser(tmp_path, StandIn()) as page:
        (job,) = page.get(f"/api/houses/{house}").json()["jobs"]
        assert job["state"] == "ended"
        assert page.post(f"/api/jobs/{job['id']}/again").status_code == 200
        assert until_over(page, house, 2)["plan"] == 1


def test_two_tabs_do_not_lose_a_correction(page: TestClient) -> None:
    house = dropped(page)
    until_over(page, house)
    plan = page.get(f"/api/houses/{house}/plan").json()["plan"]
    answers = [
        page.put(f"/api/houses/{house}/plan", json={"base": 1, "plan": plan}) for _ in range(2)
    ]
    assert [answer.status_code for answer in answers] == [200, 409]


PLACED = [[1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 1, 0], [0, 0, 0, 1]]
DESK = "/House/Rooms/Study_0/Furniture/Desk_0"


def test_changes_by_hand_are_a_layer_over_the_house(page: TestClient, verbs: StandIn) -> None:
    """As Blender's panel writes it; a room furnished anew keeps what is locked in it."""
    house = dropped(page)
    ask(page, house, "furnish")
    (first,) = until_over(page, house, 3)["versions"]
    assert first["certificate"]["holds"]
    address = f"/api/houses/{house}/versions/1/edits"
    pieces = {
        BED: {"was": PLACED, "matrix": PLACED},
        f"{DESK}/Items/Cup_0": {"was": PLACED, "matrix": None},
        "/House/Rooms/Bedroom_0/Dressing/Rug_0": {"was": PLACED, "matrix": PLACED},
    }
    edits = {"pieces": pieces, "locked": [BED]}
    assert page.put(address, json={"base": 0, "edits": edits}).json() == {"revision": 1}
    assert page.put(address, json={"base": 0, "edits": edits}).status_code == 409
    (first,) = page.get(f"/api/houses/{house}").json()["versions"]
    assert first["certificate"] is None, "it was that of the house before the changes"
    kept = page.get(address).json()
    assert (kept["edits"]["pieces"], kept["edits"]["locked"]) == (pieces, [BED])

    ask(page, house, "refurnish", version=1, room="Bedroom_0", keep=["Bed_0"])
    (first,) = until_over(page, house, 5)["versions"]
    assert first["certificate"] == {"holds": True, "collisions": []}, "of the house as it is now"
    assert verbs.lines[-1][1].endswith("house.edits.usda")
    assert any(word.startswith("--edits=") for word in verbs.lines[-2])
    carried = page.get(address).json()["edits"]
    assert set(carried["pieces"]) == {BED, f"{DESK}/Items/Cup_0"}

    ask(page, house, "say", version=1, sentence="--move the bed", force=1)
    shown = until_over(page, house, 7)
    assert "--force" in verbs.lines[-2]
    (first,) = shown["versions"]
    said = page.get(f"/api/houses/{house}/versions/1/{first['view']}").content
    assert stage_of(said).endswith("# move the bed")
    assert set(page.get(address).json()["edits"]["pieces"]) == {f"{DESK}/Items/Cup_0"}
    past = [one["told"] for one in shown["past"]["changes"]]
    assert past[1:] == ["by hand Rug_0, Bed_0, Cup_0", "regenerate --room=Bedroom_0",
                        "edit --move the bed"]  # fmt: skip

    now = page.get(address).json()["revision"]
    assert page.put(address, json={"base": now, "edits": {}}).status_code == 200
    assert page.get(address).json()["edits"]["pieces"] == {}


def test_all_that_was_done_can_be_undone_in_one_step_each(page: TestClient, tmp_path: Path) -> None:
    """A piece moved by hand, a room and a sentence: one history, that survives the page."""
    house = dropped(page)
    ask(page, house, "furnish")
    until_over(page, house, 3)
    first = f"/api/houses/{house}/versions/1"
    plain = page.get(f"{first}/view/view.glb").content
    moved = {"pieces": {BED: {"was": PLACED, "matrix": PLACED}}, "locked": []}
    page.put(f"{first}/edits", json={"base": 0, "edits": moved})
    ask(page, house, "say", version=1, sentence="a plant")
    after = until_over(page, house, 5)
    said = page.get(f"{first}/{after['versions'][0]['view']}").content

    def go(way: str, **to: int) -> tuple[bytes, bool]:
        answer = page.post(f"{first}/past", json={"way": way, **to})
        assert answer.status_code == 200, answer.text
        shown = until_over(page, house)
        view = page.get(f"{first}/{shown['versions'][0]['view']}").content
        return view, bool(page.get(f"{first}/edits").json()["edits"]["pieces"])

    assert go("undo") == (plain, True)
    assert go("undo") == (plain, False)
    assert page.post(f"{first}/past", json={"way": "undo"}).status_code == 400
    assert go("redo") == (plain, True)
    assert go("redo")[0] == said
    assert go("to", to=1) == (plain, False)
    assert page.post(f"{first}/past", json={"way": "to", "to": 99}).status_code == 400
    assert page.post(f"{first}/past", json={"way": "back"}).status_code == 400
    (index,) = tmp_path.rglob("changes.json")
    index.write_text("{}")
    assert "another version" in page.get(f"/api/houses/{house}").json()["past"]["error"]


def test_a_piece_is_swapped_and_stays_so_in_later_versions(
    page: TestClient, tmp_path: Path
) -> None:
    house = dropped(page)
    ask(page, house, "furnish")
    ask(page, house, "models", category="bed", size="2x1.5x1")
    jobs = until_over(page, house, 4)["jobs"]
    ((offered,),) = (job["answer"]["models"] for job in jobs if job["kind"] == "models")
    assert page.get(f"/api/models/{offered['id']}.png").content == PNG
    ask(page, house, "swap", version=1, model=offered["id"], colour="oak")
    made = until_over(page, house, 5)["jobs"][-1]["answer"]
    address = f"/api/houses/{house}/versions"
    assert page.get(f"{address}/1/models/{made['view']}").status_code == 200

    swap = {"usd": made["usd"], "slot_m": [2, 1.5, 1], "offset_m": [0, 0]}
    swap |= {"size_m": offered["fits"]["size_m"], "looks": {"colour": "oak"}}
    pieces = {BED: {"was": PLACED, "matrix": PLACED, "swap": swap}}
    for odd in ("assets/../house.usda", "assets/Other/Other.usda"):
        wrong = {BED: {"was": PLACED, "matrix": PLACED, "swap": {**swap, "usd": odd}}}
        answer = page.put(f"{address}/1/edits", json={"base": 0, "edits": {"pieces": wrong}})
        assert answer.status_code == 400
    page.put(f"{address}/1/edits", json={"base": 0, "edits": {"pieces": pieces}})
    ask(page, house, "refurnish", version=1, room="Study_0")
    until_over(page, house, 7)
    kept = page.get(f"{address}/1/edits").json()["edits"]["pieces"][BED]["swap"]
    assert kept["usd"] == made["usd"]
    folder = tmp_path / house / "versions" / "0001"
    assert (folder / "house" / made["usd"]).is_file()
    assert made["usd"] in (folder / "house" / "house.edits.usda").read_text()


@pytest.mark.parametrize(
    "edits",
    [
        {"pieces": {'/House" { } def "x': {"was": PLACED, "matrix": PLACED}}},
        {"pieces": {f"{BED}/../..": {"was": PLACED, "matrix": PLACED}}},
        {"pieces": {BED: {"was": PLACED, "matrix": [[1, 2], [3, 4]]}}},
        {"pieces": {BED: {"was": PLACED, "matrix": [[1e9] * 4] * 4}}},
        {"locked": ["/Elsewhere"]},
        {"locked": ["/House/Rooms/Bedroom_0/Furniture/1Bed"]},
        {"pieces": {"/House/Rooms/Küche_0/Furniture/Bed_0": {"was": PLACED, "matrix": PLACED}}},
        {"pieces": {f"{BED}/²": {"was": PLACED, "matrix": PLACED}}},
        [],
    ],
)
def test_odd_changes_are_refused(page: TestClient, edits: Any) -> None:
    house = dropped(page)
    ask(page, house, "furnish")
    until_over(page, house, 2)
    answer = page.put(f"/api/houses/{house}/versions/1/edits", json={"base": 0, "edits": edits})
    assert answer.status_code == 400


def test_the_page_loads_nothing_from_elsewhere(page: TestClient) -> None:
    """What the page is made of lies in the package, and a policy says so to the browser."""
    first = page.get("/")
    assert "default-src 'self'" in first.headers["content-security-policy"]
    seen, left = set(), re.findall(r'(?:src|href)="(/page/[^"]+)"', first.text)
    while left:
        address = left.pop()
        if address not in seen:
            seen.add(address)
            answer = page.get(address)
            assert answer.status_code == 200, address
            if address != "/page/three.js":
                names = re.findall(r'(?:from|import)\s*\(?"\./([^"]+)"', answer.text)
                left += [f"/page/{name}" for name in names]
                assert not re.findall(r"https?://(?!www\.w3\.org)", answer.text), address
    assert {"/page/main.js", "/page/style.css", "/page/three.js"} <= seen


def started(root: Path, *more: str) -> tuple[subprocess.Popen[str], str]:
    words = [sys.executable, "-m", "chord_usd", "serve", "--root", str(root), "--port", "0", *more]
    server = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert server.stdout
    return server, server.stdout.readline().strip()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Callable[..., tuple[subprocess.Popen[str], str]]]:
    running: list[subprocess.Popen[str]] = []

    def start(*more: str) -> tuple[subprocess.Popen[str], str]:
        process, address = started(tmp_path / "houses", *more)
        running.append(process)
        return process, address

    yield start
    for process in running:
        process.kill()
        process.communicate()


def test_the_verb_serves_lightly_and_ends_in_order(
    server: Callable[..., tuple[subprocess.Popen[str], str]],
) -> None:
    process, address = server()
    assert "/?token=" in address
    port = int(address.partition("/?token=")[0].rpartition(":")[2])
    with socket.create_connection(("127.0.0.1", port)) as line:
        line.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        assert line.recv(12) == b"HTTP/1.1 401", "without the token"
    status = Path(f"/proc/{process.pid}/status").read_text()
    assert int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) < 250 * 1024  # type: ignore[index]
    second, nothing = server()
    assert (second.wait(SOON_S), nothing) == (2, "")
    assert "another server has this folder" in second.stderr.read()  # type: ignore[union-attr]
    process.send_signal(signal.SIGTERM)
    assert process.wait(SOON_S) == 0


def test_half_a_head_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever sends a header now and then would keep a connection for ever."""
    monkeypatch.setattr(serving, "HEAD_S", 0.5)
    app = make_application(tmp_path, token="secret", run=StandIn())
    config = uvicorn.Config(app, port=0, http=serving.TimedProtocol, log_config=None)
    running = uvicorn.Server(config)
    thread = threading.Thread(target=running.run, daemon=True)
    thread.start()
    while not running.started:
        time.sleep(0.01)
    port = running.servers[0].sockets[0].getsockname()[1]
    whole = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()
    for before in (b"", whole):
        with socket.create_connection(("127.0.0.1", port), timeout=5.0) as line:
            line.sendall(before)
            if before:
                assert line.recv(12) == b"HTTP/1.1 401"
            with pytest.raises(ConnectionError):  # the server ended it
                line.sendall(b"GET / HTTP/1.1\r\n")
                for number in range(40):
                    line.sendall(b"X-%d: a\r\n" % number)
                    time.sleep(0.1)
    running.should_exit = True
    thread.join(5.0)


def test_a_port_in_use_is_an_error(
    server: Callable[..., tuple[subprocess.Popen[str], str]],
) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        process, _ = server("--port", str(other.getsockname()[1]))
        assert process.wait(SOON_S) == 2
        assert "Try: --port 0" in process.stderr.read()  # type: ignore[union-attr]


def test_plans_of_one_house_are_its_storeys(page: TestClient, verbs: StandIn) -> None:
    ground = dropped(page)
    until_over(page, ground)
    sent = page.post(f"/api/houses?below={ground}&name=first.png", content=PNG)
    first = sent.json()["id"]
    second = page.post("/api/houses", json={"below": first, "part": 2}).json()["id"]
    until_over(page, second)
    assert "--part=2" in verbs.lines[-1]
    for house in (ground, first, second):
        storeys = page.get(f"/api/houses/{house}").json()["storeys"]
        assert [one["id"] for one in storeys] == [ground, first, second]
    assert [one["id"] for one in page.get("/api/houses").json()["houses"]] == [ground]
    ask(page, ground, "furnish")
    shown = until_over(page, ground, 3)
    plans = [word for word in verbs.lines[-2] if word.endswith(".json")]
    assert [word.split("/")[1] for word in plans] == [ground, first, second]
    (version,) = shown["versions"]
    assert [one["elevation_m"] for one in version["storeys"]] == [0.0, 3.0, 6.0]
    page.delete(f"/api/houses/{ground}")
    assert page.get(f"/api/houses/{second}").status_code == 404


def test_odd_storeys_are_refused(page: TestClient) -> None:
    house = dropped(page)
    until_over(page, house)
    assert page.post("/api/houses?below=nowhere&name=a.png", content=PNG).status_code == 404
    for part in (0, "2", None, 10**9):
        sent = page.post("/api/houses", json={"below": house, "part": part})
        assert sent.status_code == 400
        assert "part" in sent.json()["error"]
