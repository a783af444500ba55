"""What `--json` prints, verb by verb, as types; `--json-schema` prints their JSON Schema."""

from __future__ import annotations

import types
from typing import (
    Any,
    Literal,
    NotRequired,
    TypedDict,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from chord_usd.faces.commands.certificate_results import Certificate

Seconds = dict[str, float]
"""By step."""

Verdict = Literal["right", "look", "wrong"]
"""On a plan that was read from a picture."""


class Edit(TypedDict):
    """What a rule did to a piece."""

    item: str
    rule: str
    moved_m: float


class Storey(TypedDict):
    """A storey, and how it was registered to the storey below."""

    name: str
    elevation_m: float
    rooms: int
    furniture: int
    registered_by: str | None
    shift_m: list[float]
    on_walls: float | None
    residual_m: float | None


Stair = TypedDict(
    "Stair", {"form": str, "rise_m": float, "going_m": float, "from": str, "to": str}
)  # fmt: skip


class Tabletop(TypedDict):
    """Pieces with objects, and objects; empty pieces by node id."""

    pieces: int
    items: int
    too_small: list[str]
    bare: list[str]
    left_out: int


class Planned(TypedDict):
    """A plan from words or from an open plan."""

    understood: str
    rooms: int
    room_counts: dict[str, int]
    area_m2: float
    openings: int
    candidates: int
    warnings: list[str]


class PlannedPlan(Planned):
    """plan from-text, plan from-outline."""

    plan: str
    seconds: Seconds


class Doubt(TypedDict):
    """What a reading is unsure of, ids of the rooms and openings that it is about, and where these
    lie, metres."""

    text: str
    ids: list[str]
    at: list[list[float]]


class DrawnPiece(TypedDict):
    """A piece that a drawing shows; box: middle, length and depth (metres), and turn (degrees)."""

    category: str
    box: list[float]
    confidence: float
    kept: bool
    reason: NotRequired[str]


class Generated(TypedDict):
    """generate."""

    stage: str
    style: str
    rooms: int
    furniture: int
    items: int
    tabletop: Tabletop
    dressing: int
    openings: int
    redrawn: list[str]
    left_out: list[str]
    drawn: list[DrawnPiece]
    edits: list[Edit]
    seconds: Seconds
    m_per_px: float
    scale: dict[str, Any] | str | None
    verdict: str | None
    storeys: list[Storey]
    stairs: list[Stair]
    certificate: Certificate | None
    warnings: list[str]
    planned: NotRequired[Planned]


class Regenerated(TypedDict):
    """regenerate."""

    stage: str
    room: str
    seed: int
    style: str
    furniture: int
    items: int
    dressing: int
    kept: list[str]
    edits: list[Edit]
    seconds: Seconds
    certificate: Certificate


class Intent(TypedDict):
    """A change that a sentence asks for."""

    action: str
    rooms: list[str]
    pieces: list[str]
    new: str
    count: int
    relation: str
    to: list[str]
    style: str
    coat: str
    surface: str
    told: str


class Stated(TypedDict):
    """A clause of --state, and the prims of the leaves and lights that it means."""

    subject: str
    state: str
    paths: list[str]


class Edited(TypedDict):
    """edit."""

    stage: str
    understood: list[Intent]
    answer: str
    read_as: list[str]
    rooms: list[str]
    added: list[str]
    removed: list[str]
    notes: list[str]
    moved: list[str]
    taken_over: list[str]
    states: list[Stated]
    written: bool
    seconds: Seconds
    certificate: Certificate


class PastChange(TypedDict):
    """A change of a house that can be had again; parent: the number of the one before it."""

    number: int
    parent: int | None
    made: str
    verb: str
    words: str


class Past(TypedDict):
    """history, undo, redo. number: of the change that the house stands at; undo, redo: of those
    that these verbs lead to; change: of the one that was undone, done again or gone to."""

    stage: str
    number: int
    undo: int | None
    redo: int | None
    changes: list[PastChange]
    done: NotRequired[str]
    change: NotRequired[int]


class Staged(TypedDict):
    """stage."""

    stage: str
    style: str
    rooms: int
    furniture: int
    dressing: int
    edits: list[Edit]
    content_hash: str
    seconds: Seconds
    certificate: Certificate | None


class Change(TypedDict):
    """A difference at a prim."""

    path: str
    text: str


class Changed(TypedDict):
    """diff."""

    same: bool
    changes: list[Change]


class Choice(TypedDict):
    """A variant set."""

    chosen: str
    offered: list[str]


class Piece(TypedDict):
    """A piece of a stage."""

    path: str
    component: str
    category: str
    size_m: list[float]
    asset: str
    looks: dict[str, Choice]
    carries: list[str]
    rests_on: str


class RoomContents(TypedDict):
    """A room of a stage."""

    name: str
    path: str
    kind: str
    looks: dict[str, Choice]
    furniture: list[Piece]
    dressing: list[Piece]
    requests: str


class Described(TypedDict):
    """describe."""

    stage: str
    looks: dict[str, Choice]
    rooms: list[RoomContents]
    cameras: list[str]


Exported = TypedDict("Exported", {"package": str, "for": str, "bytes": int})


class Rendered(TypedDict):
    """render."""

    pictures: list[str]
    files: list[str]
    rendered: int
    device: str | None
    seconds: Seconds


class LayoutDrawn(TypedDict):
    """layout."""

    layout: str
    m_per_px: float
    seconds: Seconds
    warnings: list[str]


class GraphRead(TypedDict):
    """graph."""

    graph: str
    rooms: int
    furniture: int
    openings: int
    edits: list[Edit]
    seconds: Seconds


class Frame(TypedDict):
    """Where a picture lies in the plan."""

    m_per_px: float
    origin_m: list[float]
    height_px: int


class PlanRead(TypedDict):
    """plan read."""

    plan: str
    rooms: int
    openings: int
    doors: int
    windows: int
    passages: int
    verdict: Verdict | None
    doubts: list[Doubt]
    scale: dict[str, Any] | str | None
    confidence: dict[str, float]
    drawn: list[DrawnPiece]
    warnings: list[str]
    drawing: NotRequired[Frame]


class PlanDrawn(TypedDict):
    """plan draw."""

    plan: str
    m_per_px: float


class Batch(TypedDict):
    """batch."""

    folder: str
    made: int
    kept: int
    failed: int
    failures: dict[str, str]
    holds: bool
    holding: int
    not_holding: list[str]
    pictures: int
    files: list[str]
    seconds: Seconds


class Bundle(TypedDict):
    """farm bundle."""

    template: str
    tasks: int


class Due(TypedDict):
    """farm due."""

    due: int
    tasks: int


class Script(TypedDict):
    """completion."""

    shell: str
    script: str


RESULTS: dict[str, Any] = {
    "generate": Generated, "regenerate": Regenerated, "edit": Edited, "stage": Staged,
    "undo": Past, "redo": Past, "history": Past,
    "check": Certificate, "diff": Changed, "describe": Described, "export": Exported,
    "render": Rendered, "layout": LayoutDrawn, "graph": GraphRead, "plan read": PlanRead,
    "plan draw": PlanDrawn, "plan from-text": PlannedPlan, "plan from-outline": PlannedPlan,
    "batch": Batch, "farm bundle": Bundle, "farm due": Due, "completion": Script,
}  # fmt: skip
"""By verb. Those of data, training, scores and assets print reports of no fixed form."""

_NAMES = {str: "string", int: "integer", float: "number", bool: "boolean", type(None): "null"}


def schema_of(verb: str) -> dict[str, Any]:
    """The JSON Schema (2020-12) of what a verb prints; any object for one not in RESULTS."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"chord-usd {verb}"}
    return {**head, **(_schema(RESULTS[verb]) if verb in RESULTS else {"type": "object"})}


def _schema(kind: Any) -> dict[str, Any]:
    if kind in _NAMES:
        return {"type": _NAMES[kind]}
    if is_typeddict(kind):
        hints = get_type_hints(kind, include_extras=True)
        return {
            "type": "object",
            "properties": {name: _schema(hint) for name, hint in hints.items()},
            "required": [n for n, hint in hints.items() if get_origin(hint) is not NotRequired],
            "additionalProperties": False,
        }
    inner = get_args(kind)
    match get_origin(kind):
        case origin if origin is list:
            return {"type": "array", "items": _schema(inner[0])}
        case origin if origin is dict:
            return {"type": "object", "additionalProperties": _schema(inner[1])}
        case origin if origin is Literal:
            return {"enum": list(inner)}
        case origin if origin in (Union, types.UnionType):
            return {"anyOf": [_schema(hint) for hint in inner]}
        case origin if origin is NotRequired:
            return _schema(inner[0])
    return {}
