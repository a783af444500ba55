"""What a factory or a kitchen leaves: polished and coated metal, glaze, plastic, skins, heaps."""

from __future__ import annotations

import numpy as np

from chord_usd.library.looks.look_noise import blurred, spectral_noise
from chord_usd.library.surfaces.surface_pattern import Pattern, centred, grains, smoothstep


def polished(rng: np.random.Generator, px: int) -> Pattern:
    """Bright metal as hands leave it: smudges that blur its reflections, hairlines of wiping."""
    tile_m, shape = (0.4, 0.4), (px, px)
    smudge = spectral_noise(rng, shape, slope=1.6, lowest=3, highest=60)
    hairs = spectral_noise(rng, shape, slope=0.3, lowest=px / 14, stretch=(18.0, 1.0))
    depth = 0.012 * smudge + 0.012 * hairs
    roughness = 1.0 + 0.22 * np.clip(smudge, -1.8, 2.2) + 0.05 * hairs
    return Pattern(tile_m, centred(depth), 0.0000012 * hairs, roughness, 0.0)


def powder(rng: np.random.Generator, px: int) -> Pattern:
    """Powder coating, blackened or cast metal: a dry skin of fine bumps, a little worn."""
    tile_m, shape = (0.16, 0.16), (px, px)
    bumps = spectral_noise(rng, shape, slope=0.5, lowest=px / 8, highest=px / 3)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=24)
    depth = 0.035 * bumps + 0.03 * cloud
    roughness = 1.0 + 0.1 * cloud + 0.04 * bumps
    return Pattern(tile_m, centred(depth), 0.000016 * bumps, roughness, 0.2)


def patina(rng: np.random.Generator, px: int) -> Pattern:
    """Bronze and gilding: rubbed bright where hands pass, dark in between, never quite even."""
    tile_m, shape = (0.25, 0.25), (px, px)
    rubbed = spectral_noise(rng, shape, slope=1.5, lowest=3, highest=70)
    specks = spectral_noise(rng, shape, slope=0.3, lowest=px / 10)
    depth = 0.11 * rubbed + 0.04 * specks
    height_m = 0.00004 * spectral_noise(rng, shape, slope=1.6, lowest=12, highest=60)
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.16 * rubbed, 0.8, 0.01 * rubbed)


def glaze(rng: np.random.Generator, px: int) -> Pattern:
    """Sanitary ware, porcelain, enamel, wax: a skin that ran a little before it set."""
    tile_m, shape = (0.3, 0.3), (px, px)
    ran = spectral_noise(rng, shape, slope=1.2, lowest=10, highest=50)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=12)
    depth = 0.01 * cloud + 0.007 * ran
    return Pattern(tile_m, centred(depth), 0.000009 * ran, 1.0 + 0.1 * cloud, 0.4)


def moulded(rng: np.random.Generator, px: int) -> Pattern:
    """Plastic and rubber: the fine grain that a mould is etched with."""
    tile_m, shape = (0.12, 0.12), (px, px)
    grain = spectral_noise(rng, shape, slope=0.3, lowest=px / 9, highest=px / 3)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=16)
    depth = 0.025 * grain + 0.018 * cloud
    return Pattern(tile_m, centred(depth), 0.00001 * grain, 1.0 + 0.05 * cloud, 0.2)


def peel(rng: np.random.Generator, px: int) -> Pattern:
    """Skin of fruit: pores of about a millimetre, a side that saw more sun."""
    tile_m, shape = (0.08, 0.08), (px, px)
    _, inside = grains(rng, px, 56)
    pores = 1.0 - smoothstep(0.06, 0.3, 0.5 - inside)
    ripe = spectral_noise(rng, shape, slope=1.9, lowest=1, highest=16)
    depth = 0.13 * pores + 0.09 * ripe
    height_m = -0.00009 * blurred(pores, px / 512)
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.08 * ripe, 1.0, -0.02 * ripe)


def kernels(rng: np.random.Generator, px: int) -> Pattern:
    """A heap of grains, seeds or granules of about 5 mm, with dark between them."""
    across = 24
    tile_m = (0.12, 0.12)
    number, inside = grains(rng, px, across)
    own = np.clip(rng.standard_normal(across * across), -1.8, 1.8)[number]
    belly = smoothstep(0.0, 0.42, inside)
    fine = spectral_noise(rng, (px, px), slope=0.5, lowest=px / 12)
    depth = 0.42 * (1.0 - belly) + 0.07 * own + 0.03 * fine
    return Pattern(tile_m, centred(depth), 0.0011 * blurred(belly, px / 512), 1.0 + 0.0 * own, 1.0)
