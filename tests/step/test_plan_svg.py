"""SVG as design tools export it: by its names where it has them, else by its looks."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import extent_m, room_polygon
from chord_usd.base.scene.types import Plan
from chord_usd.line.plan.overlay import overlay_on
from chord_usd.line.plan.read import read_plan_file, read_storey_plans
from chord_usd.line.plan.vector.svg_page import read_page

# A flat of 10 x 7 m in centimetres: outer walls and three rooms as one path.
OUTER = "M0,0H1000V700H0Z"
HOLES = "M20,20V340H480V20Z M500,20V680H980V20Z M20,360V680H480V360Z"
FLOORS_M2 = [4.6 * 3.2, 4.6 * 3.2, 4.8 * 6.6]
EVEN_ODD = f'<path class="wall" fill="#222" fill-rule="evenodd" d="{OUTER} {HOLES}"/>'
NON_ZERO = f'<path class="wall" fill="#222" d="{OUTER} {HOLES}"/>'
OPENINGS = """
<rect class="door" x="480" y="150" width="20" height="80" fill="#fff"/>
<rect class="door" x="480" y="500" width="20" height="80" fill="#fff"/>
<rect class="door" x="0" y="480" width="20" height="90" fill="#fff"/>
<g class="windows" fill="#fff" stroke="#000" stroke-width="2">
<rect x="150" y="0" width="160" height="20"/><rect x="680" y="0" width="160" height="20"/>
<rect x="980" y="300" width="20" height="160"/><rect x="150" y="680" width="160" height="20"/>
</g>"""
LEAVES = """<g fill="none" stroke="#000" stroke-width="3">
<path d="M500,150h80a80,80 0 01-80,80"/><path d="M500,500h80a80,80 0 01-80,80"/>
<path d="M20,480h90a90,90 0 01-90,90"/></g>
<g font-size="30"><text x="200" y="190">Kitchen</text><text x="680" y="360">Living</text>
<text x="180" y="530">Bedroom</text></g>"""
HIDDEN = '<g class="off"><rect class="wall" width="1000" height="700"/></g>'
BODY = EVEN_ODD + OPENINGS + LEAVES
SHEET = 'viewBox="0 0 1000 700"'

NAMED = {
    "even-odd": (SHEET, BODY),
    "directions": (SHEET, NON_ZERO + OPENINGS),
    "rule in a style sheet": (
        SHEET,
        "<style>/* a */ .wall, path#x { fill-rule:evenodd }</style>"
        + EVEN_ODD.replace(' fill-rule="evenodd"', "") + OPENINGS,
    ),
    "hidden": (SHEET, "<style>g.off{display:none}</style>" + HIDDEN + BODY),
    "invisible": (SHEET, HIDDEN.replace("class=", 'style="visibility:hidden" class=') + BODY),
    "nested": (
        'viewBox="0 0 849 528"',
        f'<g transform="translate(60,20) scale(.7)"><g transform="rotate(0)">{BODY}</g></g>',
    ),
    "used": (SHEET, f'<defs><g id="a">{BODY}</g></defs><use href="#a"/>'),
    "symbol": (
        'viewBox="0 0 2000 2000"',
        f'<symbol id="a" {SHEET}>{BODY}</symbol><use href="#a" x="9" width="500" height="350"/>',
    ),
    "inner svg": ('viewBox="0 0 90 90"', f'<svg x="5" width="50" height="35" {SHEET}>{BODY}</svg>'),
    "upside down": ("", f'<g transform="matrix(1 0 0 -1 0 700)">{BODY}</g>'),
    "per cent": (f'width="100%" {SHEET}', BODY),
}  # fmt: skip
PER_UNIT = {"nested": 0.01 / 0.7, "symbol": 0.02, "inner svg": 0.2}


def svg(path: Path, said: str, body: str) -> Path:
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {said}>{body}</svg>')
    return path


def openings(plan: Plan) -> Counter[str]:
    return Counter(opening.kind for opening in plan.openings)


@pytest.mark.parametrize("name", NAMED)
def test_named_walls_are_read_as_they_are_drawn(name: str, tmp_path: Path) -> None:
    file = svg(tmp_path / "plan.svg", *NAMED[name])
    plan = read_plan_file(file, PER_UNIT.get(name, 0.01))
    areas = sorted(room_polygon(room).area for room in plan.rooms)
    assert areas == pytest.approx(sorted(FLOORS_M2), rel=0.01)
    assert openings(plan) == {"door": 3, "window": 4}


def test_lines_are_as_wide_as_their_groups_scale_them(tmp_path: Path) -> None:
    lines = '<g class="walls" fill="none" stroke-width="1" transform="scale(20)">'
    file = svg(tmp_path / "plan.svg", SHEET, lines + '<rect width="20" height="20"/></g>')
    assert extent_m(read_plan_file(file, 0.01).rooms) == pytest.approx(3.8, abs=0.01)


def without_names(body: str) -> str:
    for name in ("wall", "door", "windows"):
        body = body.replace(f'class="{name}"', "")
    return body


def test_without_names_it_is_read_by_its_looks(tmp_path: Path) -> None:
    """The page is 100 mm wide: at 1:100, the usual scale that the doors are near to, 10 m."""
    parts = f'<defs><g id="a">{without_names(BODY)}</g></defs><use href="#a"/>'
    body = f"<style>.off{{display:none}}</style>{parts}{without_names(HIDDEN)}"
    file = svg(tmp_path / "plan.svg", f'width="100mm" height="70mm" {SHEET}', body)
    plan = read_plan_file(file)
    areas = sorted(room_polygon(room).area for room in plan.rooms)
    assert areas == pytest.approx(sorted(FLOORS_M2), rel=0.05)
    assert openings(plan) == {"door": 3, "window": 4}
    assert plan.extra["scale"]["witness"] == "paper"
    assert plan.extra["scale"]["mPerPx"] == pytest.approx(0.01), "per unit of the file"
    assert {room.kind for room in plan.rooms} == {"kitchen", "living", "bedroom"}
    assert overlay_on(plan, file).shape == (1400, 2000, 3)


def test_walls_with_names_and_openings_without_are_read_by_their_looks(tmp_path: Path) -> None:
    body = EVEN_ODD + without_names(OPENINGS + LEAVES)
    found = read_storey_plans(svg(tmp_path / "plan.svg", SHEET, body), 0.01)
    assert [openings(one.plan) for one in found] == [{"door": 3, "window": 4}]
    assert extent_m(found[0].plan.rooms) == pytest.approx(9.6, rel=0.02)


@pytest.mark.parametrize(
    ("said", "paper", "stated"),
    [
        (f'width="1cm" {SHEET}', 1e-5 * 1000 / 2000, None),
        (f'width="10m" {SHEET}', None, 10.0 / 2000),
        (f'width="100%" {SHEET}', None, None),
        ("", None, None),
        ('width="500" height="70"', None, None),
    ],
)
def test_a_page_says_how_large_it_is(
    said: str, paper: float | None, stated: float | None, tmp_path: Path
) -> None:
    page = read_page(svg(tmp_path / "plan.svg", said, BODY))
    assert page.paper_m_per_px == (paper and pytest.approx(paper))
    assert page.stated_m_per_px == (stated and pytest.approx(stated))
    assert max(page.rgb.shape) == pytest.approx(2000, abs=2)


def test_a_printed_ratio_counts_on_paper(tmp_path: Path) -> None:
    body = BODY + '<text x="9" y="690">Scale 1:50</text>'
    page = read_page(svg(tmp_path / "plan.svg", f'width="20cm" {SHEET}', body))
    assert page.stated_m_per_px == pytest.approx(0.2 * 50 / 2000)
    named = read_plan_file(tmp_path / "plan.svg")
    assert extent_m(named.rooms) == pytest.approx(9.6, rel=0.01)


def test_a_page_opens_no_other_file(tmp_path: Path) -> None:
    (tmp_path / "other.svg").write_bytes(b"")
    svg(tmp_path / "other.svg", SHEET, '<rect id="a" width="1000" height="700"/>')
    names = f'xmlns:xlink="http://www.w3.org/1999/xlink" {SHEET}'
    references = "".join(
        f'<image {key}="{start}{tmp_path / "other.svg"}" width="1000" height="700"/>'
        for key in ("href", "xlink:href") for start in ("", "file://")
    )  # fmt: skip
    assert read_page(svg(tmp_path / "plan.svg", names, references)).rgb.min() == 255


def test_repeating_without_end_is_refused(tmp_path: Path) -> None:
    bomb = "".join(f'<g id="g{n}">' + f'<use href="#g{n - 1}"/>' * 10 + "</g>" for n in range(1, 9))
    body = '<rect id="g0" class="room" width="400" height="300"/><use href="#c" id="c"/>' + bomb
    with pytest.raises(PlanError, match="repeats more than 100,000 elements"):
        read_plan_file(svg(tmp_path / "plan.svg", SHEET, body), 0.01)
