"""What happens to a page on its way into a computer; its labels go the same way.

Beside what paper.py does to single drawings: phones' screens, hand-drawn wobble, bilevel scans.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.page_labels import LAID_SHIFT, WRITING
from chord_usd.base.scene.types import ByteArray, FloatArray
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.page_styles import RGB


@dataclass(frozen=True, eq=False)
class Picture:
    """A page and its labels, on their way."""

    rgb: ByteArray
    labels: ByteArray
    matrix: FloatArray
    """(3, 3) from metres on the sheet to continuous pixels."""

    def warped(self, matrix: FloatArray, size: tuple[int, int], border: RGB) -> Picture:
        """Through a (3, 3) matrix in continuous pixels, onto (width, height) pixels."""
        # OpenCV counts from the middles of pixels.
        half = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1.0]])
        whole = np.linalg.inv(half) @ matrix @ half
        rgb = cv2.warpPerspective(
            self.rgb, whole, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT,
            borderValue=border,
        )  # fmt: skip
        labels = cv2.warpPerspective(self.labels, whole, size, flags=cv2.INTER_NEAREST)
        return Picture(_bytes(rgb), _bytes(labels), matrix @ self.matrix)

    def scaled(self, share: float, far: int) -> Picture:
        """Resized. far: an interpolation flag for shrinking."""
        size = max(8, round(self.rgb.shape[1] * share)), max(8, round(self.rgb.shape[0] * share))
        way = far if share < 1.0 else cv2.INTER_LINEAR
        rgb = cv2.resize(self.rgb, size, interpolation=way)
        labels = cv2.resize(self.labels, size, interpolation=cv2.INTER_NEAREST)
        shares = size[0] / self.rgb.shape[1], size[1] / self.rgb.shape[0]
        return Picture(_bytes(rgb), _bytes(labels), np.diag([*shares, 1.0]) @ self.matrix)


def _bytes(array: npt.NDArray[Any]) -> ByteArray:
    return np.asarray(array, np.uint8)


def worn(page: Picture, look: Look, rng: np.random.Generator) -> Picture:
    """The page as it arrives."""
    if rng.random() < 0.08:
        page = _turned(page, int(rng.integers(1, 4)))
    if look.kind == "sketch":
        page = _wobbled(page, rng)
    way = rng.random()
    photo_share = 0.5 if look.kind == "sketch" else 0.06
    if way < photo_share:
        page = _photographed(page, rng)
    elif way < photo_share + 0.09:
        page = _scanned(page, rng)
    elif way < photo_share + 0.15 or (look.kind == "photoreal" and rng.random() < 0.3):
        page = _on_a_phone(page, rng)
    if rng.random() < 0.35:
        share = rng.uniform(0.5, 0.95)
        size = page.rgb.shape[1], page.rgb.shape[0]
        small = cv2.resize(page.rgb, None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
        page = replace(page, rgb=_bytes(cv2.resize(small, size, interpolation=cv2.INTER_CUBIC)))
    return replace(page, rgb=_recorded(page.rgb, rng))


def _recorded(rgb: ByteArray, rng: np.random.Generator) -> ByteArray:
    """Blur, noise, contrast, JPEG."""
    if rng.random() < 0.2:
        rgb = np.asarray(cv2.GaussianBlur(rgb, (3, 3), rng.uniform(0.3, 1.1)), np.uint8)
    if rng.random() < 0.15:
        noise = rng.normal(0, rng.uniform(2, 10), rgb.shape).astype(np.float32)
        rgb = np.clip(rgb + noise, 0, 255).astype(np.uint8)
    if rng.random() < 0.15:
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        rgb = np.repeat(grey[..., None], 3, axis=2)
    if rng.random() < 0.12:
        low, high = rng.uniform(0, 70), rng.uniform(200, 255)
        rgb = (low + rgb * ((high - low) / 255)).astype(np.uint8)
    if rng.random() < 0.02:
        rgb = _bytes(255 - rgb)
    if rng.random() < 0.5:
        quality = int(rng.uniform(30, 92))
        _, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
        rgb = np.ascontiguousarray(cv2.imdecode(data, cv2.IMREAD_COLOR)[..., ::-1])
    return rgb


def _turned(page: Picture, quarters: int) -> Picture:
    """By quarter turns, counter-clockwise."""
    height, width = page.rgb.shape[:2]
    matrix = np.eye(3)
    for _ in range(quarters):
        matrix = np.array([[0, 1, 0], [-1, 0, width], [0, 0, 1.0]]) @ matrix
        height, width = width, height
    rgb = np.ascontiguousarray(np.rot90(page.rgb, quarters))
    labels = np.ascontiguousarray(np.rot90(page.labels, quarters))
    return Picture(rgb, labels, matrix @ page.matrix)


def _wobbled(page: Picture, rng: np.random.Generator) -> Picture:
    """Lines that no ruler drew. Vectors keep their places, to within two or three pixels."""
    height, width = page.rgb.shape[:2]
    grids = np.meshgrid(*(np.arange(side, dtype=np.float32) for side in (width, height)))
    shifts = []
    for _ in grids:
        coarse = rng.normal(0, rng.uniform(0.5, 2.0), (height // 40 + 2, width // 40 + 2))
        smooth = cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)
        shifts.append(np.asarray(smooth, np.float32))
    x, y = grids[0] + shifts[0], grids[1] + shifts[1]
    rgb = _bytes(cv2.remap(page.rgb, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE))
    labels = _bytes(cv2.remap(page.labels, x, y, cv2.INTER_NEAREST))
    grain = rng.normal(0, 8, (height, width, 1)).astype(np.float32)
    # Pencil is lighter where the paper is rough.
    pencil = np.clip(rgb + grain * (255 - rgb.min(axis=2, keepdims=True)) / 255, 0, 255)
    return Picture(pencil.astype(np.uint8), labels, page.matrix)


def _photographed(page: Picture, rng: np.random.Generator) -> Picture:
    """The sheet on a table, seen at a slant, in uneven light."""
    height, width = page.rgb.shape[:2]
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
    moved = corners + rng.uniform(-0.07, 0.07, (4, 2)) * (width, height)
    turn = np.radians(rng.normal(0, 4))
    spin = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    middle = moved.mean(axis=0)
    moved = (moved - middle) @ spin.T * rng.uniform(0.85, 1.05) + middle
    border = rng.uniform(-0.05, 0.1) * max(height, width)
    low = moved.min(axis=0) - border
    size = moved.max(axis=0) + border - low
    matrix = cv2.getPerspectiveTransform(
        corners.astype(np.float32), (moved - low).astype(np.float32)
    ).astype(np.float64)
    shade = rng.uniform(30, 210) * np.array([1.0, 0.93, 0.85]) ** rng.uniform(0, 2)
    red, green, blue = (int(v) for v in shade)
    seen = page.warped(matrix, (int(size[0]), int(size[1])), (red, green, blue))
    return replace(seen, rgb=_shaded(seen.rgb, rng, 0.45))


def _shaded(rgb: ByteArray, rng: np.random.Generator, most: float) -> ByteArray:
    """Uneven light, and its colour."""
    coarse = rng.uniform(1 - most, 1.0, (3, 3, 1)) * (1 - np.abs(rng.normal(0, 0.03, 3)))
    light = cv2.resize(coarse.astype(np.float32), rgb.shape[1::-1], interpolation=cv2.INTER_CUBIC)
    return np.clip(rgb * light, 0, 255).astype(np.uint8)


def _scanned(page: Picture, rng: np.random.Generator) -> Picture:
    """A little askew; grey, or in black and white alone."""
    height, width = page.rgb.shape[:2]
    turn = cv2.getRotationMatrix2D((width / 2, height / 2), rng.normal(0, 1.5), 1.0)
    shade = int(rng.integers(235, 256))
    paper = tuple(int(v) for v in page.rgb[2, 2])
    matrix = np.vstack([turn, [0, 0, 1]])
    seen = page.warped(matrix, (width, height), (paper[0], paper[1], paper[2]))
    grey = cv2.cvtColor(seen.rgb, cv2.COLOR_RGB2GRAY).astype(np.float32)
    if rng.random() < 0.4:
        noise = rng.normal(0, 12, grey.shape)
        grey = np.where(grey + noise > rng.uniform(130, 215), 255.0, 0.0).astype(np.float32)
    rgb = np.repeat((grey * (shade / 255))[..., None], 3, axis=2).astype(np.uint8)
    return replace(seen, rgb=_shaded(rgb, rng, 0.12))


def _on_a_phone(page: Picture, rng: np.random.Generator) -> Picture:
    """A screenshot: bars above and below, the page, words and small pictures of other plans."""
    width = int(rng.uniform(420, 620))
    page = page.scaled(width / page.rgb.shape[1], cv2.INTER_AREA)
    tall = page.rgb.shape[0]
    top = int(rng.uniform(0.04, 0.35) * width)
    below = int(rng.uniform(0.2, 1.2) * width)
    is_dark = rng.random() < 0.3
    back = int(rng.integers(0, 40)) if is_dark else int(rng.integers(240, 256))
    screen = np.full((top + tall + below, width, 3), back, np.uint8)
    labels = np.zeros(screen.shape[:2], np.uint8)
    screen[top : top + tall] = page.rgb
    labels[top : top + tall] = page.labels
    _fill_screen(screen, labels, page.rgb, (0, top), 255 - back, rng)
    _fill_screen(screen, labels, page.rgb, (top + tall, len(screen)), 255 - back, rng)
    matrix = np.array([[1, 0, 0], [0, 1, top], [0, 0, 1.0]]) @ page.matrix
    return Picture(screen, labels, matrix)


def _fill_screen(
    screen: ByteArray,
    labels: ByteArray,
    plan: ByteArray,
    rows: tuple[int, int],
    ink: int,
    rng: np.random.Generator,
) -> None:
    """Lines of words, buttons and thumbnails between two rows of a screen."""
    y, width = rows[0] + 8, screen.shape[1]
    while y < rows[1] - 14:
        kind = rng.random()
        if kind < 0.5:
            words = "".join(rng.choice(list("abcdehilmnorstu    "), int(rng.integers(8, 50))))
            place = (int(rng.uniform(8, 40)), y + 8)
            cv2.putText(screen, words, place, cv2.FONT_HERSHEY_SIMPLEX, 0.35, (ink,) * 3, 1,
                        cv2.LINE_AA)  # fmt: skip
            wide = cv2.getTextSize(words, cv2.FONT_HERSHEY_SIMPLEX, 0.35, 1)[0][0]
            labels[y : y + 11, place[0] : place[0] + wide] = WRITING << LAID_SHIFT
            y += 16
        elif kind < 0.7:
            for x in range(12, width - 12, int(width / rng.integers(4, 9))):
                red, green, blue = (int(v) for v in rng.uniform(0, 255, 3))
                cv2.circle(screen, (x, y + 6), int(rng.integers(3, 9)), (red, green, blue), -1)
            y += 22
        else:
            side = int(rng.uniform(0.18, 0.45) * width)
            thumb = cv2.resize(plan, (side, side), interpolation=cv2.INTER_AREA)
            for x in range(8, width - side, side + 8):
                part = thumb if rng.random() < 0.7 else 255 - thumb // 2
                room = min(side, rows[1] - y)
                screen[y : y + room, x : x + side] = part[:room]
            y += side + 10
