"""PDF pages: drawn as a picture, with the page's own text and its size on paper.

A PDF holds lines without a word on what they mean, so walls are told by their looks, as in any
picture; text and a stated scale ("1:100") are exact.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.errors import PlanError
from chord_usd.plan.text import Text
from chord_usd.types import ByteArray, frozen_array

_SIDE_PX = 3000
_MOST_PAGES = 20
_LARGEST_BYTES = 256 * 2**20
_M_PER_POINT = 0.0254 / 72.0
_STATED = re.compile(r"\b1\s*[:：]\s*(20|25|33|40|50|75|100|125|150|200|250|300|400|500)\b")
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


def read_pages(path: Path) -> Iterator[PdfPage]:
    """The pages of a PDF, at most 20. Raises PlanError, MissingExtraError."""
    from chord_usd.plan.vector.formats import missing

    try:
        import pypdfium2 as pdfium
    except ImportError as error:
        raise missing("pypdfium2", "pdf") from error
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
    try:
        for index in range(min(count, _MOST_PAGES)):
            try:
                yield _page(document[index], index + 1, count)
            except pdfium.PdfiumError as error:
                raise PlanError(
                    f"page {index + 1} is damaged", where=str(path), expected=_EXPECTED
                ) from error
    finally:
        document.close()


def _page(page: Any, number: int, count: int) -> PdfPage:
    width_pt, height_pt = page.get_size()
    px_per_pt = _SIDE_PX / max(width_pt, height_pt)
    rgb = page.render(scale=px_per_pt, rev_byteorder=True).to_numpy()[:, :, :3]
    # Text boxes are told in the page's own frame, which a turned page does not show.
    texts = tuple(_texts(page, height_pt, px_per_pt)) if page.get_rotation() == 0 else ()
    match = next((m for text in texts if (m := _STATED.search(text.text))), None)
    stated = int(match[1]) * _M_PER_POINT / px_per_pt if match else None
    return PdfPage(number, count, frozen_array(rgb, np.uint8), texts, stated)


def _texts(page: Any, height_pt: float, px_per_pt: float) -> Iterator[Text]:
    textpage = page.get_textpage()
    for index in range(min(textpage.count_rects(), 5000)):
        left, bottom, right, top = textpage.get_rect(index)
        said = " ".join(textpage.get_text_bounded(left, bottom, right, top).split())
        if said:
            corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
            yield Text(said, (corners * (1.0, -1.0) + (0.0, height_pt)) * px_per_pt, 1.0)
