"""How many clicks it takes on the page until the reading of a real plan is right.

    python benchmarks/page_corrections.py FOLDER [--pictures DIR]

FOLDER holds the pictures of CORRECTIONS, real plans that are not shipped. What is wrong in each
reading was judged by eye with the weights of 2026-11-26, and is put right as a hand would do it, in
headless Chromium: a tool and a place are two clicks; a piece, the list and its kind three; a piece
and "Delete" two. --pictures keeps the page before and after.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import cv2
from page_speed import CHROMIUM, DROP, LONGEST_MS, served
from playwright.sync_api import Page, expect, sync_playwright
from results import write_section

Correction = tuple[str, float, float]
"""What is done or what it is, at which pixel x, y of the picture. Tools of the page begin with a
plus."""

CORRECTIONS: dict[str, Sequence[Correction]] = {
    "r3d_47541863.png": (
        ("delete", 97, 413), ("bathroom", 133, 440), ("corridor", 190, 300), ("+door", 150, 410),
        ("+window", 78, 446),
    ),
    "r3d_30939153.png": (("store", 70, 288),),
    "uk_123.png": (("window", 220, 851),),
    "zind_floor_01.png": (("door", 1389, 1293),),
    "jp_r2v_annot.png": (("delete", 179, 272),),
    "f2b_example4.png": (
        ("window", 217, 159), ("window", 171, 251), ("window", 220, 251), ("passage", 262, 335),
    ),
    "resplan_0.png": (
        ("bedroom", 560, 620), ("bathroom", 745, 490), ("door", 451, 220), ("door", 646, 450),
        ("+door", 5, 624),
    ),
    "resplan_50.png": (("bedroom", 350, 130), ("bathroom", 600, 340)),
    "f2b_example5.png": (
        ("window", 269, 296), ("window", 225, 1022), ("door", 134, 64), ("corridor", 115, 150),
    ),
    "cubicasa_lines_10004.png": (("corridor", 310, 310), ("door", 378, 376)),
}  # fmt: skip

ON_PAGE = """([share_x, share_y, onWall]) => {
    const svg = document.querySelector("svg[role=application]");
    const picture = svg.querySelector("image");
    const of = (name) => Number(picture.getAttribute(name));
    const place = new DOMPoint(of("x") + share_x * of("width"), of("y") + share_y * of("height"));
    if (onWall) {
        const far = (line) => {
            const near = nearest(line);
            return Math.hypot(near.x - place.x, near.y - place.y);
        };
        const nearest = (line) => {
            const ends = ["x1", "y1", "x2", "y2"].map((name) => line.getAttribute(name));
            const [x1, y1, x2, y2] = ends.map(Number);
            const long = (x2 - x1) ** 2 + (y2 - y1) ** 2 || 1;
            const at = ((place.x - x1) * (x2 - x1) + (place.y - y1) * (y2 - y1)) / long;
            const share = Math.min(Math.max(at, 0.05), 0.95);
            return new DOMPoint(x1 + share * (x2 - x1), y1 + share * (y2 - y1));
        };
        const walls = [...svg.querySelectorAll(".wall")].sort((a, b) => far(a) - far(b));
        Object.assign(place, { x: nearest(walls[0]).x, y: nearest(walls[0]).y });
    }
    const seen = place.matrixTransform(svg.getScreenCTM());
    return [seen.x, seen.y];
}"""
"""From shares of a picture's width and height to the place on the screen; or that of the nearest
wall, which a hand aims at."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    rows = []
    with (
        tempfile.TemporaryDirectory() as root,
        served(Path(root)) as (_, address),
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=CHROMIUM)
        for name in CORRECTIONS:
            page = browser.new_page(viewport={"width": 1400, "height": 1000})
            page.set_default_timeout(LONGEST_MS)
            page.goto(address)
            clicks, changed = corrected(page, options.folder / name, options.pictures)
            rows.append((name, f"{clicks} clicks, {changed} corrected"))
            page.close()
        browser.close()
    sys.stdout.write(write_section("page_corrections", rows))


def corrected(page: Page, file: Path, pictures: Path | None) -> tuple[int, int]:
    """Drop a plan, put its reading right, and say in how many clicks and corrections."""
    page.get_by_label("Furnish it at once").uncheck()
    page.evaluate(DROP, [list(file.read_bytes()), file.name])
    page.locator("svg .floor").first.wait_for()
    page.wait_for_timeout(300)
    height, width = cv2.imread(str(file)).shape[:2]
    keep(page, pictures, f"{file.stem}_before")
    hand = Hand(page, width, height)
    for correction in CORRECTIONS[file.name]:
        before = page.locator("svg").first.inner_html()
        hand.correct(*correction)
        if page.locator("svg").first.inner_html() == before:
            raise SystemExit(f"{file.name}: {correction} changed nothing")
    with page.expect_response(lambda answer: answer.request.method == "PUT") as saved:
        pass
    assert saved.value.ok
    keep(page, pictures, f"{file.stem}_after")
    return hand.clicks, len(CORRECTIONS[file.name])


class Hand:
    """Clicks, and counts them."""

    def __init__(self, page: Page, width_px: int, height_px: int) -> None:
        self.page, self.size = page, (width_px, height_px)
        self.clicks = 0

    def correct(self, what: str, x: float, y: float) -> None:
        """Put one thing right."""
        if what.startswith("+"):
            self.page.locator(f"[data-tool={what[1:]}]").click()
            self.click(x, y, on_wall=True)
            self.clicks += 1
            return
        self.click(x, y)
        if what == "delete":
            self.page.get_by_role("button", name="Delete", exact=True).click()
            self.clicks += 1
            return
        expect(self.page.get_by_label("Kind")).to_be_visible()
        self.page.get_by_label("Kind").select_option(what)
        self.clicks += 2

    def click(self, x: float, y: float, *, on_wall: bool = False) -> None:
        """At a pixel of the picture."""
        shares = [x / self.size[0], y / self.size[1], on_wall]
        self.page.mouse.click(*self.page.evaluate(ON_PAGE, shares))
        self.clicks += 1


def keep(page: Page, folder: Path | None, name: str) -> None:
    """A picture of the page, where they are wanted."""
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=str(folder / f"{name}.png"))


if __name__ == "__main__":
    main()
