"""Pictures of every kind, upright, and pictures that lie about themselves."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from chord_usd.base.errors import PlanError, SceneError
from chord_usd.base.raster.raster_files import TEXT_CHUNK, read_layout
from chord_usd.line.plan.picture import read_picture


def chunked(path: Path, text: str) -> Path:
    chunks = PngInfo()
    chunks.add_text(TEXT_CHUNK, text)
    Image.new("RGB", (256, 256), "white").save(path, pnginfo=chunks)
    return path


def frame(**changes: object) -> str:
    return json.dumps({"frame": {"m_per_px": 0.05, "origin_m": [0, 0], "height_px": 256} | changes})


CHUNKS = [
    frame(m_per_px=1e308), frame(m_per_px=float("nan")), frame(m_per_px=-0.05), frame(m_per_px=0),
    frame(m_per_px=10**400), frame(m_per_px="0.05"), frame(m_per_px=True), frame(m_per_px=None),
    frame(origin_m=[1e308, 0]), frame(origin_m=[0]), frame(origin_m=[float("nan"), 0]),
    frame(origin_m={"x": 0}), frame(height_px=10**30), frame(height_px=-1), frame(height_px="256"),
    "[" * 100_000, "{" * 10, "[]", "3", "null", '"chord"', '{"frame": []}', "\0",
    '{"frame": {}, "provenance": 3}', '{"frame":' + "9" * 5000 + "}",
]  # fmt: skip


@pytest.mark.parametrize("text", CHUNKS, ids=lambda text: text[:40])
def test_a_forged_chunk_is_refused_and_a_plan_is_read_without_it(text: str, tmp_path: Path) -> None:
    path = chunked(tmp_path / "layout.png", text)
    with pytest.raises(SceneError, match="damaged"):
        read_layout(path)
    assert read_picture(path).frame is None


def test_a_forged_provenance_is_refused(tmp_path: Path) -> None:
    for provenance in ({"seed": "x"}, {"configuration": []}, {"other": 1}, [], 5):
        text = json.dumps({**json.loads(frame()), "provenance": provenance})
        with pytest.raises(SceneError, match="provenance"):
            read_layout(chunked(tmp_path / "layout.png", text))


def corner_picture() -> Image.Image:
    """White, 60 by 40, with a black patch in the upper left corner."""
    picture = Image.new("L", (60, 40), 255)
    picture.paste(0, (0, 0, 20, 10))
    return picture


def patch_of(rgb: np.ndarray[Any, Any]) -> tuple[int, ...]:
    """Bounds of what is dark: left, top, right, bottom."""
    rows, columns = np.nonzero(rgb.mean(axis=2) < 128)
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


STORED = {
    1: lambda upright: upright,
    2: lambda upright: upright.transpose(Image.Transpose.FLIP_LEFT_RIGHT),
    3: lambda upright: upright.transpose(Image.Transpose.ROTATE_180),
    4: lambda upright: upright.transpose(Image.Transpose.FLIP_TOP_BOTTOM),
    5: lambda upright: upright.transpose(Image.Transpose.TRANSPOSE),
    6: lambda upright: upright.transpose(Image.Transpose.ROTATE_90),
    7: lambda upright: upright.transpose(Image.Transpose.TRANSVERSE),
    8: lambda upright: upright.transpose(Image.Transpose.ROTATE_270),
}
"""How a camera that is held so stores what is upright (EXIF 2.3, tag 274)."""


@pytest.mark.parametrize("suffix", [".jpg", ".png", ".tif", ".webp"])
@pytest.mark.parametrize("orientation", STORED)
def test_turned_pictures_are_read_upright(orientation: int, suffix: str, tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[274] = orientation
    path = tmp_path / f"plan{suffix}"
    options = {"quality": 95} if suffix in (".jpg", ".webp") else {}
    STORED[orientation](corner_picture().convert("RGB")).save(path, exif=exif, **options)
    rgb = read_picture(path).rgb
    assert rgb.shape == (40, 60, 3)
    assert np.abs(np.subtract(patch_of(rgb), (0, 0, 20, 10))).max() <= 1


def sixteen_bits(picture: Image.Image) -> Image.Image:
    return Image.fromarray(np.asarray(picture).astype(np.uint16) * 257)


def palette_with_alpha(picture: Image.Image) -> Image.Image:
    layer = picture.convert("RGBA")
    layer.putalpha(picture.point(lambda value: 255 - value))  # the paper is transparent
    return layer.quantize(4)


def opaque_half(picture: Image.Image) -> Image.Image:
    layer = Image.new("LA", picture.size, (0, 0))
    layer.putalpha(picture.point(lambda value: 255 - value))
    return layer


KINDS: dict[str, tuple[str, Callable[[Image.Image], Image.Image]]] = {
    "1 bit PNG": (".png", lambda picture: picture.convert("1")),
    "1 bit TIFF": (".tif", lambda picture: picture.convert("1")),
    "16 bit PNG": (".png", sixteen_bits),
    "16 bit TIFF": (".tif", sixteen_bits),
    "32 bit float TIFF": (".tif", lambda p: Image.fromarray(np.asarray(p, np.float32) / 255)),
    "CMYK JPEG": (".jpg", lambda picture: picture.convert("CMYK")),
    "CMYK TIFF": (".tif", lambda picture: picture.convert("CMYK")),
    "palette": (".png", lambda picture: picture.convert("P")),
    "palette with alpha": (".png", palette_with_alpha),
    "grey with alpha": (".png", opaque_half),
    "YCbCr TIFF": (".tif", lambda picture: picture.convert("RGB").convert("YCbCr")),
}


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_of_every_kind_are_read_alike(kind: str, tmp_path: Path) -> None:
    suffix, convert = KINDS[kind]
    path = tmp_path / f"plan{suffix}"
    convert(corner_picture()).save(path)
    rgb = read_picture(path).rgb
    assert np.abs(np.subtract(patch_of(rgb), (0, 0, 20, 10))).max() <= 1
    assert rgb[30, 50].min() > 230
    assert rgb[5, 10].max() < 40


@pytest.mark.parametrize("suffix", [".gif", ".webp", ".png", ".tif"])
def test_of_an_animation_the_first_picture_is_read(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"plan{suffix}"
    others = [Image.new("L", (60, 40), 0)] * 3
    corner_picture().save(path, save_all=True, append_images=others)
    assert np.abs(np.subtract(patch_of(read_picture(path).rgb), (0, 0, 20, 10))).max() <= 1


def test_postscript_is_no_picture(tmp_path: Path) -> None:
    """Pillow would start Ghostscript on it."""
    path = tmp_path / "plan.eps"
    corner_picture().convert("RGB").save(path)
    with pytest.raises(PlanError, match="is not a picture"):
        read_picture(path)
