"""Pages that show no plan, but much that a plan has: lines, boxes, words, rooms. All is outside."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import cv2
import numpy as np

from chord_usd.base.scene.types import ByteArray, FloatArray, frozen_array
from chord_usd.workshop.data.drawn.page_looks import Look, random_look
from chord_usd.workshop.data.drawn.page_styles import RGB
from chord_usd.workshop.data.drawn.page_words import ink_of, room_name, title
from chord_usd.workshop.data.drawn.truth import CrowdedPage
from chord_usd.workshop.data.drawn.wear import Picture, worn
from chord_usd.workshop.data.houses import random_plan

_SIDES_PX = (420, 1000)
_HEIGHT_M = 2.6


def draw_no_plan(seed: int) -> CrowdedPage:
    """The page of a seed."""
    rng = np.random.default_rng(seed)
    look = random_look(rng)
    width, height = (int(side) for side in rng.integers(*_SIDES_PX, 2))
    page = np.full((height, width, 3), look.paper_rgb, np.uint8)
    kind = list(KINDS.values())[int(rng.integers(len(KINDS)))]
    kind(page, look, rng)
    picture = worn(Picture(page, np.zeros((height, width), np.uint8), np.eye(3)), look, rng)
    return CrowdedPage(
        frozen_array(picture.rgb, np.uint8), frozen_array(picture.labels, np.uint8),
        frozen_array(np.zeros((0, 3))), (), picture.matrix,
    )  # fmt: skip


def _write(page: ByteArray, text: str, x: float, y: float, height_px: int, rgb: RGB) -> None:
    """With its upper left corner at (x, y); clipped."""
    ink = ink_of(text, max(5, height_px), 0)
    left, top = max(0, int(x)), max(0, int(y))
    part = page[top : top + ink.shape[0], left : left + ink.shape[1]]
    part[:] = part * (1 - ink[: part.shape[0], : part.shape[1], None]) + np.array(rgb) * ink[
        : part.shape[0], : part.shape[1], None]  # fmt: skip


def _words(rng: np.random.Generator, count: int) -> str:
    return " ".join(room_name("en", "living", rng) if rng.random() < 0.2 else "".join(
        rng.choice(list("aeinorstlu"), rng.integers(2, 9))) for _ in range(count))  # fmt: skip


def _text(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """Columns of text, a headline, perhaps a table."""
    height, width = page.shape[:2]
    letters = int(rng.integers(8, 16))
    _write(page, title(rng), 0.08 * width, 0.04 * height, 2 * letters, look.ink_rgb)
    columns = int(rng.integers(1, 4))
    for column in range(columns):
        left = (0.08 + 0.86 * column / columns) * width
        for row in range(int(0.14 * height), int(0.9 * height), int(1.6 * letters)):
            words = max(1, int(0.8 * width / columns / letters / 4))
            _write(page, _words(rng, words), left, row, letters, look.ink_rgb)
    if rng.random() < 0.5:
        _table(page, look, rng)


def _table(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """Rows and columns with something written in them."""
    height, width = page.shape[:2]
    left, right = int(rng.uniform(0.05, 0.3) * width), int(rng.uniform(0.6, 0.95) * width)
    top, bottom = int(rng.uniform(0.1, 0.4) * height), int(rng.uniform(0.6, 0.95) * height)
    cv2.rectangle(page, (left, top), (right, bottom), look.paper_rgb, -1)
    xs = np.sort(rng.integers(left, right, rng.integers(2, 6))).tolist()
    ys = list(range(top, bottom, int(rng.integers(18, 60))))
    bold = int(rng.integers(1, 4))
    for x in (left, *xs, right):
        cv2.line(page, (x, top), (x, ys[-1]), look.ink_rgb, bold)
    for y in ys:
        cv2.line(page, (left, y), (right, y), look.ink_rgb, bold)
        for x in (left, *xs):
            if rng.random() < 0.8:
                _write(page, _words(rng, 1), x + 5, y + 5, 10, look.ink_rgb)


def _elevation(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """Houses from the front: gables above rows of windows, and a door."""
    height, width = page.shape[:2]
    count = int(rng.integers(1, 4))
    bold = int(rng.integers(1, 4))
    for index in range(count):
        left, right = (int(width * (index + share) / count) for share in (0.1, 0.9))
        top, bottom = int(rng.uniform(0.35, 0.5) * height), int(rng.uniform(0.75, 0.9) * height)
        wall = tuple(int(v) for v in rng.integers(150, 256, 3))
        cv2.rectangle(page, (left, top), (right, bottom), wall, -1)
        cv2.rectangle(page, (left, top), (right, bottom), look.ink_rgb, bold)
        ridge = int(rng.uniform(0.1, 0.3) * height)
        roof = np.array([[left - 12, top], [(left + right) // 2, ridge], [right + 12, top]])
        cv2.polylines(page, [roof], True, look.ink_rgb, bold)
        rows, columns = int(rng.integers(1, 4)), int(rng.integers(2, 5))
        for row in range(rows):
            for column in range(columns):
                x = left + (right - left) * (column + 0.25) / columns
                y = top + (bottom - top) * (row + 0.25) / rows
                size = (right - left) * 0.4 / columns, (bottom - top) * 0.5 / rows
                corners = (int(x), int(y)), (int(x + size[0]), int(y + size[1]))
                cv2.rectangle(page, *corners, look.glass_rgb, -1)
                cv2.rectangle(page, *corners, look.ink_rgb, 1)
    cv2.line(page, (0, bottom), (width, bottom), look.ink_rgb, bold)


def _map(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """Roads between blocks, water and names."""
    height, width = page.shape[:2]
    page[:] = rng.integers(215, 245, 3).astype(np.uint8)
    for _ in range(int(rng.integers(2, 8))):
        points = rng.integers(-50, [width + 50, height + 50], (5, 2)).astype(np.int32)
        cv2.fillPoly(page, [cv2.convexHull(points)], rng.integers(170, 230, 3).tolist())
    for _ in range(int(rng.integers(8, 30))):
        points = rng.integers(-50, [width + 50, height + 50], (3, 2)).astype(np.int32)
        bold = int(rng.integers(3, 14))
        cv2.polylines(page, [points], False, look.ink_rgb, bold + 2, cv2.LINE_AA)
        cv2.polylines(page, [points], False, (255, 255, 255), bold, cv2.LINE_AA)
    for _ in range(12):
        x, y = rng.uniform(0, width), rng.uniform(0, height)
        _write(page, _words(rng, 2), x, y, 10, look.ink_rgb)


def _photo(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """A room in perspective: a back wall, a floor, furniture, a window, light that falls off."""
    height, width = page.shape[:2]
    left, right = rng.uniform(0.1, 0.35) * width, rng.uniform(0.65, 0.9) * width
    top, bottom = rng.uniform(0.05, 0.25) * height, rng.uniform(0.55, 0.75) * height
    shades = rng.integers(60, 235, (4, 3))
    page[:] = shades[0]
    faces = (
        [[left, top], [right, top], [right, bottom], [left, bottom]],
        [[0, height], [left, bottom], [right, bottom], [width, height]],
        [[0, 0], [left, top], [left, bottom], [0, height]],
    )
    for face, shade in zip(faces, shades[1:], strict=True):
        cv2.fillPoly(page, [np.array(face, np.int32)], shade.tolist())
    for _ in range(int(rng.integers(2, 7))):
        x, y = rng.uniform(0.1, 0.8) * width, rng.uniform(0.2, 0.8) * height
        size = rng.uniform(0.08, 0.3, 2) * (width, height)
        cv2.rectangle(
            page, (int(x), int(y)), (int(x + size[0]), int(y + size[1])),
            rng.integers(30, 250, 3).tolist(), -1,
        )  # fmt: skip
    light = np.linspace(rng.uniform(0.6, 1.2), rng.uniform(0.6, 1.2), width)[None, :, None]
    page[:] = np.clip(cv2.GaussianBlur(page, (0, 0), 1.5) * light, 0, 255)


def _chart(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """Boxes with words in them, joined by lines; or tables with seats about them."""
    height, width = page.shape[:2]
    rows, columns = int(rng.integers(2, 6)), int(rng.integers(2, 6))
    is_round = rng.random() < 0.4
    if rng.random() < 0.5:
        cv2.rectangle(page, (8, 8), (width - 8, height - 8), look.ink_rgb, int(rng.integers(1, 5)))
    middles = []
    for row in range(rows):
        for column in range(columns):
            if rng.random() < 0.25:
                continue
            x, y = (column + 0.5) * width / columns, (row + 0.5) * height / rows
            reach = 0.28 * min(width / columns, height / rows)
            middles.append((int(x), int(y)))
            _draw_box(page, (x, y), reach, look, is_round=is_round)
            _write(page, _words(rng, 1), x - 0.6 * reach, y - 5, 10, look.ink_rgb)
    if not is_round:
        for first, second in itertools.pairwise(middles):
            cv2.arrowedLine(page, first, second, look.ink_rgb, 1, cv2.LINE_AA)


def _draw_box(
    page: ByteArray, middle: tuple[float, float], reach: float, look: Look, *, is_round: bool
) -> None:
    x, y = middle
    if not is_round:
        corners = (int(x - 1.3 * reach), int(y - 0.7 * reach)), (
            int(x + 1.3 * reach), int(y + 0.7 * reach))  # fmt: skip
        cv2.rectangle(page, *corners, look.tint_rgb, -1)
        cv2.rectangle(page, *corners, look.ink_rgb, 2)
        return
    cv2.circle(page, (int(x), int(y)), int(0.7 * reach), look.ink_rgb, 1, cv2.LINE_AA)
    for turn in np.arange(0, 2 * np.pi, np.pi / 4):
        seat = int(x + 0.95 * reach * np.cos(turn)), int(y + 0.95 * reach * np.sin(turn))
        cv2.circle(page, seat, max(2, int(0.15 * reach)), look.ink_rgb, 1, cv2.LINE_AA)


def _from_aside(page: ByteArray, look: Look, rng: np.random.Generator) -> None:
    """A house without its roof, seen at a slant, as brochures show it."""
    height, width = page.shape[:2]
    plan = random_plan(rng)
    turn, tilt = rng.uniform(0.2, 1.3), rng.uniform(0.35, 0.75)
    corners = np.concatenate([room.polygon_m for room in plan.rooms])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    scale = 0.8 * min(width, height) / float(np.ptp(corners, axis=0).max()) / 1.15
    cos, sin = np.cos(turn), np.sin(turn)

    def seen(points: FloatArray, z: float) -> FloatArray:
        x, y = ((points - middle) @ np.array([[cos, sin], [-sin, cos]])).T
        away = np.stack([x, -y * tilt - z * np.sqrt(1 - tilt**2)], axis=1)
        return away * scale + np.array([width, height]) / 2

    walls: list[tuple[float, FloatArray]] = []
    for room in plan.rooms:
        floor = np.rint(seen(room.polygon_m, 0.0)).astype(np.int32)
        cv2.fillPoly(page, [floor], rng.integers(150, 240, 3).tolist(), cv2.LINE_AA)
        ends = np.roll(room.polygon_m, -1, axis=0)
        for start, stop in zip(room.polygon_m, ends, strict=True):
            both = np.stack([start, stop])
            face = np.concatenate([seen(both, 0.0), seen(both[::-1], _HEIGHT_M)])
            walls.append((float(seen(both, 0.0)[:, 1].mean()), face))
    for _, face in sorted(walls, key=lambda wall: wall[0]):
        shade = int(rng.integers(170, 235))
        ring = [np.rint(face).astype(np.int32)]
        cv2.fillPoly(page, ring, (shade, shade, shade), cv2.LINE_AA)
        cv2.polylines(page, ring, True, look.ink_rgb, 1, cv2.LINE_AA)


Painter = Callable[[ByteArray, Look, np.random.Generator], None]

KINDS: dict[str, Painter] = {
    "text": _text,
    "table": _table,
    "elevation": _elevation,
    "map": _map,
    "photo": _photo,
    "chart": _chart,
    "from aside": _from_aside,
}
