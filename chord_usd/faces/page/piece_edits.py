"""What was moved, swapped, deleted and locked in a house: the layer of changes beside it.

The layer is the Blender panel's: what is changed on the page is found there, and the other way
round. What the page does not change itself (looks, lights) is kept as it stands.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.house_history import Deed, recorded
from chord_usd.faces.page.kept_houses import EDITS, STAGE
from chord_usd.faces.page.swapped_models import checked_swap

SCHEMA = 2
MOST_EDITS = 5000

_PIECE = re.compile(
    r"/House/Rooms/(?:Storey_\d{1,2}/)?(NAME)/(?:Furniture|Dressing)/NAME(?:/NAME){0,8}".replace(
        "NAME", r"[A-Za-z_]\w{0,99}"
    ),
    re.ASCII,
)
"""Names as USD has them: of these letters, and none begins with a digit."""
_MARK, _END = "string chord_edits = '''", "'''"
_HEAD = """#usda 1.0
(
    customLayerData = {{
        {mark}{edits}{end}
    }}
    defaultPrim = "House"
    doc = "Changes made by hand, over {stage}"
    metersPerUnit = 1
    renderSettingsPrimPath = "/House/Render/Settings"
    subLayers = [
        @./{stage}@
    ]
    upAxis = "Z"
)

"""

Edits = dict[str, Any]


def read_edits(folder: Path) -> Edits:
    """The changes of the house in a folder: pieces by path, and which are locked."""
    try:
        text = (folder / EDITS).read_text()
        first = text.index(_MARK) + len(_MARK)
        edits: Edits = json.loads(text[first : text.index(_END, first)])
    except (OSError, ValueError):
        return {"schema": SCHEMA, "pieces": {}, "looks": {}, "lights": {}, "locked": []}
    return edits


def write_edits(folder: Path, given: object) -> Edits:
    """Keep the pieces and locks that the page gives; returns all changes.

    given: {"pieces": {path: {"was": matrix, "matrix": matrix or null, "swap": perhaps another
    model}}, "locked": [path]}; a matrix
    is four rows of four that act on columns, in metres, in the frame of the piece's parent.
    Raises ChordError for anything else.
    """
    if not isinstance(given, dict):
        raise ChordError("the changes are no object")
    pieces, locked = given.get("pieces", {}), given.get("locked", [])
    if not isinstance(pieces, dict) or not isinstance(locked, list):
        raise ChordError("the changes are no pieces and locks")
    if len(pieces) + len(locked) > MOST_EDITS:
        raise ChordError(f"there are more than {MOST_EDITS} changes")
    edits = {
        **read_edits(folder),
        "pieces": {
            room_of(path) and path: {
                "was": _matrix(edit.get("was")),
                "matrix": None if edit.get("matrix") is None else _matrix(edit["matrix"]),
                **(
                    {"swap": checked_swap(edit["swap"], folder)}
                    if edit.get("swap") and edit.get("matrix") is not None
                    else {}
                ),
            }
            for path, edit in sorted(pieces.items())
            if isinstance(edit, dict)
        },
        "locked": sorted({path for path in map(str, locked) if room_of(path)}),
    }
    with recorded(folder / STAGE, Deed("by hand", _changed(read_edits(folder), edits))):
        _write(folder, edits)
    return edits


def _changed(before: Edits, after: Edits) -> str:
    """The pieces that a change by hand is about, in words."""
    was, now = before["pieces"], after["pieces"]
    paths = [path for path in {**was, **now} if was.get(path) != now.get(path)]
    paths += sorted({*before["locked"]} ^ {*after["locked"]})
    names = list(dict.fromkeys(path.rsplit("/", 1)[-1] for path in paths))
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return ", ".join(names[:3]) + more


def carry_edits(folder: Path, *, room: str = "", touched: Iterable[str] = ()) -> None:
    """Leave a house that was changed those changes by hand that still mean something.

    room: was furnished again, and only locked pieces in it keep theirs. touched: pieces that the
    stage itself has as they were changed, or has no more.
    """
    edits = read_edits(folder)
    kept, done = tuple(edits["locked"]), frozenset(touched)

    def stays(path: str) -> bool:
        if path in done:
            return False
        match = _PIECE.fullmatch(path)
        return not match or match[1] != room or _is_of(path, kept)

    for kind in ("pieces", "looks"):
        edits[kind] = {path: what for path, what in edits[kind].items() if stays(path)}
    _write(folder, edits)


def _is_of(path: str, pieces: Iterable[str]) -> bool:
    """Whether a path is one of these pieces, or stands on one."""
    return any(path == piece or path.startswith(f"{piece}/") for piece in pieces)


def room_of(path: str) -> str:
    """The room of a piece. Raises ChordError for what is no path of a piece."""
    match = _PIECE.fullmatch(path)
    if match is None:
        raise ChordError(f"{path[:80]!r} is no piece")
    return match[1]


def _matrix(rows: object) -> list[list[float]]:
    try:
        numbers = [[float(number) for number in row] for row in rows]  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        numbers = []
    if [len(row) for row in numbers] != [4] * 4 or not all(
        math.isfinite(number) and abs(number) < 1e4 for row in numbers for number in row
    ):
        raise ChordError("a placement is no matrix", expected="four rows of four numbers")
    return numbers


def _write(folder: Path, edits: Edits) -> None:
    if not any(edits[kind] for kind in ("pieces", "looks", "lights", "locked")):
        (folder / EDITS).unlink(missing_ok=True)
        return
    top = _Over()
    top.at("/House")
    for path, edit in sorted(edits["pieces"].items()):
        top.at(path).tell(edit)
    for path, looks in sorted(edits["looks"].items()):
        top.at(path).metadata += _variants(looks)
    for path, strength in sorted(edits["lights"].items()):
        top.at(path).properties.append(f"float inputs:exposure = {math.log2(strength):.9g}")
    head = _HEAD.format(mark=_MARK, edits=json.dumps(edits), end=_END, stage=STAGE)
    lines = [line for name, over in top.below.items() for line in over.lines(name, "")]
    write_atomic(folder / EDITS, head + "\n".join(lines) + "\n")


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

    def tell(self, edit: Edits) -> None:
        """What became of a piece."""
        if edit["matrix"] is None:
            self.metadata.append("active = false")
            return
        swap = edit.get("swap")
        if swap:
            # Not prepended: the model that was there goes.
            self.metadata.append(f"references = @./{swap['usd']}@")
            self.metadata += _variants(swap["looks"])
            size = ", ".join(f"{side:.9g}" for side in swap["size_m"])
            self.properties.append(f"custom double3 chord:size_m = ({size})")
        # USD multiplies rows from the left: its matrices are ours transposed.
        columns = zip(*edit["matrix"], strict=True)
        rows = ", ".join("(" + ", ".join(f"{x:.9g}" for x in column) + ")" for column in columns)
        self.properties += [
            f"matrix4d xformOp:transform = ( {rows} )",
            'uniform token[] xformOpOrder = ["xformOp:transform"]',
        ]

    def lines(self, name: str, pad: str) -> list[str]:
        """As USD writes it."""
        head = [f'{pad}over "{name}"']
        if self.metadata:
            head = [f'{pad}over "{name}" (', *(f"{pad}    {m}" for m in self.metadata), f"{pad})"]
        body = [f"{pad}    {line}" for line in self.properties]
        for child, over in self.below.items():
            body += over.lines(child, pad + "    ")
        return [*head, f"{pad}{{", *body, f"{pad}}}"]


def _variants(looks: Edits) -> list[str]:
    chosen = [f'    string {name} = "{variant}"' for name, variant in sorted(looks.items())]
    return ["variants = {", *chosen, "}"] if chosen else []
