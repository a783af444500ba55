"""An artist's changes as a USD layer over the house: moved and removed pieces, keyed by path."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

Matrix = tuple[tuple[float, ...], ...]
"""Four rows of four, acting on columns, as Blender writes them; metres."""

SUFFIX = ".edits.usda"

MOVED_BY = 1e-5
"""Entries of a matrix that differ by less are the same."""

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
    subLayers = [
        @./{house}@
    ]
    upAxis = "Z"
)
"""


@dataclass(frozen=True)
class Edit:
    """What became of one piece."""

    matrix: Matrix | None
    """Its new placement in its parent; None where it was removed."""


Edits = Mapping[str, Edit]
"""By USD path."""


def edits_file(house: Path) -> Path:
    """The layer of changes that belongs to a house: house.usda has house.edits.usda beside it."""
    return house.with_name(house.stem + SUFFIX)


def opened_file(house: Path) -> Path:
    """What to open: the changes over the house where there are some, else the house."""
    edits = edits_file(house)
    return edits if edits.is_file() else house


def changes(before: Mapping[str, Matrix], after: Mapping[str, Matrix]) -> dict[str, Edit]:
    """What was moved or removed since the house came in. Pieces that are new are not ours."""
    found: dict[str, Edit] = {}
    for path, placed in before.items():
        now = after.get(path)
        if now is None:
            found[path] = Edit(None)
        elif not _same(placed, now):
            found[path] = Edit(now)
    return found


def read_edits(house: Path) -> dict[str, Edit]:
    """The changes saved for this house; none where there is no such layer, or one of others."""
    try:
        text = edits_file(house).read_text(encoding="utf-8")
        first = text.index(_MARK) + len(_MARK)
        told = json.loads(text[first : text.index(_END, first)])
        return {
            path: Edit(matrix and tuple(tuple(map(float, row)) for row in matrix))
            for path, matrix in told.items()
        }
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def write_edits(house: Path, edits: Edits) -> Path | None:
    """Write the layer, whole or not at all; without changes it is taken away. Returns its path."""
    file = edits_file(house)
    if not edits:
        file.unlink(missing_ok=True)
        return None
    partial = file.with_name(file.name + ".part")
    partial.write_text(layer_text(house.name, edits), encoding="utf-8")
    partial.replace(file)
    return file


def without_room(edits: Edits, room: str) -> dict[str, Edit]:
    """The changes outside a room: what stood in it is gone when it is furnished anew."""
    inside = f"/Rooms/{room}/"
    return {path: edit for path, edit in edits.items() if inside not in path}


def layer_text(house_name: str, edits: Edits) -> str:
    """The layer as text: an `over` for every piece, nothing else of the house."""
    told = {path: edit.matrix for path, edit in sorted(edits.items())}
    root = min(edits).split("/")[1]
    head = _HEAD.format(mark=_MARK, edits=json.dumps(told), end=_END, root=root, house=house_name)
    return head + "\n" + "\n".join(_overs(sorted(edits), edits, depth=0)) + "\n"


def _overs(paths: Iterable[str], edits: Edits, depth: int, above: str = "") -> list[str]:
    """Nested `over` blocks for all paths that begin with `above`."""
    names: dict[str, list[str]] = {}
    for path in paths:
        names.setdefault(path[len(above) + 1 :].split("/")[0], []).append(path)
    pad, lines = "    " * depth, []
    for name, below in names.items():
        own = f"{above}/{name}"
        edit = edits.get(own)
        removed = edit is not None and edit.matrix is None
        lines.append(f'{pad}over "{name}"' + (" (" if removed else ""))
        if removed:
            lines += [f"{pad}    active = false", f"{pad})"]
        lines.append(f"{pad}{{")
        if edit is not None and edit.matrix is not None:
            lines += _placement(edit.matrix, pad + "    ")
        deeper = [path for path in below if path != own]
        lines += _overs(deeper, edits, depth + 1, own) if deeper else []
        lines.append(f"{pad}}}")
    return lines


def _placement(matrix: Matrix, pad: str) -> list[str]:
    """USD multiplies rows from the left: its matrices are Blender's transposed."""
    rows = ", ".join(
        "(" + ", ".join(f"{matrix[row][column]:.9g}" for row in range(4)) + ")"
        for column in range(4)
    )
    return [
        f"{pad}matrix4d xformOp:transform = ( {rows} )",
        f'{pad}uniform token[] xformOpOrder = ["xformOp:transform"]',
    ]


def _same(a: Matrix, b: Matrix) -> bool:
    pairs = zip((x for row in a for x in row), (x for row in b for x in row), strict=True)
    return all(abs(x - y) < MOVED_BY for x, y in pairs)
