"""An SVG drawn as a picture, for those that do not name their walls: what design tools export."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.scene.types import ByteArray, frozen_array
from chord_usd.line.plan.paper_scale import stated_ratio
from chord_usd.line.plan.picture import SMALLEST_SIDE_PX
from chord_usd.line.plan.vector.safe_xml import local_name
from chord_usd.line.plan.vector.svg import is_house, paper_m_per_unit, svg_root
from chord_usd.line.plan.vector.svg_shapes import numbers

_SIDE_PX = 2000
_NAMESPACE = "http://www.w3.org/2000/svg"
_WITHIN = re.compile(r"#|data:image/(png|jpe?g|gif|webp)[;,]", re.I)
"""What may be referred to: parts of the file, and pictures in it."""
_FONT = "DejaVu Sans"
_LAST_IN_FONT = "\u058f"
"""What the font of matplotlib's wheel can write ends here, after Armenian."""


@dataclass(frozen=True, eq=False)
class SvgPage:
    """An SVG as a picture."""

    rgb: ByteArray
    """(H, W, 3)."""
    units_per_px: float
    """Of the root."""
    paper_m_per_px: float | None
    """Of the sheet that it says it is drawn on."""
    stated_m_per_px: float | None
    """By a scale that is printed, or where the sheet is as large as a house."""


def read_page(path: Path) -> SvgPage:
    """An SVG, drawn in a process of its own. Raises PlanError."""
    page: SvgPage = decode("SVG page", path, where=str(path), error=PlanError)
    return page


def _read_page(path: Path) -> SvgPage:
    root = svg_root(path)
    size, paper = _size(root), paper_m_per_unit(root)
    if size and min(size) * _SIDE_PX < SMALLEST_SIDE_PX * max(size):
        raise PlanError(
            f"measures {size[0]:g} × {size[1]:g} units", where=str(path),
            expected=f"at most {_SIDE_PX // SMALLEST_SIDE_PX} times as long as it is wide",
        )  # fmt: skip
    # Without a size, a first picture shows how large what is drawn is.
    longer = max(size or _drawn(root, path, 1.0).shape[:2])
    rgb = _drawn(root, path, _SIDE_PX / longer)
    per_px = longer / _SIDE_PX
    if paper is None:
        return SvgPage(rgb, per_px, None, None)
    if is_house(root, paper):
        return SvgPage(rgb, per_px, None, paper * per_px)
    ratio = stated_ratio("".join(e.itertext()) for e in root.iter() if local_name(e) == "text")
    return SvgPage(rgb, per_px, paper * per_px, ratio and ratio * paper * per_px)


def _size(root: ElementTree.Element) -> tuple[float, float] | None:
    """Width and height in the root's units; None where what is drawn gives them."""
    box = numbers(root.get("viewBox", ""))
    if len(box) == 4 and min(box[2:]) > 0.0:
        return box[2], box[3]
    texts = [root.get(key, "") for key in ("width", "height")]
    sides = [values[0] for text in texts if "%" not in text and (values := numbers(text))]
    return (sides[0], sides[1]) if len(sides) == 2 and min(sides) > 0.0 else None


def _drawn(root: ElementTree.Element, path: Path, px_per_unit: float) -> ByteArray:
    """(H, W, 3) over white."""
    import matplotlib
    import resvg_py
    from PIL import Image

    text = _alone(root)
    font = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    try:
        png = resvg_py.svg_to_bytes(
            text, background="white", zoom=px_per_unit, dpi=96.0, font_files=[str(font)],
            # The machine's fonts differ from machine to machine.
            skip_system_fonts=max(text) <= _LAST_IN_FONT, font_family=_FONT,
            serif_family=_FONT, sans_serif_family=_FONT, monospace_family=_FONT,
        )  # fmt: skip
    except ValueError as error:
        raise PlanError(
            f"cannot be drawn ({error})", where=str(path), expected="an SVG of a floor plan",
            try_="export it as PNG",
        ) from error  # fmt: skip
    with Image.open(io.BytesIO(png), formats=("PNG",)) as image:
        return frozen_array(np.asarray(image.convert("RGB")), np.uint8)


def _alone(root: ElementTree.Element) -> str:
    """The SVG as text; its root loses references to any other file, and a size of its page."""
    for element in root.iter():
        outside = [
            key for key, value in element.attrib.items()
            if key.rpartition("}")[2] == "href" and not _WITHIN.match(value.strip())
        ]  # fmt: skip
        for key in outside:
            del element.attrib[key]
    if root.get("viewBox"):
        root.attrib.pop("width", None)
        root.attrib.pop("height", None)
    if not root.tag.startswith("{"):
        root.set("xmlns", _NAMESPACE)
    return ElementTree.tostring(root, encoding="unicode")
