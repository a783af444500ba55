"""Changes as a USD layer over the house: what any program sees that opens the layer."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .edits import Changes, Edit, Looks, Matrix, Swap, to_json, understood
from .errors import InputError

SUFFIX = ".edits.usda"

_MARK = "string chord_edits = '''"
_END = "'''"

_HEAD = """#usda 1.0
(
    customLayerData = {{
        {mark}{edits}{end}
    }}
    defaultPrim = "{root}"
    doc = "Changes made in Blender, over {house}"
    metersPerUnit = 1
    renderSettingsPrimPath = "/{root}/Render/Settings"
    subLayers = [
        @./{house}@
    ]
    upAxis = "Z"
)
"""

_ROOFED_HEAD = """#usda 1.0
(
    defaultPrim = "{root}"
    metersPerUnit = 1
    subLayers = [
        @{stage}@
    ]
    upAxis = "Z"
)
"""

ROOT = "House"
"""The default prim of the houses that chord-usd writes."""


def edits_file(house: Path) -> Path:
    """The layer of changes that belongs to a house: house.usda has house.edits.usda beside it."""
    return house.with_name(house.stem + SUFFIX)


def opened_file(house: Path) -> Path:
    """What to open: the changes over the house where there are some, else the house."""
    edits = edits_file(house)
    return edits if edits.is_file() else house


def house_of(opened: Path) -> Path:
    """The house itself, of a path that may be its layer of changes."""
    name = opened.name
    return (
        opened.with_name(name.removesuffix(SUFFIX) + ".usda") if name.endswith(SUFFIX) else opened
    )


def roof_of(house: Path) -> str:
    """The roof that a house offers, by the payload beside it; empty for none."""
    payloads = sorted(house.parent.glob(f"{house.stem}_architecture/Roof_*.usdc"))
    return payloads[0].stem.removeprefix("Roof_") if payloads else ""


def roofed_text(opened: Path, roof: str) -> str:
    """A layer over a stage, anywhere, that selects the roof of the house."""
    root = _Over(metadata=_variants({"roof": roof}))
    head = _ROOFED_HEAD.format(root=ROOT, stage=opened.resolve().as_posix())
    return "\n".join([head, *root.lines(ROOT, ""), ""])


def read_changes(house: Path) -> Changes:
    """The changes saved for this house; none where there is no such layer, or one of others."""
    return _read(edits_file(house)) or Changes()


def write_changes(house: Path, changes: Changes) -> Path | None:
    """Write the layer, whole or not at all; without changes it is taken away. Returns its path.

    Raises InputError rather than replacing a layer that somebody else wrote, OSError.
    """
    file = edits_file(house)
    if file.exists() and _read(file) is None:
        raise InputError(
            f"{file.name} was not written by this panel, or by a newer one, and is left alone. "
            "Give it another name, then save again."
        )
    if changes.is_nothing:
        file.unlink(missing_ok=True)
        return None
    partial = file.with_name(file.name + ".part")
    partial.write_text(layer_text(house.name, changes), encoding="utf-8")
    partial.replace(file)
    return file


def mend_layer(house: Path) -> None:
    """Write the layer again where it holds changes of what no house has: USD cannot open it.

    Raises InputError, OSError.
    """
    changes = _read(edits_file(house))
    if changes is not None and json.loads(json.dumps(to_json(changes))) != _data(edits_file(house)):
        write_changes(house, changes)


def _read(file: Path) -> Changes | None:
    """The changes that a layer holds; None for a file that is not there, or not ours."""
    try:
        return understood(_data(file))
    except (OSError, ValueError, TypeError, KeyError, AttributeError, IndexError):
        return None


def _data(file: Path) -> Any:
    """What the layer's comment holds. Raises OSError, ValueError."""
    text = file.read_text(encoding="utf-8")
    first = text.index(_MARK) + len(_MARK)
    return json.loads(text[first : text.index(_END, first)])


@dataclass
class _Over:
    """Opinions about one prim, as lines of text, and about those below it."""

    metadata: list[str] = field(default_factory=list)
    properties: list[str] = field(default_factory=list)
    below: dict[str, _Over] = field(default_factory=dict)

    def at(self, path: str) -> _Over:
        """The one of a path below this."""
        over = self
        for name in path.strip("/").split("/"):
            over = over.below.setdefault(name, _Over())
        return over

    def lines(self, name: str, pad: str) -> list[str]:
        """As USD writes it."""
        head = [f'{pad}over "{name}"']
        if self.metadata:
            metadata = [f"{pad}    {line}" for line in self.metadata]
            head = [f'{pad}over "{name}" (', *metadata, f"{pad})"]
        body = [f"{pad}    {line}" for line in self.properties]
        for child, over in self.below.items():
            body += over.lines(child, pad + "    ")
        return [*head, f"{pad}{{", *body, f"{pad}}}"]


def layer_text(house_name: str, changes: Changes) -> str:
    """The layer as text: an `over` for everything changed, nothing else of the house."""
    top = _Over()
    top.at(ROOT)
    for path, edit in sorted(changes.pieces.items()):
        _write_edit(top.at(path), edit)
    for path, looks in sorted(changes.looks.items()):
        top.at(path).metadata += _variants(looks)
    for path, strength in sorted(changes.lights.items()):
        # Exposure multiplies, so that day and evening keep their difference.
        top.at(path).properties.append(f"float inputs:exposure = {math.log2(strength):.9g}")
    head = _HEAD.format(
        mark=_MARK, edits=json.dumps(to_json(changes)), end=_END, root=ROOT, house=house_name
    )
    lines = [line for name, over in top.below.items() for line in over.lines(name, "")]
    return head + "\n" + "\n".join(lines) + "\n"


def _write_edit(over: _Over, edit: Edit) -> None:
    if edit.matrix is None:
        over.metadata.append("active = false")
        return
    if edit.swap:
        _write_swap(over, edit.swap)
    over.properties += _placement(edit.matrix)


def _write_swap(over: _Over, swap: Swap) -> None:
    """Not prepended: the model that was there goes."""
    over.metadata.append(f"references = @./{swap.usd}@")
    over.metadata += _variants(swap.looks)
    length, width, height = swap.size_m
    over.properties.append(
        f"custom double3 chord:size_m = ({length:.9g}, {width:.9g}, {height:.9g})"
    )
    if swap.kg_per_m3:
        mass_kg = swap.kg_per_m3 * length * width * height
        over.properties.append(f"float physics:mass = {mass_kg:.6g}")


def _variants(looks: Looks) -> list[str]:
    chosen = [f'    string {name} = "{variant}"' for name, variant in sorted(looks.items())]
    return ["variants = {", *chosen, "}"] if chosen else []


def _placement(matrix: Matrix) -> list[str]:
    """USD multiplies rows from the left: its matrices are Blender's transposed."""
    rows = ", ".join(
        "(" + ", ".join(f"{matrix[row][column]:.9g}" for row in range(4)) + ")"
        for column in range(4)
    )
    return [
        f"matrix4d xformOp:transform = ( {rows} )",
        'uniform token[] xformOpOrder = ["xformOp:transform"]',
    ]
