"""Pictures of the sky all around: read, rid of their sun, and written as the stage carries them.

A sun of a few pixels, thousands of times as bright as its sky, would make every picture noisy. It
is cut out, and a DistantLight stands in for it: its patches are crisp and cost one shadow ray.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import struct
import tempfile
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.locations import cache_folder
from chord_usd.base.scene.skies import PICTURE_SUFFIXES, Sky, Sun
from chord_usd.base.scene.types import FloatArray

MOST_PX = {".exr": 16384, ".hdr": 8192}
"""Widest picture that is read: of an EXR in bands, of Radiance's format whole."""

CARRIED_PX = 4096
"""Widest picture that a stage carries."""

SUN_FROM = 6.0
"""What is brighter than this many times the mean of the upper half is sun."""

_SUN_SHARE = 0.25
"""A sun whose irradiance is less than this share of the sky's is none worth a light."""

_VERSION = 2
"""Of what is done to pictures; part of the names in the cache."""

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)

_MOST_BYTES = 512 * 2**20
_EXR, _EXR_OF_PARTS = b"\x76\x2f\x31\x01", 0x18
"""How a file begins, and the bits of its sixth byte that stand for deep pixels and for parts."""

_BAND_ROWS = 64
"""Of the reduced picture, in one band."""

_BRIGHTEST = 65504.0
"""The largest half."""


@dataclass(frozen=True)
class SkyPicture:
    """A sky, and the bytes of its picture."""

    sky: Sky
    """With its sun, where that was found in the picture."""
    exr: bytes


def wheel_picture(stem: str) -> Path | None:
    """An HDRI of Blender's wheel (CC0, see license.txt beside it), found without importing it."""
    spec = find_spec("bpy")
    if spec is None or not spec.submodule_search_locations:
        return None
    folder = Path(spec.submodule_search_locations[0])
    pictures = sorted(folder.glob(f"*/datafiles/studiolights/world/{stem}.exr"))
    return pictures[-1] if pictures else None


def require_picture(sky: Sky) -> None:
    """Raises ChordError where the sky of a user's file holds no HDRI; looks at its head only."""
    if sky.file is not None:
        refuse_odd_file(sky.file, most_bytes=_MOST_BYTES)
        _check_size(sky.file, _size_px(sky.file))


def developed(sky: Sky) -> SkyPicture | None:
    """A sky as a stage carries it; None where its picture is not on this machine.

    The picture's upper half has a mean luminance of one, its sun is cut out, it is at most
    CARRIED_PX wide, and tinted. Raises ChordError for a user's file that is no HDRI.
    """
    file = sky.file or wheel_picture(sky.picture)
    if file is None:
        return None
    if sky.file is not None:
        require_picture(sky)
        return _decoded(sky, file)
    stat = file.stat()
    key = hashlib.sha256(repr((_VERSION, sky, stat.st_size)).encode()).hexdigest()[:16]
    return _kept(sky, file, key)


@lru_cache(maxsize=8)
def _kept(sky: Sky, file: Path, key: str) -> SkyPicture:
    """From the cache, where an earlier run left it."""
    kept = cache_folder() / "skies" / f"{sky.name}-{key}.exr"
    try:
        return SkyPicture(sky, kept.read_bytes())
    except OSError:
        picture = _decoded(sky, file)
    # A cache that cannot be written costs a fifth of a second a house.
    with contextlib.suppress(OSError):
        kept.parent.mkdir(parents=True, exist_ok=True)
        half = kept.with_name(f"{kept.name}.{os.getpid()}")
        half.write_bytes(picture.exr)
        half.replace(kept)
    return picture


def _decoded(sky: Sky, file: Path) -> SkyPicture:
    picture: SkyPicture = decode("sky", sky, file, where=str(file))
    return picture


def _developed(sky: Sky, file: Path) -> SkyPicture:
    light = read_hdri(file)
    luminance = light @ _LUMINANCE
    solid_angle = _solid_angles(*luminance.shape)
    limit = SUN_FROM * _upper_mean(luminance, solid_angle)
    kept = np.asarray(np.minimum(luminance, limit) / np.maximum(luminance, 1e-9), np.float32)
    sunless = light * kept[..., None]
    white = np.float32(_upper_mean(sunless @ _LUMINANCE, solid_angle))
    if sky.file is not None:
        light -= sunless
        light /= white
        sky = _with_sun(sky, light, solid_angle)
    sunless *= np.array(sky.tint, np.float32) / white
    return SkyPicture(sky, _encoded(sunless))


def _with_sun(sky: Sky, cut_out: npt.NDArray[np.float32], solid_angle: FloatArray) -> Sky:
    """The sky of a user's picture with the sun that was found there, if there is one."""
    luminance = cut_out @ _LUMINANCE
    height, width = luminance.shape
    row, column = np.unravel_index(int(np.argmax(luminance)), luminance.shape)
    at_deg = float((column + 0.5) / width * 360.0)
    share = float((luminance * solid_angle).sum()) / math.pi
    sun = None
    height_deg = float(90.0 - (row + 0.5) / height * 180.0)
    if share > _SUN_SHARE and height_deg > 1.0:
        red, _, blue = (cut_out * solid_angle[..., None]).sum(axis=(0, 1))
        # A warm sun is about this much redder than it is blue.
        kelvin = float(np.clip(6500.0 * (max(blue, 1e-9) / max(red, 1e-9)) ** 0.6, 2500.0, 8000.0))
        sun = Sun(height_deg, share * math.pi * sky.radiance, round(kelvin, -1))
    return replace(sky, sun=sun, sun_at_deg=at_deg)


def _upper_mean(luminance: npt.NDArray[np.float32], solid_angle: FloatArray) -> float:
    half = len(luminance) // 2
    mean = float(np.average(luminance[:half], weights=solid_angle[:half]))
    return max(mean, 1e-9)


def _solid_angles(height: int, width: int) -> FloatArray:
    """(H, W) steradians of each pixel."""
    edges = np.sin(np.linspace(np.pi / 2, -np.pi / 2, height + 1))
    rows = (edges[:-1] - edges[1:]) * (2 * np.pi / width)
    return np.repeat(rows[:, None], width, axis=1)


# --- files --------------------------------------------------------------------------------------


def read_hdri(file: Path) -> npt.NDArray[np.float32]:
    """(H, W, 3) linear light, longitude across, latitude down, at most CARRIED_PX wide.

    Raises ChordError for what is no picture of everything around.
    """
    import cv2

    _check_size(file, _size_px(file))
    light = _read_exr(file) if file.suffix.lower() == ".exr" else _read_hdr(file)
    if light is None:
        raise _no_picture(file, "is damaged, or no picture in colour")
    if not light.any():
        raise _no_picture(file, "is black all over")
    height, width = light.shape[:2]
    if width > CARRIED_PX:
        size = (CARRIED_PX, round(height * CARRIED_PX / width))
        light = np.asarray(cv2.resize(light, size, interpolation=cv2.INTER_AREA))
    return light


def _size_px(file: Path) -> tuple[int, int] | None:
    """Width and height, by the head of the file alone; None for what is no such file."""
    with file.open("rb") as opened:
        head = opened.read(2**16)
    return _exr_size_px(head) if file.suffix.lower() == ".exr" else _hdr_size_px(head)


def _hdr_size_px(head: bytes) -> tuple[int, int] | None:
    if not head.startswith((b"#?RADIANCE", b"#?RGBE")):
        return None
    for line in head[:4096].split(b"\n"):
        words = line.split()
        if len(words) == 4 and words[0] in (b"-Y", b"+Y") and words[1].isdigit():
            return (int(words[3]), int(words[1])) if words[3].isdigit() else None
    return None


def _exr_size_px(head: bytes) -> tuple[int, int] | None:
    """By the attributes at the beginning, each a name, a type, a size and so many bytes."""
    if not head.startswith(_EXR) or len(head) < 8 or head[5] & _EXR_OF_PARTS:
        return None
    at = 8
    while at < len(head) and head[at]:
        names = head[at : at + 512].split(b"\0", 2)
        if len(names) < 3:
            return None
        at += len(names[0]) + len(names[1]) + 2
        size = int.from_bytes(head[at : at + 4], "little")
        if names[0] == b"dataWindow" and size == 16 and len(head) >= at + 20:
            left, top, right, bottom = struct.unpack_from("<4i", head, at + 4)
            return right - left + 1, bottom - top + 1
        at += 4 + size
    return None


def _check_size(file: Path, size_px: tuple[int, int] | None) -> None:
    if size_px is None:
        raise _no_picture(file, "is no HDRI")
    width, height = size_px
    if abs(width - 2 * height) > 2 or not 8 <= width <= MOST_PX[file.suffix.lower()]:
        raise _no_picture(file, f"of {width}x{height} pixels is no picture of everything around")


def _no_picture(file: Path, what: str) -> ChordError:
    return ChordError(
        what,
        where=str(file),
        expected="an HDRI, twice as wide as high, at most "
        + " or ".join(f"{MOST_PX[suffix]} pixels wide as {suffix}" for suffix in PICTURE_SUFFIXES),
    )


def _read_exr(file: Path) -> npt.NDArray[np.float32] | None:
    """The picture, in bands of rows, each reduced before the next is decoded."""
    import Imath
    import OpenEXR

    try:
        exr = OpenEXR.InputFile(str(file))
        window, depth = exr.header()["dataWindow"], Imath.PixelType(Imath.PixelType.FLOAT)
        width, low, high = window.max.x - window.min.x + 1, window.min.y, window.max.y
        share = max(width // CARRIED_PX, 1)
        light = np.empty(((high + 1 - low) // share, width // share, 3), np.float32)
        for row in range(0, len(light), _BAND_ROWS):
            band = light[row : row + _BAND_ROWS]
            top, count = low + row * share, len(band) * share
            read = exr.channels("RGB", depth, top, top + count - 1)
            for at, plane in enumerate(read):
                pixels = _sound(np.frombuffer(plane, np.float32).reshape(count, width))
                band[..., at] = _reduced(pixels, share)
        return light
    except MemoryError:
        raise
    except Exception:  # the library raises plain RuntimeErrors, ValueErrors, TypeErrors
        return None


def _reduced(plane: npt.NDArray[np.float32], share: int) -> npt.NDArray[np.float32]:
    """The means of squares of share x share pixels."""
    height, width = (size // share for size in plane.shape)
    squares = plane[:, : width * share].reshape(height, share, width, share)
    return np.asarray(squares.mean(axis=(1, 3)), np.float32)


def _sound(light: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    return np.asarray(np.clip(np.nan_to_num(light), 0.0, _BRIGHTEST), np.float32)


def _read_hdr(file: Path) -> npt.NDArray[np.float32] | None:
    import cv2

    try:
        bgr = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        return None
    if bgr is None or bgr.ndim != 3 or bgr.shape[2] < 3:
        return None
    return _sound(np.asarray(bgr[..., 2::-1], np.float32))


def _encoded(light: npt.NDArray[np.float32]) -> bytes:
    import OpenEXR

    pixels = np.ascontiguousarray(np.clip(light, 0.0, _BRIGHTEST), dtype=np.float16)
    header = {"compression": OpenEXR.DWAB_COMPRESSION, "type": OpenEXR.scanlineimage}
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "sky.exr")  # noqa: PTH118 (the library takes text)
        with OpenEXR.File(header, {"RGB": pixels}) as written:
            written.write(file)
        return Path(file).read_bytes()
