"""The certificate as `--json` prints it, as types (results.py has those of verbs)."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict


class Finding(TypedDict):
    """An error of the stage."""

    rule: str
    path: str
    message: str


class Collision(TypedDict):
    """Two meshes in each other."""

    a: str
    b: str
    depth_m: float


class Outlier(TypedDict):
    """What the layout model would not have put there."""

    path: str
    score: float


class Missing(TypedDict):
    """What a room lacks."""

    path: str
    pieces: list[str]


class Misplaced(TypedDict):
    """A piece that is placed wrongly."""

    item: str
    category: str
    fault: str


class Objects(TypedDict):
    """Counts of objects, by room."""

    total: int
    median: float
    least: int
    by_kind: dict[str, float]


class Dressing(TypedDict):
    """How far rooms are dressed; shares in [0, 1]."""

    items: int
    windows_dressed: float
    wet_rooms_with_mirror: float
    textured_area: float


class BrokenRule(TypedDict):
    """A planning number that is not kept; need_m and have_m are None unless the unit is "m"."""

    rule: str
    source: str
    unit: str
    at: list[float]
    items: list[str]
    need_m: float | None
    have_m: float | None
    need: NotRequired[float | None]
    have: NotRequired[float | None]


class Judged(TypedDict):
    """Planning rules of a room, a table or the home."""

    path: str
    kind: str
    rules_kept: int
    rules: int
    findings: list[BrokenRule]


class Design(TypedDict):
    """Planning rules of a house."""

    rules_kept: float
    rooms: list[Judged]
    home: Judged


class Unreachable(TypedDict):
    """A room out of reach."""

    path: str
    shut_by: Literal["furniture", "plan"]


class Opens(TypedDict):
    """A door, drawer, flap or lid of furniture, and how far it opens."""

    path: str
    free_share: float
    free: str
    stopped_by: str


class BrokenClause(BrokenRule):
    """A value that does not keep a clause of a standard."""

    clause: str
    path: str


class Clause(TypedDict):
    """A clause of a standard that is not checked."""

    clause: str
    text: str
    source: str


class Kept(TypedDict):
    """How a home keeps a standard."""

    standard: str
    title: str
    summary: str
    holds: bool
    kept: list[str]
    idle: list[str]
    findings: list[BrokenClause]
    not_checked: list[Clause]


class Pulled(TypedDict):
    """How far a joint opens by force."""

    path: str
    """Of the body that it moves, in the variant `jointed`."""
    share: float
    """Of its range, up to 1."""


class Certificate(TypedDict):
    """check."""

    holds: bool
    valid: bool
    errors: list[Finding]
    collisions: list[Collision]
    out_of_room: list[str]
    blocked_openings: list[str]
    unsupported: list[str]
    empty_rooms: list[str]
    walkable: float
    reachable_rooms: float
    por: float
    piou: float
    pairs: int
    ood: list[Outlier]
    complete: float
    right: float
    missing: list[Missing]
    home_lacks: list[str]
    misplaced: list[Misplaced]
    objects: Objects
    dressing: Dressing
    design: Design
    stairs: list[str]
    unreachable: list[Unreachable]
    opens: list[Opens]
    standards: list[Kept]
    pulled: NotRequired[list[Pulled]]
    """With --open."""
    faults: list[str]
