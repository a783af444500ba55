"""Makes the stored cloths again: `python -m chord_usd.library.cloth.simulate [NAME …]`.

Needs Blender's bpy and about a minute a cloth. The files differ by a hair from machine to machine,
since a simulation does; that is why they are stored.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial

from chord_usd.library.cloth.bedding import Duvet, laid, over_rail
from chord_usd.library.cloth.cloth_grids import Made
from chord_usd.library.cloth.garments import coat
from chord_usd.library.cloth.hangings import Hanging, hung
from chord_usd.library.cloth.stored import save

_HANGINGS = {
    "curtain_wave_narrow": Hanging("wave", 0.6, 5, 2.0, 5, seed=1),
    "curtain_wave_wide": Hanging("wave", 1.2, 10, 2.0, 10, seed=2),
    "curtain_wave_open": Hanging("wave", 0.34, 6, 4.2, 6, seed=4),
    "curtain_pinch_narrow": Hanging("pinch", 0.6, 4, 2.0, 4, seed=12),
    "curtain_pinch_wide": Hanging("pinch", 1.2, 9, 2.0, 9, seed=13),
    "curtain_pinch_open": Hanging("pinch", 0.34, 5, 4.0, 5, seed=14),
    "curtain_pinch_tied": Hanging("pinch", 0.46, 5, 3.0, 5, is_tied=True, seed=5),
    "curtain_gather_narrow": Hanging("gather", 0.6, 10, 2.0, 5, seed=3),
    "curtain_gather_wide": Hanging("gather", 1.2, 17, 2.0, 9, seed=6),
    "curtain_gather_open": Hanging("gather", 0.34, 9, 3.4, 5, seed=7),
}

_DUVETS = {
    f"smooth_{100 * length:.0f}": Duvet(length, 1.42, 0.3, 3.0, 0.02, 0.04, seed, turned_m=0.36)
    for length, seed in ((1.0, 1), (1.6, 2))
} | {
    f"rumpled_{100 * length:.0f}": Duvet(length, 1.5, 0.32, 0.5, 0.06, 0.034, seed)
    for length, seed in ((1.0, 3), (1.6, 4))
}  # fmt: skip


def makers() -> dict[str, Callable[[], dict[str, Made]]]:
    """How the stored cloths are made: some hang together and are made at once."""
    found: dict[str, Callable[[], dict[str, Made]]] = {}
    for name, hanging in _HANGINGS.items():
        found[name] = partial(_alone, name, hung, hanging)
    for name, duvet in _DUVETS.items():
        found[name] = partial(_layers, name, duvet)
    for name, length, drop in (("towel_long", 0.46, 0.5), ("towel_short", 0.3, 0.34)):
        found[name] = partial(_alone, name, over_rail, length, drop, 9)
    for name, length, seed in (("coat_long", 1.0, 3), ("coat_short", 0.72, 4)):
        found[name] = partial(_alone, name, coat, length, seed)
    return found


def _alone(name: str, make: Callable[..., Made], *about: object) -> dict[str, Made]:
    return {name: make(*about)}


def _layers(name: str, duvet: Duvet) -> dict[str, Made]:
    return {f"{part}_{name}": made for part, made in laid(duvet).items()}


def main(names: list[str]) -> None:
    """Simulate these cloths, all of them by default, and store them."""
    every = makers()
    for name in names or list(every):
        for stored_name, made in every[name]().items():
            print(save(stored_name, *made))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
