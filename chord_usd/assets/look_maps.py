"""Draws wall and floor looks: each function returns the maps of one seamless tile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.assets.look_noise import (
    Shape,
    blurred,
    cells,
    pixel_grid,
    shifted_samples,
    spectral_noise,
)
from chord_usd.scene.types import FloatArray

Rgb = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Maps:
    """One seamless tile of a surface."""

    rgb: FloatArray
    """(H, W, 3) sRGB, 0 to 255."""
    roughness: FloatArray
    """(H, W), 0 to 1."""
    height_m: FloatArray
    """(H, W) relief in metres."""


@dataclass(frozen=True, eq=False)
class Boards:
    """A floor divided into boards or tiles."""

    index: np.ndarray
    """(H, W) number of the board."""
    edge_m: FloatArray
    """(H, W) distance to the board's nearest edge."""
    upright: np.ndarray
    """(H, W) whether the board runs along y."""

    @property
    def count(self) -> int:
        """How many boards there are."""
        return int(self.index.max()) + 1

    @property
    def shape(self) -> Shape:
        """Rows and columns of the raster."""
        return self.index.shape[0], self.index.shape[1]


def mixed(low: Rgb, high: Rgb, share: FloatArray) -> FloatArray:
    """(H, W, 3) colours between low (share 0) and high (share 1)."""
    start, end = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
    return start + (end - start) * np.clip(share, 0.0, 1.0)[..., None]


def lit(rgb: FloatArray, gain: FloatArray) -> FloatArray:
    """Colours made lighter or darker by a factor per pixel."""
    return np.clip(rgb * gain[..., None], 0.0, 255.0)


# --- where boards and tiles lie ------------------------------------------------------------


def running_boards(
    rng: np.random.Generator,
    shape: Shape,
    tile_m: tuple[float, float],
    rows: int,
    per_row: int,
    *,
    offset: float | None = None,
) -> Boards:
    """Rows of boards along x. offset: share of a board by which each row is shifted; None shifts
    at random and varies the lengths, as a floor layer does."""
    y_px, x_px = pixel_grid(shape)
    x, y = x_px / shape[1], y_px / shape[0]
    row = np.minimum((y * rows).astype(np.int64), rows - 1)
    index, edge_x = np.empty(shape, dtype=np.int64), np.empty(shape)
    for number in range(rows):
        here = row == number
        if offset is None:
            cuts = np.linspace(0, 1, per_row, endpoint=False)
            cuts = np.sort((cuts + rng.uniform(-0.16, 0.16, per_row) / per_row + rng.random()) % 1)
        else:
            cuts = (np.arange(per_row) / per_row + offset * number / per_row) % 1
            cuts = np.sort(cuts)
        after = np.searchsorted(cuts, x[here], side="right")
        index[here] = number * per_row + (after - 1) % per_row
        low, high = cuts[(after - 1) % per_row], cuts[after % per_row]
        edge_x[here] = np.minimum((x[here] - low) % 1, (high - x[here]) % 1) * tile_m[0]
    within = (y * rows) % 1
    edge_y = np.minimum(within, 1 - within) * tile_m[1] / rows
    return Boards(index, np.minimum(edge_x, edge_y), np.zeros(shape, dtype=bool))


def stood_up(boards: Boards) -> Boards:
    """Boards that run along y, of boards of a square raster that run along x."""
    return Boards(boards.index.T, boards.edge_m.T, ~boards.upright.T)


def herringbone(shape: Shape, tile_m: tuple[float, float], ratio: int, periods: int) -> Boards:
    """Blocks ratio times as long as wide, laid in a herringbone along both axes."""
    number = 2 * ratio * periods
    y_px, x_px = pixel_grid(shape)
    u, v = x_px / shape[1] * number, (1.0 - (y_px + 0.5) / shape[0]) * number
    i, j = u.astype(np.int64), np.clip(v.astype(np.int64), 0, number - 1)
    phase = (i - j) % (2 * ratio)
    upright = phase >= ratio
    along = np.where(upright, 2 * ratio - 1 - phase, phase)
    first_i = np.where(upright, i, i - along) % number
    first_j = np.where(upright, j - along, j) % number
    _, index = np.unique((first_i * number + first_j) * 2 + upright, return_inverse=True)
    fraction_u, fraction_v = u - i, v - j
    long_at = np.where(upright, fraction_v, fraction_u) + along
    across = np.where(upright, fraction_u, fraction_v)
    edge = np.minimum.reduce([long_at, ratio - long_at, across, 1 - across])
    return Boards(index.reshape(shape), edge * tile_m[0] / number, upright)


# --- materials ---------------------------------------------------------------------------------


def wood_floor(
    rng: np.random.Generator,
    boards: Boards,
    dark: Rgb,
    light: Rgb,
    *,
    variation: float = 0.09,
    gap_m: float = 0.0016,
    roughness: float = 0.42,
    bevel_m: float = 0.0008,
) -> Maps:
    """Boards with grain along each of them, every board from another tree."""
    shape = boards.shape
    rows, columns = pixel_grid(shape)
    jump_r = rng.integers(0, shape[0], boards.count)[boards.index]
    jump_c = rng.integers(0, shape[1], boards.count)[boards.index]
    # The grain is drawn along x; upright boards look it up with the axes exchanged.
    along = np.where(boards.upright, rows, columns) + jump_c
    across = np.where(boards.upright, columns, rows) + jump_r
    fibre = spectral_noise(rng, shape, slope=0.7, lowest=6, stretch=(28.0, 1.0))
    broad = spectral_noise(rng, shape, slope=1.6, lowest=3, stretch=(9.0, 1.0))
    swirl = spectral_noise(rng, shape, slope=2.0, lowest=2, stretch=(4.0, 1.0))
    rings = np.sin(2 * np.pi * (rows / shape[0] * 34.0 + 2.3 * swirl))
    grain = 0.5 + 0.1 * fibre + 0.13 * broad + 0.1 * rings
    grain = shifted_samples(grain, across, along)
    tone = _tones(rng, boards, variation)
    warmth = _tones(rng, boards, 0.02)
    rgb = lit(mixed(dark, light, grain), 1.0 + tone)
    rgb[..., 2] *= 1.0 - warmth
    gap = np.clip(1.0 - boards.edge_m / gap_m, 0.0, 1.0)
    rgb = lit(rgb, 1.0 - 0.62 * gap)
    fine = shifted_samples(fibre, across, along)
    height = bevel_m * (np.clip(boards.edge_m / (2.2 * gap_m), 0.0, 1.0) - 1.0) + 2.5e-5 * fine
    rough = np.clip(roughness - 0.05 * fine * 0.5 + 0.25 * gap, 0.05, 1.0)
    return Maps(np.clip(rgb, 0, 255), rough, height)


def _tones(rng: np.random.Generator, boards: Boards, deviation: float) -> FloatArray:
    """(H, W) one number per board; no outliers, which would betray the repeat of the tile."""
    tones = np.clip(rng.standard_normal(boards.count), -1.5, 1.5)
    return deviation * tones[boards.index]


def laid_tile(
    rng: np.random.Generator,
    boards: Boards,
    face: FloatArray,
    *,
    grout: Rgb,
    grout_m: float,
    roughness: float,
    variation: float = 0.015,
    cushion_m: float = 0.0012,
    waviness_m: float = 0.0,
) -> Maps:
    """Tiles with this face (H, W, 3) and grout between them; glazed ones may be a little wavy."""
    shape = boards.shape
    tone = _tones(rng, boards, variation)
    pixel_m = 0.0008
    joint = np.clip((grout_m / 2 + pixel_m - boards.edge_m) / pixel_m, 0.0, 1.0)
    grain = spectral_noise(rng, shape, slope=0.4, lowest=40)
    rgb = lit(face, 1.0 + tone)
    mortar = lit(np.broadcast_to(np.array(grout, float), (*shape, 3)), 1.0 + 0.03 * grain)
    rgb = rgb * (1.0 - joint[..., None]) + mortar * joint[..., None]
    rise = np.clip((boards.edge_m - grout_m / 2) / 0.004, 0.0, 1.0)
    height = cushion_m * np.sqrt(1.0 - (1.0 - rise) ** 2)
    if waviness_m > 0.0:
        lean = rng.normal(0.0, 1.0, (boards.count, 2))[boards.index]
        waves = spectral_noise(rng, shape, slope=2.0, lowest=8, highest=60)
        rows, columns = pixel_grid(shape)
        tilt = np.sin(rows / shape[0] * 40) * lean[..., 0] + np.sin(columns / 40) * lean[..., 1]
        height = height + waviness_m * (waves + 0.5 * tilt) * (1.0 - joint)
    rough = roughness * (1.0 - joint) + 0.85 * joint
    return Maps(rgb, np.clip(rough, 0.03, 1.0), height)


def stone_face(
    rng: np.random.Generator, boards: Boards, dark: Rgb, light: Rgb, contrast: float = 0.16
) -> FloatArray:
    """(H, W, 3) mottled stone, another piece of it on every tile."""
    shape = boards.shape
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=2)
    speck = spectral_noise(rng, shape, slope=0.5, lowest=30)
    rows, columns = pixel_grid(shape)
    jump = rng.integers(0, shape[0], (boards.count, 2))[boards.index]
    field = shifted_samples(cloud + 0.35 * speck, rows + jump[..., 0], columns + jump[..., 1])
    return mixed(dark, light, 0.5 + contrast * field)


def marble_face(rng: np.random.Generator, boards: Boards, vein: Rgb, ground: Rgb) -> FloatArray:
    """(H, W, 3) white marble with branching grey veins."""
    shape = boards.shape
    rows, columns = pixel_grid(shape)
    warp = spectral_noise(rng, shape, slope=1.9, lowest=2)
    strong, thin = np.zeros(shape), np.zeros(shape)
    for _ in range(2):
        field = spectral_noise(rng, shape, slope=2.2, lowest=1, highest=10, stretch=(1.0, 1.7))
        field = shifted_samples(field, rows + 26 * warp, columns - 22 * warp)
        strong = np.maximum(strong, np.exp(-np.abs(field) * 16))
    for _ in range(2):
        field = spectral_noise(rng, shape, slope=1.8, lowest=3, highest=26)
        thin = np.maximum(thin, np.exp(-np.abs(field) * 26))
    cloud = spectral_noise(rng, shape, slope=2.0, lowest=1)
    presence = np.clip(0.7 + 0.35 * spectral_noise(rng, shape, slope=2.2, lowest=1), 0.0, 1.0)
    share = 0.62 * strong * presence + 0.22 * thin * presence + 0.07 * np.clip(cloud, -1.5, 1.5)
    jump = rng.integers(0, shape[0], (boards.count, 2))[boards.index]
    share = shifted_samples(share, rows + jump[..., 0], columns + jump[..., 1])
    return mixed(ground, vein, share)


def terrazzo(rng: np.random.Generator, shape: Shape) -> Maps:
    """Polished cement with angular chips in three sizes."""
    rgb = np.broadcast_to(np.array((222.0, 217.0, 209.0)), (*shape, 3)).copy()
    rgb = lit(rgb, 1.0 + 0.012 * spectral_noise(rng, shape, slope=0.3, lowest=40))
    colours = np.array(
        [(178, 172, 164), (120, 116, 112), (196, 150, 122), (150, 160, 152), (244, 241, 236)],
        dtype=np.float64,
    )
    for count, chosen, border in ((5200, 0.34, 0.0016), (1500, 0.3, 0.0032), (420, 0.22, 0.0065)):
        number, inside = cells(rng, shape, count)
        kept = rng.random(count) < chosen
        tint = colours[rng.integers(0, len(colours), count)] * rng.normal(1, 0.04, (count, 1))
        border_of = border * rng.uniform(0.7, 2.2, count)
        chip = kept[number] & (inside > border_of[number])
        edge = blurred(chip.astype(np.float64), 0.6)[..., None]
        rgb = rgb * (1.0 - edge) + tint[number] * edge
    cloud = spectral_noise(rng, shape, slope=1.6, lowest=3)
    return Maps(np.clip(rgb, 0, 255), np.clip(0.24 + 0.02 * cloud, 0, 1), np.zeros(shape))


def carpet(rng: np.random.Generator, shape: Shape, dark: Rgb, light: Rgb) -> Maps:
    """Loop pile of mixed yarn."""
    pile = spectral_noise(rng, shape, slope=0.15, lowest=70, highest=190)
    yarn = spectral_noise(rng, shape, slope=0.5, lowest=12, stretch=(1.0, 2.0))
    trodden = spectral_noise(rng, shape, slope=2.0, lowest=1, highest=9)
    rgb = mixed(dark, light, 0.5 + 0.2 * pile + 0.09 * yarn + 0.05 * trodden)
    return Maps(rgb, np.full(shape, 0.96), 0.0009 * pile)


def plaster(
    rng: np.random.Generator, shape: Shape, tone: Rgb, *, relief_m: float = 0.00016
) -> Maps:
    """Painted plaster: the stipple of a roller and very faint clouds."""
    stipple = spectral_noise(rng, shape, slope=0.9, lowest=24, highest=220)
    cloud = spectral_noise(rng, shape, slope=2.0, lowest=1, highest=14)
    base = np.broadcast_to(np.array(tone, dtype=np.float64), (*shape, 3))
    rgb = lit(base, 1.0 + 0.006 * cloud + 0.004 * stipple)
    return Maps(rgb, np.full(shape, 0.86), relief_m * stipple)


def concrete(rng: np.random.Generator, boards: Boards, dark: Rgb, light: Rgb) -> Maps:
    """Fair-faced concrete: clouds, pores, and the joints of its formwork."""
    shape = boards.shape
    cloud = spectral_noise(rng, shape, slope=1.9, lowest=1, highest=24)
    sand = spectral_noise(rng, shape, slope=0.4, lowest=60)
    pores = np.clip(spectral_noise(rng, shape, slope=0.8, lowest=30, highest=160) - 2.7, 0.0, 1.0)
    joint = np.exp(-((boards.edge_m / 0.0025) ** 2))
    rgb = mixed(dark, light, 0.5 + 0.13 * cloud + 0.05 * sand)
    rgb = lit(rgb, 1.0 - 0.3 * pores - 0.22 * joint + _tones(rng, boards, 0.012))
    height = 6e-5 * sand - 0.0006 * pores - 0.0009 * joint
    return Maps(rgb, np.clip(0.72 + 0.05 * cloud + 0.1 * pores, 0.0, 1.0), height)


def striped_paper(
    rng: np.random.Generator, shape: Shape, ground: Rgb, stripe: Rgb, thin: Rgb, count: int
) -> Maps:
    """Wallpaper with broad stripes, each edged by a thin line, on a linen weave."""
    _, columns = pixel_grid(shape)
    phase = (columns / shape[1] * count) % 1
    broad = _soft_step(phase, 0.25, 0.012) - _soft_step(phase, 0.75, 0.012)
    line = sum(np.exp(-(((phase - at) / 0.008) ** 2)) for at in (0.19, 0.81))
    weave = _linen(rng, shape)
    rgb = mixed(ground, stripe, broad)
    rgb = rgb + (np.array(thin, dtype=np.float64) - rgb) * np.clip(line, 0, 1)[..., None]
    rgb = lit(rgb, 1.0 + 0.022 * weave)
    return Maps(rgb, np.clip(0.8 - 0.14 * broad, 0, 1), 5e-5 * weave)


def leafy_paper(rng: np.random.Generator, shape: Shape, ground: Rgb, leaf: Rgb, stem: Rgb) -> Maps:
    """Wallpaper with sprigs of leaves in a half drop."""
    rows, columns = pixel_grid(shape)
    x, y = columns / shape[1], 1.0 - rows / shape[0]
    leaves, stems = np.zeros(shape), np.zeros(shape)
    for at_x, at_y, lean in ((0.25, 0.25, 1.0), (0.75, 0.75, -1.0)):
        # Nearest copy of the sprig: the tile wraps around.
        dx = (x - at_x + 0.5) % 1 - 0.5
        dy = (y - at_y + 0.5) % 1 - 0.5
        bend = dx - lean * 0.07 * np.sin(dy * 5.2)
        reach = np.abs(dy) < 0.34
        stems = np.maximum(stems, np.exp(-((bend / 0.0045) ** 2)) * reach)
        for step in range(7):
            foot_y = -0.26 + 0.09 * step
            foot_x = lean * 0.07 * np.sin(foot_y * 5.2)
            size = 0.115 - 0.008 * step
            for side in (-1.0, 1.0):
                angle = np.radians(90.0 - side * (52.0 - 3.0 * step))
                shape_of_leaf = _leaf(dx - foot_x, dy - foot_y, angle, size)
                leaves = np.maximum(leaves, shape_of_leaf)
        leaves = np.maximum(
            leaves, _leaf(dx - lean * 0.07 * np.sin(0.34 * 5.2), dy - 0.33, np.radians(90.0), 0.1)
        )
    weave = _linen(rng, shape)
    rgb = mixed(ground, stem, stems)
    rgb = rgb + (np.array(leaf, dtype=np.float64) - rgb) * leaves[..., None]
    rgb = lit(rgb, 1.0 + 0.02 * weave)
    return Maps(rgb, np.clip(0.84 - 0.15 * leaves, 0, 1), 4e-5 * weave + 6e-5 * leaves)  # fmt: skip


def _leaf(dx: FloatArray, dy: FloatArray, angle: float, length: float) -> FloatArray:
    """Coverage of a pointed leaf whose foot is at the origin, with a bare midrib."""
    along = (dx * np.cos(angle) + dy * np.sin(angle)) / length
    across = (-dx * np.sin(angle) + dy * np.cos(angle)) / length
    inside = np.clip(along, 0.0, 1.0)
    half = 0.27 * np.sin(np.pi * inside**0.8) ** 1.1
    body = np.clip((half - np.abs(across)) * length * 900, 0.0, 1.0) * (along > 0) * (along < 1)
    rib = np.exp(-((across / 0.022) ** 2)) * (along < 0.85)
    return body * (1.0 - 0.75 * rib)


def _linen(rng: np.random.Generator, shape: Shape) -> FloatArray:
    """Threads both ways, deviation about 1."""
    warp = spectral_noise(rng, shape, slope=0.0, lowest=60, highest=260, stretch=(1.0, 30.0))
    weft = spectral_noise(rng, shape, slope=0.0, lowest=60, highest=260, stretch=(30.0, 1.0))
    return (warp + weft) / 1.5


def _soft_step(value: FloatArray, at: float, soft: float) -> FloatArray:
    return np.clip((value - at) / soft + 0.5, 0.0, 1.0)


def brickwork(rng: np.random.Generator, boards: Boards, dark: Rgb, light: Rgb, mortar: Rgb) -> Maps:
    """Fired bricks with worn edges and recessed mortar."""
    shape = boards.shape
    wear = spectral_noise(rng, shape, slope=1.2, lowest=14)
    fine = spectral_noise(rng, shape, slope=0.5, lowest=40)
    edge = boards.edge_m + 0.0011 * wear
    brick = np.clip((edge - 0.005) / 0.0018, 0.0, 1.0)
    fired = rng.random(boards.count)[boards.index]
    rgb = mixed(dark, light, fired + 0.1 * wear)
    rgb = lit(rgb, 1.0 + 0.07 * fine + _tones(rng, boards, 0.05))
    joint = lit(np.broadcast_to(np.array(mortar, float), (*shape, 3)), 1.0 + 0.05 * fine)
    rgb = joint + (rgb - joint) * brick[..., None]
    height = 0.007 * np.clip((edge - 0.0035) / 0.006, 0.0, 1.0) + 0.0004 * fine + 0.0004 * wear
    return Maps(np.clip(rgb, 0, 255), np.full(shape, 0.92), height)
