"""What made a scene graph, as the key `provenance` of its JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from chord_usd.base.scene.json_elements import Element
from chord_usd.base.scene.types import Provenance

_KEYS = ("inputHash", "checkpointHash", "seed", "version", "configuration")


def read_provenance(house: Element) -> Provenance:
    """The provenance of a house's element, if it has any. Raises its error for unknown keys."""
    if not house.has("provenance"):
        return Provenance()
    element = house.element("provenance")
    for key in element.rest(_KEYS):
        raise element.error(f"unknown key '{key}'", expected=f"{', '.join(_KEYS)}")
    return Provenance(
        input_hash=element.text("inputHash"),
        checkpoint_hash=element.text("checkpointHash"),
        seed=element.whole("seed"),
        version=element.text("version"),
        configuration=element.element("configuration").raw(),
    )


def provenance_to_json(provenance: Provenance) -> dict[str, Any]:
    """The same keys; read_provenance gives the provenance back."""
    return dict(zip(_KEYS, asdict(provenance).values(), strict=True))
