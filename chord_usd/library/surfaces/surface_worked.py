"""What a factory or a kitchen leaves: polished and coated metal, glaze, plastic, skins, heaps."""

from __future__ import annotations

import numpy as np

from chord_usd.library.surfaces.surface_pattern import Pattern, centred, even
from chord_usd.library.textures.fields import Ground, blurred, grains, noise, smoothstep


def polished(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Bright metal as hands leave it: smudges that blur its reflections, hairlines of wiping."""
    smudge = noise(rng, ground, 1.6, longest_m=0.133, shortest_m=0.0067)
    hairs = noise(rng, ground, 0.3, longest_m=0.011, stretch=(18.0, 1.0))
    depth = 0.012 * smudge + 0.012 * hairs
    roughness = 1.0 + 0.22 * np.clip(smudge, -1.8, 2.2) + 0.05 * hairs
    return Pattern(ground, centred(depth), 0.0000012 * hairs, roughness, 0.0)


def powder(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Powder coating, blackened or cast metal: a dry skin of fine bumps, a little worn."""
    bumps = noise(rng, ground, 0.5, longest_m=0.0025, shortest_m=0.00094)
    cloud = noise(rng, ground, 1.7, shortest_m=0.0067)
    depth = 0.035 * bumps + 0.03 * cloud
    roughness = 1.0 + 0.1 * cloud + 0.04 * bumps
    return Pattern(ground, centred(depth), 0.000016 * bumps, roughness, 0.2)


def patina(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Bronze and gilding: rubbed bright where hands pass, dark in between, never quite even."""
    rubbed = noise(rng, ground, 1.5, longest_m=0.083, shortest_m=0.0036)
    specks = noise(rng, ground, 0.3, longest_m=0.0049)
    depth = 0.11 * rubbed + 0.04 * specks
    height_m = 0.00004 * noise(rng, ground, 1.6, longest_m=0.021, shortest_m=0.0042)
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.16 * rubbed, 0.8, 0.01 * rubbed)


def glaze(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Sanitary ware, porcelain, enamel, wax: a skin that ran a little before it set."""
    ran = noise(rng, ground, 1.2, longest_m=0.03, shortest_m=0.006)
    cloud = noise(rng, ground, 1.7, shortest_m=0.025)
    depth = 0.01 * cloud + 0.007 * ran
    return Pattern(ground, centred(depth), 0.000009 * ran, 1.0 + 0.1 * cloud, 0.4)


def moulded(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Plastic and rubber: the fine grain that a mould is etched with."""
    grain = noise(rng, ground, 0.3, longest_m=0.0021, shortest_m=0.0007)
    cloud = noise(rng, ground, 1.7, shortest_m=0.0075)
    depth = 0.025 * grain + 0.018 * cloud
    return Pattern(ground, centred(depth), 0.00001 * grain, 1.0 + 0.05 * cloud, 0.2)


def peel(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Skin of fruit: pores of about a millimetre, a side that saw more sun."""
    _, inside = grains(rng, ground, 56)
    pores = 1.0 - smoothstep(0.06, 0.3, 0.5 - inside)
    ripe = noise(rng, ground, 1.9, shortest_m=0.005)
    depth = 0.13 * pores + 0.09 * ripe
    height_m = -0.00009 * blurred(pores, ground, 0.00016)
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.08 * ripe, 1.0, -0.02 * ripe)


def kernels(rng: np.random.Generator, ground: Ground) -> Pattern:
    """A heap of grains, seeds or granules of about 5 mm, with dark between them."""
    number, inside = grains(rng, ground, 24)
    tone = np.clip(rng.standard_normal(24 * 24), -1.8, 1.8).astype(np.float32)[number]
    belly = smoothstep(0.0, 0.42, inside)
    fine = noise(rng, ground, 0.5, longest_m=0.0028)
    depth = 0.42 * (1.0 - belly) + 0.07 * tone + 0.03 * fine
    height_m = 0.0011 * blurred(belly, ground, 0.00023)
    return Pattern(ground, centred(depth), height_m, even(ground, 1.0))
