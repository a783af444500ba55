"""Rooms with slanted walls, laid out on a sheet that is turned until their walls are upright.

Nine of ten houses that the layout model has seen are axis-aligned (data.augment.SKEW_CHANCE): in a
wing that stands at 30 degrees it sets beds askew, or none. So each room is sampled where its walls
are upright, with its neighbours around it, and what was painted is turned back pixel by pixel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import (
    BoolArray,
    ByteArray,
    LayoutImage,
    Plan,
    PlanImage,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import fold_deg, m_from_px, px_from_m
from chord_usd.line.layout.draft import Draft
from chord_usd.line.layout.sample import LayoutModel

SAME_DEG = 2.0
"""Walls that differ by less run in one direction."""

AROUND_M = 0.5
"""Rooms this near to those that are sampled are drawn around them."""

LEAST_SHARE = 0.4
"""Of a room's walls, that must run in the direction that it is turned to."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A house drawn as it lies after a turn."""

    pose: Pose
    image: PlanImage

    def draft(self, listed: SceneGraph) -> Draft:
        """The pieces of a house painted as they lie on this sheet."""
        turned = posed(listed, self.pose)
        return Draft.of(turned.items, turned.rooms, self.image.frame)

    def turned_back(
        self, rgb: ByteArray, onto: ByteArray, bare: PlanImage, region: BoolArray
    ) -> ByteArray:
        """(H, W, 3) the raster onto with what rgb, drawn over this sheet, shows in a region of it.

        bare: the plan raster under onto. region: (H, W) floor of it. Where floor comes to lie on a
        wall of the sheet, along edges, it is bare.
        """
        drawn = onto.copy()
        rows, columns = np.nonzero(region)
        points_m = m_from_px(np.stack([columns, rows], axis=1) + 0.5, bare.frame)
        at = np.floor(px_from_m(self.pose.points(points_m), self.image.frame)).astype(int)
        x, y = at.clip(0, self.image.frame.height_px - 1).T
        floor = bare.rgb[rows, columns]
        is_floor = (self.image.rgb[y, x] == floor).all(axis=1)
        drawn[rows, columns] = np.where(is_floor[:, None], rgb[y, x], floor)
        return drawn


def sample_upright(
    model: LayoutModel,
    plan: Plan,
    plan_image: PlanImage,
    *,
    listed: SceneGraph | None = None,
    seed: int = 0,
    steps: int | None = None,
    sampler: str | None = None,
    progress: Progress | None = None,
) -> LayoutImage:
    """As model.sample of the raster of a plan, each of its rooms upright.

    listed: the plan with the pieces of lists, from which the model starts.
    """
    groups = rooms_by_direction(plan.rooms)
    sheets = [upright_sheet(plan, rooms, yaw, plan_image) for yaw, rooms in groups.items()]
    layouts = model.sample_batch(
        [sheet.image for sheet in sheets],
        seeds=[seed] * len(sheets),
        steps=steps,
        sampler=sampler,
        drafts=[sheet.draft(listed) for sheet in sheets] if listed else (),
        progress=progress,
    )
    if set(groups) == {0.0}:
        return layouts[0]
    rgb = plan_image.rgb
    for sheet, layout, rooms in zip(sheets, layouts, groups.values(), strict=True):
        floors = [canvas.room_pixels(room, plan_image.frame) for room in rooms]
        rgb = sheet.turned_back(layout.rgb, rgb, plan_image, np.logical_or.reduce(floors))
    return replace(layouts[0], rgb=frozen_array(rgb, np.uint8), frame=plan_image.frame)


def upright_sheet(
    plan: Plan, rooms: Sequence[Room], yaw_deg: float, plan_image: PlanImage
) -> Sheet:
    """Rooms whose walls run at yaw_deg, and those around them, turned until they are upright.

    At the scale of plan_image, the raster of the plan, which is the sheet of what is upright.
    """
    pose = Pose(yaw_deg=-yaw_deg)
    if yaw_deg == 0.0:
        return Sheet(pose, plan_image)
    group = shapely.union_all([room_polygon(room) for room in rooms])
    around = [room for room in plan.rooms if room_polygon(room).distance(group) < AROUND_M]
    turned = posed(replace(plan, rooms=tuple(around)), pose)
    frame = canvas.frame_at(turned, plan_image.frame.m_per_px)
    return Sheet(pose, canvas.draw_plan(turned, frame))


def rooms_by_direction(rooms: Sequence[Room]) -> dict[float, list[Room]]:
    """Rooms by the direction of their walls; directions that are nearly the same are one."""
    groups: dict[float, list[Room]] = {}
    for room in rooms:
        yaw_deg = direction_of(room)
        near = (known_deg for known_deg in groups if abs(fold_deg(known_deg - yaw_deg)) < SAME_DEG)
        groups.setdefault(next(near, yaw_deg), []).append(room)
    return groups


def direction_of(room: Room) -> float:
    """Degrees in [-45, 45) by which most of a room's walls are turned; 0 where none prevail.

    Walls at right angles run in one direction. Of directions that are as frequent, the one nearest
    to upright counts.
    """
    sides = np.roll(room.polygon_m, -1, axis=0) - room.polygon_m
    lengths = np.hypot(*sides.T)
    angles = fold_deg(np.degrees(np.arctan2(sides[:, 1], sides[:, 0])))
    near = np.abs(fold_deg(angles[:, None] - angles[None])) < SAME_DEG
    totals = near @ lengths
    best = totals >= (1.0 - 1e-6) * totals.max()
    index = int(np.where(best, np.abs(angles), np.inf).argmin())
    if totals[index] < LEAST_SHARE * lengths.sum() or abs(angles[index]) < SAME_DEG:
        return 0.0
    mean = np.average(fold_deg(angles[near[index]] - angles[index]), weights=lengths[near[index]])
    return round(float(angles[index] + mean), 6)
