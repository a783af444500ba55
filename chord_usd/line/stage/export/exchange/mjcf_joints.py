"""Joints of UsdPhysics as degrees of freedom, with the numbers that the stage gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import UsdPhysics

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import Frames, dotted, numbers, rigid, turned

_AXES = {"X": np.array([1.0, 0, 0]), "Y": np.array([0, 1.0, 0]), "Z": np.array([0, 0, 1.0])}
_FAR = 1e4
"""Where only one limit is given, the other: in degrees or metres."""


@dataclass(frozen=True, eq=False)
class End:
    """Where a joint holds a body."""

    pose: FloatArray
    """(4, 4) in the world."""

    @classmethod
    def of(cls, matrix: FloatArray, at: Any, turn: Any) -> End:
        """From the frame of a prim, and position and rotation in it."""
        pose = rigid(matrix)
        pose[:3, 3] = (matrix @ [*at, 1.0])[:3]
        pose[:3, :3] = pose[:3, :3] @ turned(turn)
        return cls(pose)


@dataclass(frozen=True, eq=False)
class Link:
    """One degree of freedom; degrees for hinges, metres for slides."""

    name: str
    kind: str
    """hinge, slide, ball."""
    at: FloatArray
    """(3,)"""
    axis: FloatArray
    """(3,)"""
    limits: tuple[float, float] | None
    now: float
    """What the joint says as the stage stands."""
    drive: dict[str, float]
    """Damping, stiffness and where a spring pulls to, as MJCF counts them."""

    def seen_from(self, inverse: FloatArray) -> Link:
        """In another frame than the world, whose inverse this is, (4, 4)."""
        at = (inverse @ [*self.at, 1.0])[:3]
        return replace(self, at=at, axis=inverse[:3, :3] @ self.axis)

    def attributes(self) -> dict[str, str]:
        """Of a `<joint>`."""
        attributes = {"name": self.name, "type": self.kind}
        if np.abs(self.at).max() > 1e-9 and self.kind != "slide":
            attributes["pos"] = numbers(self.at)
        if self.kind != "ball":
            attributes["axis"] = numbers(self.axis)
        if self.limits:
            attributes["range"] = numbers(self.limits)
        if abs(self.now) > 1e-6:
            attributes["ref"] = numbers([self.now])
        return attributes | {name: f"{value:.6g}" for name, value in self.drive.items()}


def degrees_of_freedom(
    joint: UsdPhysics.Joint, base: End, tip: End, frames: Frames, *, flipped: bool
) -> tuple[str, list[Link]]:
    """What kind a joint is ("" for one that MJCF lacks), and its freedom, in the world.

    flipped: whether it is the base that hangs on the tip; its axes then look the other way.
    """
    prim = joint.GetPrim()
    name = dotted(prim.GetPath())
    reader = _JointReader(prim, name, base, tip, frames.metres, -1.0 if flipped else 1.0)
    if prim.IsA(UsdPhysics.FixedJoint):
        return "fixed", []
    if prim.IsA(UsdPhysics.RevoluteJoint):
        hinge = UsdPhysics.RevoluteJoint(prim)
        limits = hinge.GetLowerLimitAttr().Get(), hinge.GetUpperLimitAttr().Get()
        return "hinge", reader.hinge(name, hinge.GetAxisAttr().Get(), limits, "angular")
    if prim.IsA(UsdPhysics.PrismaticJoint):
        slide = UsdPhysics.PrismaticJoint(prim)
        limits = slide.GetLowerLimitAttr().Get(), slide.GetUpperLimitAttr().Get()
        return "slide", reader.slide(name, slide.GetAxisAttr().Get(), limits, "linear")
    if prim.IsA(UsdPhysics.SphericalJoint):
        ball = UsdPhysics.SphericalJoint(prim)
        cone = ball.GetConeAngle0LimitAttr().Get(), ball.GetConeAngle1LimitAttr().Get()
        widest = max(cone)
        limited = (0.0, widest) if min(cone) > 0.0 else None
        return "ball", [Link(name, "ball", tip.pose[:3, 3], _AXES["X"], limited, 0.0, {})]
    if prim.GetTypeName() == "PhysicsJoint":
        return reader.any_freedom()
    return "", []


@dataclass(frozen=True, eq=False)
class _JointReader:
    """A joint being read."""

    prim: Any
    name: str
    base: End
    tip: End
    metres: float
    sign: float

    def hinge(self, name: str, token: str, limits: Any, drive: str) -> list[Link]:
        """A turn about an axis; none where it is locked."""
        axis = _AXES[token]
        turn = self.base.pose[:3, :3].T @ self.tip.pose[:3, :3]
        off = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        across = np.trace(turn) - axis @ turn @ axis
        now = math.degrees(math.atan2(off @ axis, across))
        return self._link(
            name, "hinge", axis, limits, now, self._driven(drive, math.pi / 180.0, 1.0)
        )

    def slide(self, name: str, token: str, limits: Any, drive: str) -> list[Link]:
        """A way along an axis; none where it is locked."""
        axis = _AXES[token]
        now = (self.base.pose[:3, :3] @ axis) @ (self.tip.pose[:3, 3] - self.base.pose[:3, 3])
        limits = tuple(limit * self.metres for limit in limits)
        return self._link(
            name, "slide", axis, limits, float(now), self._driven(drive, 1.0, self.metres)
        )

    def any_freedom(self) -> tuple[str, list[Link]]:
        """Of a joint that says by limits what is locked."""
        links = []
        for read, kinds, drives in (
            (self.slide, "trans", ("transX", "transY", "transZ")),
            (self.hinge, "rot", ("rotX", "rotY", "rotZ")),
        ):
            for which in drives:
                limits: tuple[float, float] = (-math.inf, math.inf)
                if self.prim.HasAPI(UsdPhysics.LimitAPI, which):
                    limit = UsdPhysics.LimitAPI(self.prim, which)
                    limits = limit.GetLowAttr().Get(), limit.GetHighAttr().Get()
                links += read(f"{self.name}.{which}", which.removeprefix(kinds), limits, which)
        if len(links) == 1:
            return links[0].kind, [replace(links[0], name=self.name)]
        return ("free" if links else "fixed"), links

    def _link(
        self, name: str, kind: str, axis: FloatArray, limits: Any, now: float,
        drive: dict[str, float],
    ) -> list[Link]:  # fmt: skip
        low, high = limits
        if low > high:
            return []
        # Far limits are none; MJCF has either both or neither.
        far = _FAR * (1.0 if kind == "slide" else 36.0)
        bounded = low > -far or high < far
        limited = (max(low, -far), min(high, far)) if bounded else None
        way = self.sign * (self.tip.pose[:3, :3] @ axis)
        return [Link(name, kind, self.tip.pose[:3, 3], way, limited, now, drive)]

    def _driven(self, which: str, unit: float, length: float) -> dict[str, float]:
        """Springs and dampers. unit: from the stage's angles to the angles of MJCF's forces;
        length: from the stage's targets to the positions of MJCF's joints."""
        if not self.prim.HasAPI(UsdPhysics.DriveAPI, which):
            return {}
        drive = UsdPhysics.DriveAPI(self.prim, which)
        damping = drive.GetDampingAttr().Get() / unit
        stiffness = drive.GetStiffnessAttr().Get() / unit
        attributes = {"damping": damping} if damping else {}
        if stiffness:
            target = drive.GetTargetPositionAttr().Get() or 0.0
            attributes |= {"stiffness": stiffness, "springref": target * length}
        return attributes
