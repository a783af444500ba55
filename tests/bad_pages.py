"""Pages that are no plan, or a difficult one, drawn as people upload them."""

from __future__ import annotations

import cv2
import numpy as np
from plan_symbols import draw_symbols

from chord_usd.base.scene.types import Plan

INK = (40, 40, 40)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


def blank(width: int = 900, height: int = 640) -> np.ndarray:
    return np.full((height, width, 3), 255, np.uint8)


def write(page: np.ndarray, text: str, x: float, y: float, size: float = 0.45) -> None:
    cv2.putText(page, text, (int(x), int(y)), _FONT, size, INK, 1, cv2.LINE_AA)


def text_page() -> np.ndarray:
    page = blank()
    write(page, "Lease of a flat", 60, 60, 0.9)
    words = ["the", "tenant", "keeps", "kitchen", "bedroom", "and", "bathroom", "in", "repair"]
    for row in range(12):
        line = " ".join(words[(row * 3 + n) % len(words)] for n in range(13))
        write(page, line, 60, 100 + 45 * row)
    return page


def town_map() -> np.ndarray:
    page = np.full((640, 900, 3), (232, 240, 228), np.uint8)
    rng = np.random.default_rng(1)
    for _ in range(14):
        points = np.cumsum(rng.normal(0, 60, (9, 2)), axis=0) + rng.uniform((0, 0), (900, 640))
        cv2.polylines(page, [points.astype(np.int32)], False, (255, 255, 255), 14, cv2.LINE_AA)
        cv2.polylines(page, [points.astype(np.int32)], False, (170, 170, 170), 1, cv2.LINE_AA)
    for _ in range(60):
        x, y = rng.integers((20, 20), (870, 610))
        cv2.rectangle(page, (x, y), (x + 22, y + 15), (190, 180, 200), -1)
    for n, name in enumerate(("Mill Lane", "Station", "Church St", "River")):
        write(page, name, 120 + 170 * n, 100 + 120 * n)
    return page


def circuit() -> np.ndarray:
    page = blank()
    for row in range(4):
        y = 110 + 130 * row
        cv2.line(page, (80, y), (820, y), INK, 2)
        for n in range(4):
            x = 130 + 180 * n
            if (row + n) % 2:
                cv2.rectangle(page, (x, y - 14), (x + 60, y + 14), (255, 255, 255), -1)
                cv2.rectangle(page, (x, y - 14), (x + 60, y + 14), INK, 2)
                write(page, f"R{row * 4 + n} {n + 1}k", x, y - 22)
            else:
                cv2.rectangle(page, (x + 25, y - 2), (x + 35, y + 2), (255, 255, 255), -1)
                for at in (x + 24, x + 36):
                    cv2.line(page, (at, y - 18), (at, y + 18), INK, 2)
    for x in (80, 300, 660, 820):
        cv2.line(page, (x, 110), (x, 500), INK, 2)
        cv2.circle(page, (x, 240), 5, INK, -1)
    return page


def elevation() -> np.ndarray:
    page = blank()
    cv2.rectangle(page, (150, 260), (750, 560), INK, 2)
    cv2.polylines(page, [np.array([(110, 260), (450, 90), (790, 260)])], True, INK, 2)
    for y in (300, 430):
        for x in (200, 340, 500, 640):
            cv2.rectangle(page, (x, y), (x + 60, y + 80), INK, 1)
            cv2.line(page, (x + 30, y), (x + 30, y + 80), INK, 1)
    cv2.rectangle(page, (420, 450), (480, 560), INK, 2)
    cv2.line(page, (20, 560), (880, 560), INK, 3)
    write(page, "South elevation 1:100", 340, 610, 0.6)
    return page


def section() -> np.ndarray:
    page = blank()
    for y in (150, 290, 430, 570):
        cv2.rectangle(page, (130, y), (770, y + 16), INK, -1)
    for x in (130, 754):
        cv2.rectangle(page, (x, 150), (x + 16, 586), INK, -1)
    cv2.polylines(page, [np.array([(90, 150), (450, 30), (810, 150)])], False, INK, 8)
    for n in range(9):
        cv2.line(page, (300 + 14 * n, 430 - 14 * n), (314 + 14 * n, 430 - 14 * n), INK, 2)
        cv2.line(page, (314 + 14 * n, 430 - 14 * n), (314 + 14 * n, 416 - 14 * n), INK, 2)
    write(page, "Section A-A  1:100", 350, 625, 0.6)
    return page


def garden() -> np.ndarray:
    page = np.full((640, 900, 3), (225, 240, 225), np.uint8)
    rng = np.random.default_rng(2)
    cv2.ellipse(page, (300, 320), (190, 120), 20, 0, 360, (170, 210, 160), -1)
    cv2.ellipse(page, (640, 380), (120, 70), 0, 0, 360, (230, 210, 170), -1)
    for _ in range(60):
        x, y = (int(at) for at in rng.uniform((30, 30), (870, 610)))
        cv2.circle(page, (x, y), int(rng.integers(8, 26)), (90, 150, 90), 1, cv2.LINE_AA)
    for name, x, y in (("Lawn", 270, 320), ("Pond", 620, 380), ("Herbs", 120, 90)):
        write(page, name, x, y, 0.6)
    return page


def seating() -> np.ndarray:
    page = blank()
    cv2.ellipse(page, (450, 60), (260, 34), 0, 0, 180, INK, 2)
    write(page, "STAGE", 420, 60, 0.6)
    for row in range(5):
        for n in range(12):
            x, y = 110 + 56 * n, 140 + 86 * row
            cv2.rectangle(page, (x, y), (x + 22, y + 22), INK, 1)
            write(page, str(n + 1), x + 4, y + 15, 0.3)
        write(page, "ABCDE"[row], 80, 156 + 86 * row)
    return page


def room_in_3d() -> np.ndarray:
    page = blank()
    corners = {"floor": [(250, 420), (650, 420), (860, 620), (40, 620)],
               "back": [(250, 120), (650, 120), (650, 420), (250, 420)],
               "left": [(40, 10), (250, 120), (250, 420), (40, 620)],
               "right": [(860, 10), (650, 120), (650, 420), (860, 620)]}  # fmt: skip
    for name, shade in (("floor", 190), ("back", 235), ("left", 220), ("right", 210)):
        ring = np.array(corners[name], np.int32)
        cv2.fillPoly(page, [ring], (shade, shade, shade))
        cv2.polylines(page, [ring], True, INK, 1, cv2.LINE_AA)
    cv2.rectangle(page, (400, 200), (520, 330), (250, 250, 250), -1)
    cv2.fillPoly(
        page, [np.array([(330, 470), (560, 470), (590, 560), (300, 560)])], (150, 120, 110)
    )
    return page


def graph_paper() -> np.ndarray:
    page = np.full((640, 900, 3), (252, 252, 255), np.uint8)
    for at in range(0, 900, 18):
        cv2.line(page, (at, 0), (at, 639), (215, 190, 170), 1 + (at % 90 == 0))
        cv2.line(page, (0, at), (899, at), (215, 190, 170), 1 + (at % 90 == 0))
    return page


NO_PLANS = {
    "a page of text": text_page, "a map": town_map, "an elevation": elevation,
    "a circuit diagram": circuit, "a garden": garden, "a seating chart": seating,
    "a room in 3-D": room_in_3d, "a section": section, "graph paper": graph_paper,
}  # fmt: skip


def cut_in_half(plan: Plan) -> np.ndarray:
    page = draw_symbols(plan)
    columns = np.flatnonzero((page < 128).all(axis=2).any(axis=0))
    return page[:, : (columns.min() + columns.max()) // 2]


def on_graph_paper(plan: Plan) -> np.ndarray:
    page = draw_symbols(plan)
    squares = cv2.resize(graph_paper(), (page.shape[1], page.shape[0]))
    return np.minimum(page, squares)


def at_30_degrees(plan: Plan) -> np.ndarray:
    """A photograph of a sheet on a dark table, seen from 30 degrees off the vertical."""
    page = draw_symbols(plan)
    side = page.shape[0]
    flat = np.array([(0, 0), (side, 0), (side, side), (0, side)], np.float32)
    reach, near, far = side * 0.25, 1.12, 0.88
    middle = side / 2 + reach
    seen = np.array([(middle - side / 2 * far, reach + 0.067 * side),
                     (middle + side / 2 * far, reach + 0.067 * side),
                     (middle + side / 2 * near, reach + 0.933 * side),
                     (middle - side / 2 * near, reach + 0.933 * side)], np.float32)  # fmt: skip
    matrix = cv2.getPerspectiveTransform(flat, seen)
    whole = int(side + 2 * reach)
    return cv2.warpPerspective(page, matrix, (whole, whole), borderValue=(60, 45, 40))
