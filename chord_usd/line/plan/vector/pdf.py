"""PDF pages: drawn as a picture, with the page's own text and its size on paper.

A PDF holds lines without a word on what they mean, so walls are recognised by their looks, as in
any picture; text and a stated scale ("1:100") are exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.scene.types import ByteArray, frozen_array
from chord_usd.line.plan.paper_scale import M_PER_POINT, stated_ratio
from chord_usd.line.plan.picture import SMALLEST_SIDE_PX
from chord_usd.line.plan.text import Text

_SIDE_PX = 3000
_MOST_PAGES = 20
_LARGEST_BYTES = 256 * 2**20
_MOST_SEGMENTS = 800_000
"""Of all paths on a page: plans drawn by CAD programs have some ten thousand, hatched ones ten
times as many. Each takes up to 0.1 ms to draw."""
_EXPECTED = "a PDF page with a floor plan"


@dataclass(frozen=True, eq=False)
class PdfPage:
    """One page."""

    number: int
    """From 1."""
    count: int
    """Pages of the file."""
    rgb: ByteArray
    """(H, W, 3)."""
    texts: tuple[Text, ...]
    """What is written on it, in pixels; empty for a scan."""
    stated_m_per_px: float | None
    """By a scale printed on the page."""
    paper_m_per_px: float
    """Of the sheet of paper."""


def read_pages(path: Path) -> Iterator[PdfPage]:
    """The pages of a PDF, at most 20, each read in a process of its own when it is asked for.

    Raises PlanError, MissingExtraError.
    """
    number, count = 1, 1
    while number <= min(count, _MOST_PAGES):
        page: PdfPage = decode("PDF page", path, number, where=str(path), error=PlanError)
        yield page
        number, count = number + 1, page.count


def _read_page(path: Path, number: int) -> PdfPage:
    with needed_for("reading this format"):
        import pypdfium2 as pdfium
    if path.stat().st_size > _LARGEST_BYTES:
        raise PlanError("is too large", where=str(path), expected="at most 256 MiB")
    try:
        document = pdfium.PdfDocument(path)
        count = len(document)
    except pdfium.PdfiumError as error:
        if "password" in str(error).lower():
            raise PlanError(
                "is protected by a password", where=str(path), expected=_EXPECTED,
                try_="print it to a new PDF without one",
            ) from error  # fmt: skip
        raise PlanError("is not a PDF, or damaged", where=str(path), expected=_EXPECTED) from error
    if count == 0:
        raise PlanError("has no pages", where=str(path), expected=_EXPECTED)
    try:
        return _page(document[number - 1], number, count, path)
    except pdfium.PdfiumError as error:
        raise PlanError(
            f"page {number} is damaged", where=str(path), expected=_EXPECTED
        ) from error  # fmt: skip


def _page(page: Any, number: int, count: int, path: Path) -> PdfPage:
    width_pt, height_pt = page.get_size()
    px_per_pt = _SIDE_PX / max(width_pt, height_pt, 1e-9)
    if not min(width_pt, height_pt) * px_per_pt >= SMALLEST_SIDE_PX:
        raise PlanError(
            f"page {number} measures {width_pt:g} × {height_pt:g} points",
            where=str(path),
            expected=f"a page at most {_SIDE_PX // SMALLEST_SIDE_PX} times as long as it is wide",
        )
    _refuse_endless(page, number, path)
    rgb = page.render(scale=px_per_pt, rev_byteorder=True).to_numpy()[:, :, :3]
    # Text boxes are given in the page's own frame, which a turned page does not show.
    texts = tuple(_texts(page, height_pt, px_per_pt)) if page.get_rotation() == 0 else ()
    ratio = stated_ratio(text.text for text in texts)
    paper = M_PER_POINT / px_per_pt
    return PdfPage(
        number, count, frozen_array(rgb, np.uint8), texts, ratio and ratio * paper, paper
    )  # fmt: skip


def _refuse_endless(page: Any, number: int, path: Path) -> None:
    """Counted before anything is drawn; what forms repeat is left to the limits of the process."""
    import pypdfium2.raw as pdfium

    segments = 0
    for index in range(pdfium.FPDFPage_CountObjects(page)):
        item = pdfium.FPDFPage_GetObject(page, index)
        if pdfium.FPDFPageObj_GetType(item) == pdfium.FPDF_PAGEOBJ_PATH:
            segments += max(pdfium.FPDFPath_CountSegments(item), 0)
        if segments + index > _MOST_SEGMENTS:
            raise PlanError(
                f"page {number} has more than {_MOST_SEGMENTS:,} line segments", where=str(path),
                expected=_EXPECTED, try_="export it as PNG, which is read by its looks",
            )  # fmt: skip


def _texts(page: Any, height_pt: float, px_per_pt: float) -> Iterator[Text]:
    textpage = page.get_textpage()
    for index in range(min(textpage.count_rects(), 5000)):
        left, bottom, right, top = textpage.get_rect(index)
        said = " ".join(textpage.get_text_bounded(left, bottom, right, top).split())
        if said:
            corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
            yield Text(said, (corners * (1.0, -1.0) + (0.0, height_pt)) * px_per_pt, 1.0)
