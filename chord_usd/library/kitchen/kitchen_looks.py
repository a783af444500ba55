"""Colourways of kitchens: the same names on every cabinet, so that one choice dresses them all."""

from __future__ import annotations

from collections.abc import Mapping


def _kitchen(
    front: str, worktop: str, metal: str, appliance: str, *, body: str = "", plinth: str = ""
) -> dict[str, str]:
    return {
        "body": body or front, "front": front, "worktop": worktop, "handle": metal,
        "appliance": appliance, "plinth": plinth or body or front, "steel": "steel",
        "tap": "chrome" if metal == "steel" else metal, "dark_glass": "black_glass",
        "burner": "graphite", "grate": "black_metal", "mark": "light_grey", "sink": "ceramic",
        "channel": "graphite" if front != "graphite" else "black",
    }  # fmt: skip


LOOKS: Mapping[str, Mapping[str, str]] = {
    "white": _kitchen("white", "oak", "steel", "steel", plinth="light_grey"),
    "warm_white": _kitchen("warm_white", "marble", "brass", "steel"),
    "light_grey": _kitchen("light_grey", "quartz", "black_metal", "black"),
    "sand": _kitchen("sand", "dark_stone", "black_metal", "black"),
    "graphite": _kitchen("graphite", "quartz", "black_metal", "black"),
    "grey": _kitchen("grey", "concrete", "black_metal", "steel"),
    "black": _kitchen("black", "dark_walnut", "steel", "steel"),
    "sage": _kitchen("sage", "birch", "brass", "steel"),
    "navy": _kitchen("navy", "marble", "brass", "steel"),
    "forest": _kitchen("forest", "marble", "brass", "black"),
    "oak": _kitchen("oak", "dark_stone", "black_metal", "black", plinth="graphite"),
    "pale_oak": _kitchen("pale_oak", "quartz", "black_metal", "steel", plinth="light_grey"),
    "walnut": _kitchen("walnut", "quartz", "black_metal", "black", plinth="graphite"),
    "dark_walnut": _kitchen("dark_walnut", "concrete", "black_metal", "steel", plinth="black"),
}
"""Slot to finish, by colourway."""

FRIDGE_LOOKS: Mapping[str, Mapping[str, str]] = {
    name: {"body": body, "front": front, "handle": handle, "plinth": "graphite",
           "dark_glass": "black_glass", "seal": "graphite", "mark": "light_grey"}
    for name, body, front, handle in (
        ("steel", "grey", "steel", "steel"), ("white", "white", "white", "steel"),
        ("graphite", "graphite", "graphite", "black_metal"), ("sage", "sage", "sage", "chrome"),
    )
}  # fmt: skip
"""Colourways of refrigerators."""
