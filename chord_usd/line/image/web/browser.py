"""A page in a headless Chromium, with three.js and one house."""

from __future__ import annotations

import base64
import shutil
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.extras import needed_for, three_module
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.line.image.exr import PixelArray
from chord_usd.line.image.stage_cameras import StageCamera

if TYPE_CHECKING:
    from playwright.sync_api import Page, Playwright

_SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Of Chromium: WebGL on a CPU, which needs no display."""

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_PAGE = (
    '<!doctype html><link rel="icon" href="data:,"><script type="module" src="studio.js"></script>'
)
_SLOWEST_MS = 300_000
_ENGINE = "<engine=web>"

Shot = tuple[PixelArray, PixelArray]
"""(H, W, 3) linear light, and (H, W, 3) albedo."""


class Studio:
    """One house in a browser."""

    def __init__(self, page: Page, size_px: tuple[int, int]) -> None:
        self._page, self._size_px = page, size_px

    def shoot(self, view: StageCamera, rooms: Sequence[str]) -> Shot:
        """What a camera sees, lit by the lamps and windows of these rooms."""
        taken = self._call("shoot", asdict(view), list(self._size_px), list(rooms))
        light, albedo = (self._pixels(taken[name], np.float16) for name in ("light", "albedo"))
        return light[..., :3], albedo[..., :3]

    def develop(self, exposure_ev: float) -> bytes:
        """The last shot as a PNG."""
        return base64.b64decode(self._call("develop", 2.0**exposure_ev))

    def measure(self, view: StageCamera) -> PixelArray:
        """(H, W, 4) as studio.js packs them: number, distance in metres, normal's x and y."""
        return self._pixels(self._call("measure", asdict(view), list(self._size_px)), np.float32)

    def _call(self, name: str, *words: Any) -> Any:
        from playwright.sync_api import Error

        try:
            return self._page.evaluate(f"(words) => window.{name}(...words)", list(words))
        except Error as error:
            raise RenderError(
                f"the browser could not draw: {error.message.splitlines()[0]}",
                where=_ENGINE,
                try_=("fewer pixels", "<engine=cycles>"),
            ) from error

    def _pixels(self, packed: str, kind: type[np.floating[Any]]) -> PixelArray:
        width_px, height_px = self._size_px
        flat = np.frombuffer(base64.b64decode(packed), kind)
        # Graphics libraries count rows from the bottom.
        return flat.reshape(height_px, width_px, 4)[::-1].astype(np.float32)


@contextmanager
def studio(
    write_house: Callable[[Path], None], numbers: Mapping[str, int], size_px: tuple[int, int]
) -> Iterator[Studio]:
    """A browser that shows a house.

    write_house: writes it as a .glb. numbers: of things, by the path of their prim. Raises
    MissingExtraError, RenderError where there is no Chromium or it does not start.
    """
    with needed_for(_ENGINE):
        from playwright.sync_api import sync_playwright
    three = three_module()
    with scratch_folder() as folder, _served(folder) as address, sync_playwright() as playwright:
        shutil.copyfile(three, folder / "three.js")
        shutil.copyfile(Path(__file__).with_name("studio.js"), folder / "studio.js")
        (folder / "index.html").write_text(_PAGE)
        write_house(folder / "house.glb")
        browser = _launched(playwright)
        try:
            page = browser.new_page()
            page.set_default_timeout(_SLOWEST_MS)
            page.goto(f"{address}/index.html")
            page.wait_for_function("() => window.ready")
            opened = Studio(page, size_px)
            opened._call("opened", "/house.glb", dict(numbers))
            yield opened
        finally:
            browser.close()


def _launched(playwright: Playwright) -> Any:
    from playwright.sync_api import Error

    program = next((path for name in _NAMES if (path := shutil.which(name))), None)
    try:
        # Without a browser of the system, the browser of `playwright install chromium`.
        return playwright.chromium.launch(executable_path=program, args=list(_SOFTWARE))
    except Error as error:
        raise RenderError(
            "no Chromium starts on this machine",
            where=_ENGINE,
            expected="a program chromium or chrome",
            try_=(
                "apt-get install chromium",
                "playwright install chromium",
                "<engine=cycles>",
            ),
        ) from error


@contextmanager
def _served(folder: Path) -> Iterator[str]:
    """The address of a folder, on this machine alone: modules load from no file."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}"
    finally:
        server.shutdown()
        server.server_close()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nobody reads along."""
