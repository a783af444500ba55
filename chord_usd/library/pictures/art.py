"""Pictures drawn by code: colour fields, shapes, lines, weaves. Seeded by the picture's name."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from chord_usd.base.scene.types import FloatArray

Rgb = tuple[int, int, int]
Palette = tuple[Rgb, ...]
SizePx = tuple[int, int]
Rng = np.random.Generator
Draw = Callable[[Rng, SizePx], Image.Image]

EARTH: Palette = (
    (236, 226, 208),
    (196, 112, 76),
    (58, 70, 78),
    (214, 172, 110),
    (122, 132, 108),
    (150, 82, 60),
)
PALE: Palette = (
    (240, 236, 228),
    (204, 196, 184),
    (160, 172, 172),
    (222, 196, 180),
    (120, 132, 134),
    (84, 92, 98),
)
PRIMARY: Palette = (
    (238, 230, 212),
    (196, 60, 44),
    (34, 60, 104),
    (228, 176, 62),
    (28, 28, 30),
    (118, 142, 150),
)
DEEP: Palette = (
    (224, 212, 190),
    (44, 62, 66),
    (112, 52, 42),
    (176, 128, 70),
    (26, 32, 36),
    (92, 104, 92),
)
PAPER: Rgb = (242, 237, 226)
INK: Rgb = (34, 34, 38)


def noise(rng: Rng, size: SizePx, cells: int, octaves: int = 4) -> FloatArray:
    """(height, width) smooth noise, mean near 0, mostly within -1 to 1."""
    width, height = size
    total = np.zeros((height, width))
    for octave in range(octaves):
        count = cells * 2**octave
        coarse = rng.standard_normal((max(2, count * height // width + 2), count + 2))
        layer = Image.fromarray(coarse.astype(np.float32)).resize(size, Image.Resampling.BICUBIC)
        total += np.asarray(layer, dtype=np.float64) * 0.5**octave
    return total / 1.5


def textured(image: Image.Image, rng: Rng, grain: float = 5.0, weave: float = 3.0) -> Image.Image:
    """The picture on paper or canvas: a fine grain, and threads across."""
    width, height = image.size
    pixels = np.asarray(image.convert("RGB"), dtype=np.float64)
    rows = np.sin(np.arange(height) * 2.1)[:, None] + np.sin(np.arange(width) * 2.1)[None, :]
    shade = grain * rng.standard_normal((height, width)) * 0.5 + weave * 0.5 * rows
    shade += 2.0 * noise(rng, image.size, 5, 2)
    return Image.fromarray(np.clip(pixels + shade[..., None], 0, 255).astype(np.uint8))


def canvas(size: SizePx, rgb: Rgb = PAPER) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    """An empty picture of this colour and a pen for it."""
    image = Image.new("RGB", size, rgb)
    return image, ImageDraw.Draw(image)


def masked(image: Image.Image, rgb: FloatArray | Rgb, mask: FloatArray) -> Image.Image:
    """The picture with a colour, one or one a pixel, laid over it; mask 0 to 1."""
    under = np.asarray(image, dtype=np.float64)
    over = under + (np.asarray(rgb, dtype=np.float64) - under) * np.clip(mask, 0, 1)[..., None]
    return Image.fromarray(np.clip(over, 0, 255).astype(np.uint8))


def grid(size: SizePx) -> tuple[FloatArray, FloatArray]:
    """(x, y) shares of every pixel, 0 to 1, y from the top."""
    width, height = size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    return x, y


def colour_field(rng: Rng, size: SizePx, palette: Palette = EARTH) -> Image.Image:
    """Soft-edged bands of colour floating on a ground."""
    x, y = grid(size)
    order = rng.permutation(len(palette) - 1) + 1
    image, _ = canvas(size, palette[order[3]])
    cuts = np.array([0.06, 0.42 + 0.1 * rng.random(), 0.62 + 0.06 * rng.random(), 0.94])
    for index, (low, high) in enumerate(zip(cuts[:-1] + 0.012, cuts[1:] - 0.012, strict=True)):
        wobble = 0.012 * noise(rng, size, 6, 3)
        inside = np.minimum.reduce([x - 0.07, 0.93 - x, y - low, high - y]) + wobble
        wash = 0.78 + 0.16 * noise(rng, size, 3, 4)
        image = masked(image, palette[order[index]], np.clip(inside / 0.02, 0, 1) * wash)
    return textured(image, rng, 7.0, 4.0)


def arches(rng: Rng, size: SizePx, palette: Palette = EARTH) -> Image.Image:
    """Nested arches with a sun, cut from coloured paper."""
    image, pen = canvas(size, palette[0])
    width, height = size
    middle, foot = width * (0.34 + 0.32 * rng.random()), height * (0.72 + 0.2 * rng.random())
    count, colours = int(rng.integers(3, 6)), rng.permutation(len(palette) - 1) + 1
    for index, share in enumerate(np.linspace(0.4, 0.44 / count, count)):
        reach = share * width
        colour = palette[colours[index % len(colours)]]
        pen.ellipse(
            (
                middle - reach,
                foot - height * 0.42 - reach,
                middle + reach,
                foot - height * 0.42 + reach,
            ),
            fill=colour,
        )
        pen.rectangle((middle - reach, foot - height * 0.42, middle + reach, foot), fill=colour)
    sun = width * (0.07 + 0.07 * rng.random())
    at = (width * (0.2 if middle > width / 2 else 0.8), height * 0.16)
    pen.ellipse((at[0] - sun, at[1] - sun, at[0] + sun, at[1] + sun), fill=palette[colours[-1]])
    return textured(image, rng, 8.0, 0.0)


def bauhaus(rng: Rng, size: SizePx, palette: Palette = PRIMARY) -> Image.Image:
    """A grid of squares with discs, quarters, halves and bars."""
    image, pen = canvas(size, palette[0])
    width, height = size
    columns = 4
    side = width * 0.88 / columns
    rows = int(height * 0.9 / side)
    left, top = (width - columns * side) / 2, (height - rows * side) / 2
    for row in range(rows):
        for column in range(columns):
            x, y = left + column * side, top + row * side
            ground, figure = rng.choice(len(palette), 2, replace=False)
            pen.rectangle((x, y, x + side, y + side), fill=palette[ground])
            kind = int(rng.integers(6))
            fill = palette[figure]
            if kind == 0:
                pen.ellipse((x + 2, y + 2, x + side - 2, y + side - 2), fill=fill)
            elif kind in (1, 2):
                turn = int(rng.integers(4))
                at_x, at_y = x - side * (turn % 2), y - side * (turn // 2)
                start = {0: 180, 1: 270, 2: 90, 3: 0}[turn]
                pen.pieslice(
                    (at_x + (turn % 2) * 0, at_y, at_x + 2 * side, at_y + 2 * side),
                    start,
                    start + 90,
                    fill=fill,
                )
            elif kind == 3:
                pen.pieslice((x, y + side / 2, x + side, y + 1.5 * side), 180, 360, fill=fill)
            elif kind == 4:
                for bar in range(3):
                    low = y + side * (0.08 + 0.32 * bar)
                    pen.rectangle((x, low, x + side, low + side * 0.16), fill=fill)
            else:
                pen.polygon([(x, y + side), (x + side, y), (x + side, y + side)], fill=fill)
    return textured(image, rng, 6.0, 0.0)


def cut_outs(rng: Rng, size: SizePx, palette: Palette = EARTH) -> Image.Image:
    """Seaweed shapes scissored from paper, each on a block of colour."""
    image, pen = canvas(size, palette[0])
    width, height = size
    columns, rows = (2, 3) if height > width else (3, 2)
    wide, tall = width / columns, height / rows
    for cell in range(columns * rows):
        left, top = cell % columns * wide, cell // columns * tall
        ground, figure = rng.choice(len(palette), 2, replace=False)
        pen.rectangle((left + 4, top + 4, left + wide - 4, top + tall - 4), fill=palette[ground])
        lobes = int(rng.integers(5, 8))
        turn = np.linspace(0, 2 * math.pi, 160)
        radius = 0.26 + 0.13 * np.sign(np.sin(lobes * turn)) * np.abs(np.sin(lobes * turn)) ** 0.7
        stretch = 1.0 + 0.25 * np.sin(turn + rng.random() * 6)
        reach = min(wide, tall) * 1.1
        x = left + wide / 2 + radius * stretch * reach * np.cos(turn + 0.3)
        y = top + tall / 2 + radius * stretch * reach * np.sin(turn + 0.3)
        pen.polygon(list(zip(x.tolist(), y.tolist(), strict=True)), fill=palette[figure])
    return textured(image, rng, 7.0, 0.0)


def _curve(points: FloatArray, steps: int = 24) -> list[tuple[float, float]]:
    """Catmull-Rom spline through points (N, 2)."""
    padded = np.concatenate([points[:1], points, points[-1:]])
    path = []
    for index in range(len(points) - 1):
        a, b, c, d = padded[index : index + 4]
        for t in np.linspace(0, 1, steps, endpoint=False):
            path.append(
                0.5
                * (
                    2 * b
                    + (c - a) * t
                    + (2 * a - 5 * b + 4 * c - d) * t**2
                    + (3 * b - a - 3 * c + d) * t**3
                )
            )
    return [(float(x), float(y)) for x, y in [*path, points[-1]]]


_FACE = (
    (0.3, 0.95),
    (0.36, 0.8),
    (0.27, 0.72),
    (0.24, 0.55),
    (0.3, 0.34),
    (0.5, 0.24),
    (0.68, 0.3),
    (0.72, 0.42),
    (0.75, 0.47),
    (0.71, 0.53),
    (0.79, 0.6),
    (0.73, 0.635),
    (0.74, 0.67),
    (0.77, 0.69),
    (0.725, 0.71),
    (0.76, 0.74),
    (0.715, 0.765),
    (0.72, 0.81),
    (0.66, 0.85),
    (0.53, 0.83),
    (0.55, 0.97),
)
_HAIR = (
    (0.71, 0.36),
    (0.6, 0.16),
    (0.36, 0.18),
    (0.2, 0.34),
    (0.16, 0.56),
    (0.2, 0.7),
    (0.14, 0.83),
)
_EYE = ((0.57, 0.51), (0.62, 0.475), (0.68, 0.5), (0.62, 0.52), (0.57, 0.51))
_EAR = ((0.4, 0.52), (0.36, 0.49), (0.345, 0.56), (0.385, 0.62), (0.41, 0.58))
_BROW = ((0.54, 0.45), (0.61, 0.415), (0.7, 0.43))


def line_face(rng: Rng, size: SizePx, palette: Palette = EARTH) -> Image.Image:
    """A profile drawn in one line over two patches of colour."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    image, pen = canvas((width, height))
    side = min(width, height)
    offset = np.array([(width - side) / 2, (height - side) / 2])
    for index in range(2):
        at = offset + side * (np.array([0.36, 0.42]) + 0.24 * rng.random(2))
        turn = np.linspace(0, 2 * math.pi, 90)
        radius = side * (0.2 + 0.06 * np.sin(2 * turn + rng.random() * 6))
        blob = np.stack([at[0] + radius * np.cos(turn), at[1] + radius * np.sin(turn)], -1)
        pen.polygon([tuple(p) for p in blob.tolist()], fill=palette[(3, 4, 1)[index]])
    for line in (_FACE, _HAIR, _EYE, _EAR, _BROW):
        points = offset + side * (np.array(line) + 0.004 * rng.standard_normal((len(line), 2)))
        pen.line(_curve(points), fill=INK, width=max(3, side // 150), joint="curve")
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 4.0, 0.0)


def stripes(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """Bands of woven colour of unlike width."""
    image, pen = canvas(size, palette[0])
    width, height = size
    y = 0.0
    last = 0
    while y < height:
        tall = height * float(rng.choice([0.015, 0.03, 0.06, 0.11]))
        pick = int(rng.integers(len(palette)))
        pick = pick if pick != last else (pick + 1) % len(palette)
        pen.rectangle((0, y, width, y + tall), fill=palette[pick])
        y, last = y + tall, pick
    shift = (np.arange(width) % 4 < 2).astype(np.float64) * 6.0
    pixels = np.asarray(image, dtype=np.float64) + shift[None, :, None]
    return textured(Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)), rng, 8.0, 6.0)


def strokes(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """Broad brush strokes, one over another, with the bristles' trace."""
    image, _ = canvas(size, palette[0])
    x, y = grid(size)
    aspect = size[1] / size[0]
    for index in range(7):
        angle = float(rng.uniform(-0.5, 0.5)) + (math.pi / 2 if index % 3 == 2 else 0.0)
        at = rng.uniform(0.2, 0.8, 2)
        along = (x - at[0]) * math.cos(angle) + (y - at[1]) * aspect * math.sin(angle)
        across = -(x - at[0]) * math.sin(angle) + (y - at[1]) * aspect * math.cos(angle)
        across = across + 0.3 * along**2 * float(rng.uniform(-1, 1))
        reach, half = float(rng.uniform(0.25, 0.45)), float(rng.uniform(0.05, 0.1))
        hairs = rng.standard_normal(160)
        trace = np.interp(across / half, np.linspace(-1, 1, 160), hairs)
        ragged = reach + 0.05 * trace
        mask = np.clip((half - np.abs(across)) / 0.008, 0, 1)
        mask *= np.clip((ragged - np.abs(along)) / 0.02, 0, 1)
        colour = np.array(palette[1 + index % (len(palette) - 1)], dtype=np.float64)
        image = masked(image, colour + 7.0 * trace[..., None], mask * 0.94)
    return textured(image, rng, 5.0, 3.0)


def hatched(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """Contour lines of hills seen from above."""
    scale = 2
    big = (size[0] * scale, size[1] * scale)
    field = noise(rng, big, 2, 2) * 5.0
    distance = np.abs(field - np.round(field))
    slope = np.hypot(*np.gradient(field)) + 1e-9
    line = np.clip(1.8 - distance / slope, 0, 1)
    image, _ = canvas(big, PAPER)
    heavy = np.round(field) % 4 == 0
    image = masked(image, INK, line * np.where(heavy, 0.95, 0.5))
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 3.0, 0.0)


def gears(rng: Rng, size: SizePx, palette: Palette = DEEP) -> Image.Image:
    """A draughtsman's sheet of a machine: circles, spokes, axes, measures, white on blue."""
    scale = 2
    width, height = size[0] * scale, size[1] * scale
    ground, chalk = (38, 58, 82), (214, 222, 226)
    image, pen = canvas((width, height), ground)
    side = min(width, height)
    spots = ((0.42, 0.4, 0.27), (0.68, 0.66, 0.16), (0.26, 0.74, 0.12))
    for share_x, share_y, share in spots:
        x, y, r = share_x * width, share_y * height, share * side
        teeth = int(share * 130)
        turn = np.linspace(0, 2 * math.pi, teeth * 8, endpoint=False)
        rim = r * (1.0 + 0.035 * np.sign(np.sin(teeth * turn)))
        outline = list(
            zip((x + rim * np.cos(turn)).tolist(), (y + rim * np.sin(turn)).tolist(), strict=True)
        )
        pen.line([*outline, outline[0]], fill=chalk, width=3)
        for part in (0.86, 0.3, 0.16):
            pen.ellipse(
                (x - r * part, y - r * part, x + r * part, y + r * part), outline=chalk, width=3
            )
        for spoke in range(6):
            a = spoke * math.pi / 3 + share
            pen.line(
                [
                    (x + r * 0.3 * math.cos(a), y + r * 0.3 * math.sin(a)),
                    (x + r * 0.86 * math.cos(a), y + r * 0.86 * math.sin(a)),
                ],
                fill=chalk,
                width=5,
            )
        for a in (0.0, math.pi / 2):
            dx, dy = 1.25 * r * math.cos(a), 1.25 * r * math.sin(a)
            pen.line([(x - dx, y - dy), (x + dx, y + dy)], fill=(120, 146, 168), width=2)
    edge = side * 0.04
    pen.rectangle((edge, edge, width - edge, height - edge), outline=chalk, width=3)
    pen.rectangle(
        (width * 0.66, height - edge * 3.4, width - edge, height - edge), outline=chalk, width=3
    )
    for row in range(3):
        y = height - edge * (2.9 - 0.7 * row)
        pen.line(
            [(width * 0.69, y), (width * (0.82 + 0.04 * rng.random()), y)], fill=chalk, width=3
        )
    return textured(image.resize(size, Image.Resampling.LANCZOS), rng, 6.0, 0.0)


def city(rng: Rng, size: SizePx, palette: Palette = DEEP) -> Image.Image:
    """House fronts in hard light and shade, as a photographer sees them."""
    width, height = size
    image, pen = canvas(size, (206, 204, 200))
    x = -0.02 * width
    while x < width:
        wide = width * float(rng.uniform(0.12, 0.26))
        top = height * float(rng.uniform(0.12, 0.6))
        tone = int(rng.integers(40, 170))
        pen.rectangle((x, top, x + wide, height), fill=(tone, tone, tone - 2))
        step_x, step_y = wide / int(rng.integers(3, 6)), height * float(rng.uniform(0.035, 0.06))
        y = top + step_y * 0.6
        while y < height:
            column = x + step_x * 0.25
            while column < x + wide - step_x * 0.3:
                lit = tone + (45 if rng.random() < 0.2 else -26)
                pen.rectangle(
                    (column, y, column + step_x * 0.5, y + step_y * 0.55), fill=(lit, lit, lit)
                )
                column += step_x
            y += step_y
        shade = max(tone - 34, 8)
        pen.rectangle((x + wide * 0.86, top, x + wide, height), fill=(shade, shade, shade))
        x += wide
    haze = Image.new("RGB", size, (196, 194, 190))
    _, y_share = grid(size)
    mask = Image.fromarray((np.clip(0.45 - 0.4 * y_share, 0, 1) * 255).astype(np.uint8))
    image = Image.composite(haze, image, mask).filter(ImageFilter.GaussianBlur(0.7))
    return textured(image, rng, 11.0, 0.0)


def moons(rng: Rng, size: SizePx, palette: Palette = PALE) -> Image.Image:
    """The phases of the moon in a column or a row."""
    width, height = size
    image, _ = canvas(size, (36, 42, 54))
    count = 5
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    crater = noise(rng, size, 12, 4)
    for index in range(count):
        share = (index + 0.5) / count * 0.86 + 0.07
        at = (width / 2, height * share) if height >= width else (width * share, height / 2)
        r = 0.068 * max(width, height)
        dx, dy = (x - at[0]) / r, (y - at[1]) / r
        disc = np.clip((1.0 - np.hypot(dx, dy)) * r, 0, 1)
        phase = (-0.75, -0.2, 1.0, 0.2, 0.75)[index]
        edge = np.sqrt(np.clip(1 - dy**2, 0, 1))
        lit = (
            np.ones_like(dx)
            if index == 2
            else np.clip(
                (np.sign(phase) * dx / np.maximum(edge, 0.05) + (0.5 if abs(phase) < 0.5 else -0.1))
                * 8,
                0,
                1,
            )
        )
        tone = np.array((228, 220, 200), dtype=np.float64) + 12.0 * crater[..., None]
        image = masked(image, tone, disc * (0.1 + 0.9 * lit))
    return textured(image, rng, 5.0, 0.0)
