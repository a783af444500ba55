"""Pictures drawn by code: hills, ink, leaves, seas, still lifes. Seeded by the picture's name."""

from __future__ import annotations

import math

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.pictures.art import (
    EARTH,
    INK,
    PALE,
    Palette,
    Rgb,
    Rng,
    SizePx,
    canvas,
    grid,
    masked,
    noise,
    textured,
)


def _ridge(rng: Rng, width: int, rough: float) -> FloatArray:
    """(width,) heights of a skyline, about -1 to 1."""
    x = np.linspace(0.0, 1.0, width)
    total = np.zeros(width)
    for octave in range(7):
        knots = rng.uniform(-1, 1, 3 + 2 * 2**octave)
        total += np.interp(x, np.linspace(0, 1, len(knots)), knots) * rough**octave
    return total / 1.8


def mountains(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """Ranges that fade into the distance under a pale sun."""
    width, height = size
    x, y = grid(size)
    sky = (
        np.array(palette[3], float)
        + (np.array(palette[0], float) - palette[3]) * y[..., None] * 1.6
    )
    image = Image.fromarray(np.clip(sky, 0, 255).astype(np.uint8))
    at = (float(rng.uniform(0.3, 0.7)), 0.26)
    disc = np.hypot(x - at[0], (y - at[1]) * height / width)
    image = masked(image, (250, 236, 214), np.clip((0.09 - disc) / 0.004, 0, 1) * 0.9)
    far, near = np.array(palette[2], float), np.array(palette[-1], float)
    layers = 5
    for index in range(layers):
        share = index / (layers - 1)
        line = 0.42 + 0.13 * index + (0.1 - 0.05 * share) * _ridge(rng, width, 0.52)
        mask = np.clip((y - line[None, :]) * height, 0, 1)
        mist = np.clip((y - line[None, :]) * 3.0, 0, 0.45) * (1 - share)
        colour = (far + (near - far) * share)[None, None, :] + mist[..., None] * 90
        image = masked(image, colour, mask)
    return textured(image, rng, 5.0, 2.0)


def ink_hills(rng: Rng, size: SizePx) -> Image.Image:
    """Wet ink: hills in mist, a few pines, a red seal."""
    width, height = size
    _, y = grid(size)
    image, _ = canvas(size, (238, 231, 214))
    for index in range(4):
        share = index / 3
        line = 0.3 + 0.15 * index + (0.16 - 0.06 * share) * _ridge(rng, width, 0.48)
        below = y - line[None, :]
        wash = np.clip(below * height / 2, 0, 1) * np.exp(
            -np.clip(below, 0, 1) * (9.0 - 3.5 * share)
        )
        wash *= (0.3 + 0.5 * share) * (1.0 + 0.22 * noise(rng, size, 7, 4))
        image = masked(image, INK, wash)
    image = image.filter(ImageFilter.GaussianBlur(0.8))
    pen = ImageDraw.Draw(image)
    for _tree in range(7):
        x, foot = float(rng.uniform(0.05, 0.6)) * width, float(rng.uniform(0.74, 0.86)) * height
        tall = height * float(rng.uniform(0.05, 0.1))
        lean = float(rng.uniform(-0.2, 0.2)) * tall
        pen.line([(x, foot), (x + lean, foot - tall)], fill=(48, 46, 46), width=2)
        for tier in range(5):
            z, wide = foot - tall * (0.35 + 0.16 * tier), tall * (0.34 - 0.05 * tier)
            at = x + lean * (0.35 + 0.16 * tier)
            pen.line([(at - wide, z + 3), (at + wide * 0.8, z)], fill=(52, 52, 52), width=3)
    seal = max(8, width // 22)
    left, top = int(width * 0.86), int(height * 0.84)
    pen.rectangle((left, top, left + seal, top + seal), fill=(170, 50, 38))
    pen.line(
        [(left + seal * 0.3, top + 2), (left + seal * 0.3, top + seal - 2)],
        fill=(238, 226, 208),
        width=1,
    )
    pen.line(
        [(left + seal * 0.55, top + seal * 0.4), (left + seal - 2, top + seal * 0.4)],
        fill=(238, 226, 208),
        width=1,
    )
    return textured(image, rng, 5.0, 0.0)


def enso(rng: Rng, size: SizePx) -> Image.Image:
    """One circle with a dry brush."""
    width, height = size
    image, _ = canvas(size, (240, 234, 220))
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    side = min(width, height)
    dx, dy = (x - width / 2) / side, (y - height / 2) / side
    turned = np.arctan2(dy * rng.choice((-1.0, 1.0)), dx) - rng.uniform(0.0, 2 * math.pi)
    angle = turned % (2 * math.pi) / (2 * math.pi)
    radius = np.hypot(dx, dy) + 0.012 * np.sin(2 * math.pi * angle + 1.0)
    half = 0.05 - 0.024 * angle
    across = (radius - 0.31 - 0.02 * angle) / half
    hairs = rng.standard_normal(60)
    trace = np.interp(across, np.linspace(-1, 1, 60), hairs) * 0.5
    dry = np.clip(1.25 - angle * 1.25 + trace, 0.0, 1.0)
    mask = np.clip((1.0 - np.abs(across)) * 6, 0, 1) * dry * (angle < 0.95)
    return textured(masked(image, (30, 29, 30), mask), rng, 4.0, 0.0)


def _leaf(
    pen: ImageDraw.ImageDraw,
    at: FloatArray,
    angle: float,
    long: float,
    wide: float,
    fill: Rgb,
    vein: Rgb,
) -> None:
    """A pointed leaf from its stalk at `at`, towards angle."""
    share = np.linspace(0, 1, 24)
    half = wide / 2 * np.sin(math.pi * share**0.8)
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    spine = at + share[:, None] * long * along
    outline = np.concatenate(
        [spine + half[:, None] * across, (spine - half[:, None] * across)[::-1]]
    )
    pen.polygon([tuple(p) for p in outline.tolist()], fill=fill)
    pen.line([tuple(spine[0].tolist()), tuple(spine[-1].tolist())], fill=vein, width=2)


def botanical(rng: Rng, size: SizePx, tone: Rgb = (74, 100, 72)) -> Image.Image:
    """A stem with leaves in pairs, pressed on paper."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    image, pen = canvas((width, height), (243, 239, 229))
    side = min(width, height)
    foot = np.array([width * 0.5 - 0.04 * side, height * 0.92])
    bend = float(rng.uniform(-0.25, 0.25))
    count = 9
    top = height * 0.78
    stem = [foot + np.array([bend * side * (t**2), -top * t]) for t in np.linspace(0, 1, 30)]
    pen.line(
        [tuple(p.tolist()) for p in stem],
        fill=tuple(int(c * 0.7) for c in tone),
        width=max(4, side // 160),
    )
    for index in range(count):
        share = 0.16 + 0.84 * index / (count - 1)
        at = stem[min(int(share * 29), 29)]
        long = side * (0.3 - 0.17 * share) * float(rng.uniform(0.9, 1.1))
        for sign in (-1.0, 1.0):
            angle = -math.pi / 2 + sign * (1.05 - 0.45 * share + float(rng.uniform(-0.1, 0.1)))
            shift = float(rng.uniform(0.85, 1.15))
            fill = tuple(int(min(c * shift, 255)) for c in tone)
            _leaf(pen, at, angle, long, long * 0.42, fill, tuple(int(c * 0.75) for c in tone))  # type: ignore[arg-type]
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 5.0, 0.0)


def fronds(rng: Rng, size: SizePx, tone: Rgb = (62, 88, 66)) -> Image.Image:
    """Two to five fern fronds of unlike green."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    image, pen = canvas((width, height), (240, 236, 226))
    side = min(width, height)
    count = int(rng.integers(2, 6))
    for share in np.linspace(0.0, 1.0, count):
        foot = np.array([width * (0.36 + 0.28 * share), height * 0.94])
        lean = 0.68 * share - 0.34 + rng.uniform(-0.1, 0.1)
        pale = rng.uniform(0.8, 1.35)
        colour = tuple(int(min(c * pale, 255)) for c in tone)
        tall = height * rng.uniform(0.6, 0.86)
        for t in np.linspace(0.14, 1.0, 26):
            at = foot + np.array([lean * side * t**1.6, -tall * t])
            angle = math.atan2(-tall, lean * side * 1.6 * t**0.6)
            long = side * 0.17 * math.sin(math.pi * min(t + 0.08, 1.0)) ** 0.7 + side * 0.012
            for sign in (-1.0, 1.0):
                _leaf(pen, at, angle + sign * 1.05, long, long * 0.22, colour, colour)  # type: ignore[arg-type]
        path = [foot + np.array([lean * side * t**1.6, -tall * t]) for t in np.linspace(0, 1, 30)]
        pen.line([tuple(p.tolist()) for p in path], fill=colour, width=5)  # type: ignore[arg-type]
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 5.0, 0.0)


def bamboo(rng: Rng, size: SizePx) -> Image.Image:
    """Bamboo in ink: jointed stems and brushed leaves."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    image, pen = canvas((width, height), (238, 232, 216))
    side = min(width, height)
    for stem in range(3):
        x = width * (0.28 + 0.2 * stem) + float(rng.uniform(-0.03, 0.03)) * width
        grey = (150, 84, 120)[stem]
        thick = side * (0.016, 0.03, 0.02)[stem]
        y, lean = height * 1.02, float(rng.uniform(-0.06, 0.1))
        while y > height * 0.06:
            step = height * float(rng.uniform(0.12, 0.18))
            nx = x + lean * step
            pen.line([(x, y - 5), (nx, y - step + 5)], fill=(grey, grey, grey), width=int(thick))
            pen.line(
                [(nx - thick * 0.7, y - step), (nx + thick * 0.7, y - step)], fill=INK, width=4
            )
            if rng.random() < 0.75:
                for _ in range(4):
                    angle = (
                        float(rng.uniform(0.1, 1.3))
                        if rng.random() < 0.6
                        else float(rng.uniform(1.9, 3.0))
                    )
                    long = side * float(rng.uniform(0.13, 0.22))
                    tone = int(rng.integers(30, 110))
                    _leaf(
                        pen,
                        np.array([nx, y - step]),
                        angle,
                        long,
                        long * 0.17,
                        (tone, tone, tone),
                        (tone, tone, tone),
                    )
            x, y = nx, y - step
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 5.0, 0.0)


def sea(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """A wide sky over water, painted thickly."""
    x, y = grid(size)
    low = np.array((232, 214, 192), float)
    high = np.array((142, 166, 182), float)
    horizon = 0.6
    sky = high + (low - high) * np.clip(y / horizon, 0, 1)[..., None] ** 1.4
    cloud = np.clip(noise(rng, size, 3, 5) * 0.9 - 0.1, 0, 1) * np.clip((horizon - y) * 4, 0, 1)
    sky += (np.array((246, 240, 230)) - sky) * cloud[..., None]
    water = (
        np.array((86, 118, 130), float)
        + (np.array((44, 72, 86)) - (86, 118, 130))
        * (np.clip((y - horizon) / (1 - horizon), 0, 1)[..., None])
    )
    flat = Image.fromarray(noise(rng, (size[0] // 6 + 2, size[1]), 20, 3).astype(np.float32))
    waves = np.asarray(flat.resize(size, Image.Resampling.BICUBIC), dtype=np.float64)
    water += 26.0 * np.clip(waves, -0.4, 1)[..., None]
    glitter = np.exp(-((x - 0.6) ** 2) / 0.012) * np.clip(waves, 0, 1) * (y > horizon)
    both = np.where((y > horizon)[..., None], water, sky) + 80.0 * glitter[..., None]
    return textured(Image.fromarray(np.clip(both, 0, 255).astype(np.uint8)), rng, 7.0, 5.0)


def old_landscape(rng: Rng, size: SizePx) -> Image.Image:
    """Trees at a river under an evening sky, in the browns of old varnish."""
    width, height = size
    x, y = grid(size)
    x = np.abs(x - rng.integers(2))  # the tall trees stand left or right
    sky = np.array((206, 186, 146), float) + (np.array((122, 134, 134)) - (206, 186, 146)) * (
        np.clip(1 - y / 0.5, 0, 1)[..., None] ** 1.5
    )
    cloud = np.clip(noise(rng, size, 3, 5), 0, 1) * (y < 0.55)
    sky = sky + 30.0 * cloud[..., None]
    image = Image.fromarray(np.clip(sky, 0, 255).astype(np.uint8))
    for index, tone in enumerate(((136, 132, 104), (100, 98, 66), (74, 72, 44))):
        line = 0.5 + 0.09 * index + 0.035 * _ridge(rng, width, 0.5)
        shade = np.array(tone, float) + 16.0 * noise(rng, size, 14, 4)[..., None]
        image = masked(image, shade, np.clip((y - line[None, :]) * height / 2, 0, 1))
    bank = 0.5 + 0.16 * np.sin(4.2 * (y - 0.62)) - 0.1
    river = np.clip((0.03 + 0.5 * np.clip(y - 0.62, 0, 1) - np.abs(x - bank)) / 0.012, 0, 1) * (
        y > 0.62
    )
    image = masked(
        image, np.array((176, 166, 138), float) + 14 * noise(rng, size, 20, 2)[..., None], river
    )
    for middle, foot, most in ((0.16, 0.86, 0.66), (0.3, 0.78, 0.4), (0.86, 0.82, 0.56)):
        at, tall = middle + rng.uniform(-0.06, 0.06), most * rng.uniform(0.6, 1.0)
        crown = np.hypot((x - at) / (0.36 * tall), (y - foot + 0.64 * tall) / (0.42 * tall))
        crown = crown + 0.22 * noise(rng, size, 9, 4)
        trunk = (
            (np.abs(x - at - 0.02 * np.sin(9 * y)) < 0.012) & (y < foot) & (y > foot - 0.6 * tall)
        )
        image = masked(image, (48, 36, 24), trunk.astype(float))
        light = np.clip(0.5 + (at - x) * 2.4 + (foot - 0.7 * tall - y) * 2, 0, 1)[..., None]
        leaves = (
            np.array((46, 50, 28), float) + 46.0 * light + 22.0 * noise(rng, size, 26, 3)[..., None]
        )
        image = masked(image, leaves, np.clip((0.95 - crown) * 7, 0, 1))
    edge = np.clip(np.hypot(x - 0.5, y - 0.5) * 1.5 - 0.45, 0, 0.5)
    image = masked(image, (40, 28, 16), edge)
    return textured(image.filter(ImageFilter.ModeFilter(5)), rng, 6.0, 5.0)


def still_life(rng: Rng, size: SizePx, palette: Palette = EARTH) -> Image.Image:
    """A bottle, a jug, a bowl and fruit on a table's edge, in flat quiet colours."""
    width, height = size
    image, _ = canvas(size, palette[0])
    x, y = grid(size)
    side = min(width, height)
    ground = np.array(palette[3], float) + 8.0 * noise(rng, size, 4, 4)[..., None]
    image = masked(image, ground, np.clip((y - 0.66) * height / 2, 0, 1))
    things = (
        (0.46, 0.085, (0, 0.95, 0.5, 1.0, 0.72, 1.0, 0.8, 0.36, 1.0, 0.34)),
        (0.34, 0.12, (0, 0.6, 0.3, 1.0, 0.7, 0.9, 0.85, 0.55, 1.0, 0.7)),
        (0.15, 0.15, (0, 0.45, 0.2, 0.7, 0.6, 0.95, 0.9, 1.0, 1.0, 1.0)),
    )
    places = rng.permutation((0.3, 0.5, 0.72))
    colours = rng.permutation([palette[1], palette[2], palette[4]])
    for at, colour, (tall, wide, profile) in zip(places, colours, things, strict=True):
        knots = np.array(profile).reshape(-1, 2)
        foot = 0.76 + 0.03 * float(rng.random())
        rise = (foot - y) * height / side / tall
        half = np.interp(rise, knots[:, 0], knots[:, 1]) * wide
        off = (x - at) * width / side
        mask = np.clip((half - np.abs(off)) * side / 1.5, 0, 1) * (rise > 0) * (rise < 1)
        shade = (
            np.array(colour, float)
            * (1.06 - 0.34 * np.clip(off / np.maximum(half, 1e-3) * 0.5 + 0.5, 0, 1))[..., None]
            + 8 * noise(rng, size, 8, 3)[..., None]
        )
        cast = np.exp(-(((off - 0.1) / 0.16) ** 2 + ((y - foot) * 26) ** 2)) * 0.35
        image = masked(image, (60, 44, 36), cast)
        image = masked(image, shade, mask)
    for at, tone in ((0.41, (206, 150, 62)), (0.6, (176, 72, 50)), (0.66, (196, 92, 58))):
        r = np.hypot((x - at) * width, (y - 0.79) * height) / side
        shade = (
            np.array(tone, float)
            * (1.15 - 3.2 * np.clip((x - at) * width / side + 0.04, 0, 0.2))[..., None]
        )
        image = masked(image, shade, np.clip((0.047 - r) * side / 1.5, 0, 1))
    return textured(image, rng, 6.0, 5.0)


def branch(rng: Rng, size: SizePx) -> Image.Image:
    """A blossoming bough and a small bird, in ink and one red."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    image, pen = canvas((width, height), (239, 233, 218))
    side = min(width, height)

    def bough(at: FloatArray, angle: float, long: float, thick: float, depth: int) -> None:
        for step in range(6):
            angle += float(rng.uniform(-0.22, 0.2))
            end = at + long / 6 * np.array([math.cos(angle), math.sin(angle)])
            pen.line(
                [tuple(at.tolist()), tuple(end.tolist())],
                fill=(56, 46, 42),
                width=max(2, int(thick)),
            )
            at, thick = end, thick * 0.9
            if depth and step in (1, 3, 4):
                side_angle = angle + (0.8 if step == 3 else -0.75)
                bough(at, side_angle, long * 0.52, thick * 0.62, depth - 1)
            if depth < 2 and rng.random() < 0.8:
                spot = at + rng.uniform(-0.02, 0.02, 2) * side
                r = side * float(rng.uniform(0.009, 0.016))
                for petal in range(5):
                    a = petal * 2 * math.pi / 5 + r
                    px, py = spot[0] + r * math.cos(a), spot[1] + r * math.sin(a)
                    pen.ellipse(
                        (px - r * 0.8, py - r * 0.8, px + r * 0.8, py + r * 0.8),
                        fill=(206, 108, 104),
                    )
                pen.ellipse(
                    (spot[0] - r * 0.4, spot[1] - r * 0.4, spot[0] + r * 0.4, spot[1] + r * 0.4),
                    fill=(244, 222, 190),
                )

    bough(np.array([width * -0.02, height * 0.62]), -0.35, side * 1.05, side * 0.024, 2)
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 5.0, 0.0)
