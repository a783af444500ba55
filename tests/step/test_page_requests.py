"""What the page's server refuses: other origins, odd uploads, jobs and values, full queues."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

if not find_spec("nicegui"):
    pytest.skip("the extra web is not installed", allow_module_level=True)

from hypothesis import given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient

from chord_usd.faces.page import asked, job_queue, uploads
from chord_usd.faces.page.application import make_application
from tests.page_stand_in import (
    HERE,
    PNG,
    StandIn,
    ask,
    browser,
    dropped,
    until_over,
)

ROOT = Path(__file__).parents[2]


REFUSED: list[tuple[str, dict[str, str], int]] = [
    ("another name", {"host": "evil.example:8321"}, 403),
    ("no name", {"host": ""}, 403),
    ("another page", {"origin": "http://evil.example"}, 403),
    ("a file", {"origin": "null"}, 403),
    ("another port", {"origin": "http://127.0.0.1:9999"}, 403),
    ("a form", {"sec-fetch-site": "cross-site"}, 403),
]


@pytest.mark.parametrize(
    ("headers", "status"), [r[1:] for r in REFUSED], ids=[r[0] for r in REFUSED]
)
def test_requests_from_elsewhere_are_refused(
    page: TestClient, headers: dict[str, str], status: int
) -> None:
    assert page.post("/api/houses", json={"text": "a"}, headers=headers).status_code == status
    assert page.get("/api/houses").json() == {"houses": []}
    assert page.get("/api/houses", headers={"origin": HERE}).status_code == 200


@pytest.mark.parametrize(
    ("host", "base"), [("0.0.0.0", "http://192.168.0.2:8321"), ("127.0.0.1", HERE)]
)
def test_the_token_is_asked_for(tmp_path: Path, host: str, base: str) -> None:
    """On this machine, too: others may use it."""
    app = make_application(tmp_path, host=host, token="secret", run=StandIn())
    with TestClient(app, base_url=base, follow_redirects=False) as page:
        assert page.get("/").status_code == 401
        assert page.delete("/api/houses/0123456789ab").status_code == 401
        assert page.get("/?token=wrong").status_code == 401
        assert page.get("/", headers={"host": "evil.example"}).status_code == 403
        came = page.get("/?token=secret")
        assert (came.status_code, came.headers["location"]) == (303, "/")
        assert "HttpOnly" in came.headers["set-cookie"]
        assert "SameSite=strict" in came.headers["set-cookie"]
        assert page.get("/").status_code == 200
        # Cookies are the same for all ports of a machine.
        other = {"host": f"{base.removeprefix('http://')[:-4]}9999"}
        assert page.get("/", headers=other).status_code == 401


def test_two_names_of_the_host_are_refused(page: TestClient) -> None:
    twice = [("host", "127.0.0.1:8321"), ("host", "evil.example")]
    assert page.get("/api/houses", headers=twice).status_code == 400


BAD: list[tuple[str, str, bytes, int]] = [
    ("another kind", "plan.exe", PNG, 415),
    ("no suffix", "plan", PNG, 415),
    ("a wrong suffix", "plan.pdf", PNG, 415),
    ("nothing", "plan.png", b"", 415),
    ("a script", "plan.png", b"<script>", 415),
]


@pytest.mark.parametrize(("name", "data", "status"), [b[1:] for b in BAD], ids=[b[0] for b in BAD])
def test_bad_uploads_are_refused(
    page: TestClient, tmp_path: Path, name: str, data: bytes, status: int
) -> None:
    answer = page.post("/api/houses", params={"name": name}, content=data)
    assert answer.status_code == status
    assert answer.json()["error"]
    assert page.get("/api/houses").json() == {"houses": []}
    assert [p.name for p in tmp_path.iterdir() if not p.name.startswith(".")] == []


def test_large_uploads_are_refused_early(page: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """By what they say of themselves, and else as soon as they are too large."""
    headers = {"content-length": str(200 * 2**20)}
    answer = page.post("/api/houses", params={"name": "a.png"}, content=PNG, headers=headers)
    assert answer.status_code == 413
    monkeypatch.setattr(uploads, "MOST_BYTES", 1000)
    taken: list[int] = []

    def endless() -> Iterator[bytes]:
        for _ in range(100):
            taken.append(1)
            yield PNG[:500]

    answer = page.post("/api/houses", params={"name": "a.png"}, content=endless())
    assert answer.status_code == 413
    assert page.get("/api/houses").json() == {"houses": []}


def test_names_never_become_paths(page: TestClient, tmp_path: Path) -> None:
    house = dropped(page, "../../etc/<script>alert(1)</script>\0\n.png")
    assert [p.name for p in (tmp_path / house).iterdir() if p.name.startswith("source")] == [
        "source.png"
    ]
    for path in ("../house.json", "..%2f..%2fhouse.json", "house.json"):
        for kind in ("view", "packs", "pictures"):
            answer = page.get(f"/api/houses/{house}/versions/1/{kind}/{path}")
            assert answer.status_code == 404
    for name in ("../application.py", "..%2fapplication.py", "%2e%2e/gate.py"):
        assert page.get(f"/page/{name}").status_code == 404
    assert page.get("/api/houses/..").status_code == 404
    assert page.get("/api/houses/..%2f..").status_code == 404


def test_a_full_disk_is_told(page: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uploads, "LEAST_FREE_BYTES", 2**62)
    answer = page.post("/api/houses", params={"name": "a.png"}, content=PNG)
    assert answer.status_code == 507
    assert "MB left" in answer.json()["error"]


ODD: list[dict[str, Any]] = [
    {"kind": "shell", "given": {}},
    {"kind": "pack", "given": {"version": 1, "for": "../x"}},
    {"kind": "render", "given": {"version": 1, "camera": "Top", "quality": "best"}},
    {"kind": "render", "given": {"version": 1}},
    {"kind": "furnish", "given": {"seed": {"a": 1}}},
    {"kind": "furnish", "given": {"furniture": "x" * 3000}},
    {"kind": "furnish", "given": []},
    {"kind": "furnish", "given": {"sky": "/etc/sky.exr"}},
    {"kind": "furnish", "given": {"seed": -1}},
    {"kind": "furnish", "given": {"seed": True}},
    {"kind": "furnish", "given": {"style": "a\0b"}},
    {"kind": ["furnish"], "given": {}},
    {"kind": "pack", "given": {"version": 1, "for": ["usda"]}},
    {"kind": "render", "given": {"version": 1, "camera": "Top", "quality": {}}},
    {"kind": "refurnish", "given": {"version": 1, "room": "Bedroom_0", "keep": [1]}},
    {"kind": "swap", "given": {"version": 1}},
    {},
]


@pytest.mark.parametrize("body", ODD, ids=lambda body: json.dumps(body)[:40])
def test_odd_jobs_are_refused(page: TestClient, body: dict[str, Any]) -> None:
    house = dropped(page)
    assert page.post(f"/api/houses/{house}/jobs", json=body).status_code == 400


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=5,
)
ASKED = ("text", "below", "part", "name", "shown", "base", "plan", "drawing", "edits", "kind")
ASKED_OF = (
    ("POST", ""), ("PATCH", "/HOUSE"), ("PUT", "/HOUSE/plan"), ("POST", "/HOUSE/jobs"),
    ("PUT", "/HOUSE/versions/1/edits"),
)  # fmt: skip


def test_values_of_any_type_are_answered(tmp_path: Path) -> None:
    with browser(tmp_path, StandIn()) as page:
        house = dropped(page)
        ask(page, house, "furnish")
        until_over(page, house, 2)

        @settings(max_examples=150)
        @given(
            st.sampled_from(ASKED_OF),
            st.dictionaries(st.sampled_from(ASKED), JSON_VALUES, max_size=4),
            st.dictionaries(st.sampled_from(list(asked.GIVEN)), JSON_VALUES, max_size=3),
        )
        def answered(place: tuple[str, str], body: dict[str, Any], more: dict[str, Any]) -> None:
            method, path = place
            body = {"kind": "pack", "given": more, **body} if path.endswith("jobs") else body
            answer = page.request(
                method,
                f"/api/houses{path.replace('HOUSE', house)}",
                content=json.dumps(body),
                headers={"content-type": "application/json"},
            )
            assert answer.status_code < 500 or answer.status_code == 503, body
            assert "error" in answer.json() or answer.is_success

        answered()


def test_a_full_queue_keeps_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither what finds it full, nor what was being sent while it filled."""
    monkeypatch.setattr(job_queue, "MOST_WAITING", 2)
    with browser(tmp_path, StandIn(30)) as page:
        asked_for = [page.post("/api/houses", json={"text": "a flat"}) for _ in range(6)]
        assert [one.status_code for one in asked_for] == [201, 201, 201, 503, 503, 503]
        assert asked_for[-1].headers["retry-after"]
        assert len(page.get("/api/houses").json()["houses"]) == 3
        for job in page.get(f"/api/houses/{asked_for[2].json()['id']}").json()["jobs"]:
            page.delete(f"/api/jobs/{job['id']}")

        taken = job_queue.JobQueue.submit
        monkeypatch.setattr(job_queue, "MOST_WAITING", 3)

        def filled(queue: Any, *words: Any, **more: Any) -> Any:
            monkeypatch.setattr(job_queue, "MOST_WAITING", 0)
            return taken(queue, *words, **more)

        monkeypatch.setattr(job_queue.JobQueue, "submit", filled)
        late = page.post("/api/houses", params={"name": "a.png"}, content=PNG)
        assert late.status_code == 503
        assert len(page.get("/api/houses").json()["houses"]) == 3
    assert len([one for one in tmp_path.iterdir() if one.name[0] != "."]) == 3


def test_what_a_job_asks_for_finds_a_full_queue_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    verbs = StandIn()
    with browser(tmp_path, verbs) as page:
        house = dropped(page)
        until_over(page, house)
        verbs.seconds = 0.3
        ask(page, house, "furnish")
        monkeypatch.setattr(job_queue, "MOST_WAITING", 0)
        jobs = until_over(page, house, 3)["jobs"]
        assert [job["state"] for job in jobs] == ["done"] * 3
