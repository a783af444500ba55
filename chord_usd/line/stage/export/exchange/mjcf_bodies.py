"""Bodies of a stage and the joints between them, as the tree that MJCF wants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import Frames, dotted, rigid
from chord_usd.line.stage.export.exchange.mjcf_joints import End, Link, degrees_of_freedom

PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


@dataclass(eq=False)
class Body:
    """What moves as one; the world is the first."""

    prim: Usd.Prim
    pose: FloatArray
    """(4, 4) in the world, without scale."""
    moves: bool = False
    is_led: bool = False
    """Whether it is moved from outside and by nothing else."""
    parent: Body | None = None
    """What its joint ties it to; without one it hangs on the world, or is free."""
    links: list[Link] = field(default_factory=list)
    parts: list[Usd.Prim] = field(default_factory=list)
    """Prims that belong to it and to none within it."""

    @property
    def name(self) -> str:
        """Its path."""
        return name_of(self.prim)

    def hangs_on(self, other: Body) -> bool:
        """Whether it is the other or tied to it, by however many joints."""
        return self is other or (self.parent is not None and self.parent.hangs_on(other))


@dataclass(frozen=True, eq=False)
class Loop:
    """A joint between bodies that are tied already."""

    path: str
    first: Body
    second: Body
    kind: str
    anchor: FloatArray
    """(3,) in the frame of the first."""


@dataclass(frozen=True, eq=False)
class Mechanism:
    """All bodies of a stage."""

    bodies: tuple[Body, ...]
    """The world first, the others in the order of the stage."""
    loops: tuple[Loop, ...]
    apart: tuple[tuple[Body, Body], ...]
    """Pairs that a joint says do not touch each other."""
    left_out: tuple[str, ...]
    """Paths of joints that MJCF has no word for."""


def name_of(prim: Usd.Prim) -> str:
    """The dotted path of a prim; no prim may be called what all call the world."""
    name = dotted(prim.GetPath())
    return f"{name}_" if name == "world" else name


def mechanism_of(stage: Usd.Stage, frames: Frames) -> Mechanism:
    """Read rigid bodies, and as bodies that stand still components and what joints hold on to."""
    joints = [
        UsdPhysics.Joint(prim)
        for prim in Usd.PrimRange.Stage(stage, PROXIES)
        if prim.IsA(UsdPhysics.Joint)
    ]
    joints = [joint for joint in joints if joint.GetJointEnabledAttr().Get()]
    held = {
        target
        for joint in joints
        for side in (joint.GetBody0Rel(), joint.GetBody1Rel())
        for target in side.GetForwardedTargets()
    }
    world = Body(stage.GetPseudoRoot(), np.eye(4))
    bodies = [world]
    owners = {"/": world}

    def gather(prim: Usd.Prim, owner: Body) -> None:
        for child in prim.GetFilteredChildren(PROXIES):
            body = _starts(child, owner, held, frames)
            if body:
                bodies.append(body)
            (body or owner).parts.append(child)
            owners[str(child.GetPath())] = body or owner
            if not child.IsA(UsdGeom.PointInstancer):
                gather(child, body or owner)

    gather(stage.GetPseudoRoot(), world)
    return _tie(bodies, owners, joints, frames)


def _starts(child: Usd.Prim, owner: Body, held: set, frames: Frames) -> Body | None:
    """The body that begins at a prim."""
    if child.HasAPI(UsdPhysics.RigidBodyAPI):
        api = UsdPhysics.RigidBodyAPI(child)
        if api.GetRigidBodyEnabledAttr().Get():
            is_led = bool(api.GetKinematicEnabledAttr().Get())
            return Body(child, rigid(frames.of(child)), moves=not is_led, is_led=is_led)
    if owner.moves or owner.is_led or not child.IsA(UsdGeom.Xformable):
        return None
    is_thing = Usd.ModelAPI(child).GetKind() == "component"
    if is_thing or child.GetPath() in held:
        return Body(child, rigid(frames.of(child)))
    return None


def _tie(
    bodies: list[Body], owners: dict[str, Body], joints: list[UsdPhysics.Joint], frames: Frames
) -> Mechanism:
    """Hang each body on another where a joint says so."""
    loops, left_out, apart = [], [], []
    for joint in joints:
        path = str(joint.GetPath())
        ends = list(_ends(joint, owners, frames))
        if len(ends) < 2:
            left_out.append(path)
            continue
        (parent, base), (child, tip) = ends
        flipped = not child.moves or (child.parent is not None and parent.moves)
        if flipped:
            parent, child = child, parent
        kind, dofs = degrees_of_freedom(joint, base, tip, frames, flipped=flipped)
        if not child.moves or not kind:
            left_out.append(path)
            continue
        if not joint.GetCollisionEnabledAttr().Get():
            apart.append((parent, child))
        if child.parent is not None or parent.hangs_on(child):
            if kind not in ("fixed", "hinge", "ball"):
                left_out.append(path)
                continue
            anchor = (np.linalg.inv(parent.pose) @ tip.pose)[:3, 3]
            loops.append(Loop(path, parent, child, kind, anchor))
            continue
        child.parent = parent
        inverse = np.linalg.inv(child.pose)
        child.links += [dof.seen_from(inverse) for dof in dofs]
    return Mechanism(tuple(bodies), tuple(loops), tuple(apart), tuple(left_out))


def _ends(
    joint: UsdPhysics.Joint, owners: dict[str, Body], frames: Frames
) -> Iterator[tuple[Body, End]]:
    """The two sides of a joint: which body, and where it is held, in the world."""
    stage = joint.GetPrim().GetStage()
    for side, at, turn in (
        (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    ):
        targets = side.GetForwardedTargets()
        prim = stage.GetPrimAtPath(targets[0]) if targets else stage.GetPseudoRoot()
        owner = owners.get(str(prim.GetPath())) if prim else None
        if owner is not None:
            matrix = frames.of(prim) if targets else frames.world
            yield owner, End.of(matrix, at.Get(), turn.Get())
