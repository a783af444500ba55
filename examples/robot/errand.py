"""A robot on two wheels drives from the entrance to the kitchen, and the refrigerator opens.

python examples/robot/errand.py house.usda

The house is exported as a map and as a MuJoCo model. The way is planned on the map; doors of rooms
stand open; the refrigerator's door is pulled by a force at its free edge.
"""

from __future__ import annotations

import heapq
import json
import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy import ndimage

from chord_usd.line.stage.export.export_stage import export_stage

RADIUS_M, WHEEL_M, TRACK_M = 0.18, 0.06, 0.3
SPEED_M_PER_S, LOOK_AHEAD_M, THERE_M = 0.6, 0.3, 0.12
OPENING_S, PULL_N = 8.0, 30.0
FREE = 254
PAST_DOOR_M = 0.6

ROBOT = f"""
<mujoco>
  <worldbody>
    <body name="base">
      <freejoint name="base"/>
      <geom name="base" type="cylinder" size="{RADIUS_M} 0.06" pos="0 0 0.1" mass="8"
            contype="1" conaffinity="1"/>
      <geom type="sphere" size="0.02" pos="0.14 0 0.02" mass="0.1" friction="0.01" priority="1"/>
      <geom type="sphere" size="0.02" pos="-0.14 0 0.02" mass="0.1" friction="0.01" priority="1"/>
      <body name="left" pos="0 {TRACK_M / 2} {WHEEL_M}">
        <joint name="left" type="hinge" axis="0 1 0" damping="0.01"/>
        <geom type="cylinder" size="{WHEEL_M} 0.015" euler="90 0 0" mass="0.3" friction="1"
              priority="1"/>
      </body>
      <body name="right" pos="0 {-TRACK_M / 2} {WHEEL_M}">
        <joint name="right" type="hinge" axis="0 1 0" damping="0.01"/>
        <geom type="cylinder" size="{WHEEL_M} 0.015" euler="90 0 0" mass="0.3" friction="1"
              priority="1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <velocity name="left" joint="left" kv="1.5"/>
    <velocity name="right" joint="right" kv="1.5"/>
  </actuator>
</mujoco>
"""


@dataclass(frozen=True)
class Errand:
    """How it went."""

    way_m: float
    """Length of the way planned."""
    off_m: float
    """From where the robot was to go."""
    seconds: float
    """Of simulated driving."""
    opened_deg: float
    """How far the pull opens the refrigerator's door; 0 without one."""


class Map:
    """The exported map and graph of rooms."""

    def __init__(self, folder: Path) -> None:
        lines = (folder / "map.yaml").read_text().splitlines()
        told = dict(line.split(": ", 1) for line in lines)
        self.cell_m = float(told["resolution"])
        self.origin_m = np.array(json.loads(told["origin"])[:2])
        _, size, _, data = (folder / "map.pgm").read_bytes().split(b"\n", 3)
        width, height = map(int, size.split())
        # The first row of the picture is the northernmost.
        self.free = np.frombuffer(data, np.uint8).reshape(height, width)[::-1] == FREE
        self.rooms = json.loads((folder / "rooms.json").read_text(encoding="utf-8"))
        self.spawns = json.loads((folder / "spawns.json").read_text(encoding="utf-8"))["rooms"]

    def cell(self, at_m: np.ndarray) -> tuple[int, int]:
        """Row, from the south, and column of a point."""
        column, row = np.floor((at_m - self.origin_m) / self.cell_m).astype(int)
        return int(row), int(column)

    def middle(self, cell: tuple[int, int]) -> np.ndarray:
        """The point in the middle of a cell."""
        return self.origin_m + (np.array(cell[::-1]) + 0.5) * self.cell_m

    def start(self) -> np.ndarray:
        """Inside the front door."""
        door = next(one for one in self.rooms["doors"] if one["id"] == self.rooms["entrance"])
        across = np.array([math.cos(door["yaw"]), math.sin(door["yaw"])]) * PAST_DOOR_M
        at = np.array([door["x"], door["y"]])
        first = next(iter(self.spawns[door["rooms"][0]]))
        inside = np.array([first["x"], first["y"]]) - at
        return at + across * (1.0 if across @ inside > 0.0 else -1.0)

    def goal(self, near_m: np.ndarray | None) -> np.ndarray:
        """A free pose of the kitchen, the nearest to something there."""
        room = next(one["id"] for one in self.rooms["rooms"] if one["class"] == "kitchen")
        poses = [np.array([pose["x"], pose["y"]]) for pose in self.spawns[room]]
        if near_m is None:
            return poses[0]
        # Not before the door that opens.
        away = [pose for pose in poses if np.linalg.norm(pose - near_m) > 1.0]
        return min(away or poses, key=lambda pose: float(np.linalg.norm(pose - near_m)))

    def _room_m(self) -> np.ndarray:
        """Of each cell, how far from everything it is."""
        distance: np.ndarray = ndimage.distance_transform_edt(np.pad(self.free, 1))[1:-1, 1:-1]
        return distance * self.cell_m

    def leads(self, start_m: np.ndarray, goal_m: np.ndarray) -> bool:
        """Whether there is a way."""
        able = _passes(self._room_m(), self.cell_m)
        parts, _ = ndimage.label(able, np.ones((3, 3)))
        first, last = _nearest(able, self.cell(start_m)), _nearest(able, self.cell(goal_m))
        return bool(parts[first] == parts[last])

    def draw(self, corners_m: np.ndarray) -> None:
        """Note that a quadrangle, (4, 2), is in the way."""
        self.free = self.free.copy()
        for share in np.linspace(0.0, 1.0, 40):
            for one, other in (corners_m[:2], corners_m[2:][::-1]):
                row, column = self.cell(one + share * (other - one))
                if 0 <= row < self.free.shape[0] and 0 <= column < self.free.shape[1]:
                    self.free[row, column] = False

    def way(self, start_m: np.ndarray, goal_m: np.ndarray) -> np.ndarray:
        """(N, 2) points from start to goal, off what is in the way."""
        room_m = self._room_m()
        able = _passes(room_m, self.cell_m)
        dear = 1.0 + 2.0 * np.clip(0.5 - room_m, 0.0, None) / 0.5
        first, last = _nearest(able, self.cell(start_m)), _nearest(able, self.cell(goal_m))
        steps = [(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]
        cost, came = {first: 0.0}, {first: first}
        queue = [(0.0, first)]
        while queue:
            so_far, cell = heapq.heappop(queue)
            if cell == last:
                break
            if so_far > cost[cell]:
                continue
            for row, column in steps:
                there = cell[0] + row, cell[1] + column
                if not (0 <= there[0] < able.shape[0] and 0 <= there[1] < able.shape[1]):
                    continue
                price = so_far + math.hypot(row, column) * float(dear[there])
                if able[there] and price < cost.get(there, math.inf):
                    cost[there], came[there] = price, cell
                    heapq.heappush(queue, (price, there))
        if last not in came:
            raise SystemExit("error: no way from the entrance to the kitchen is wide enough")
        cells = [last]
        while cells[-1] != first:
            cells.append(came[cells[-1]])
        return np.array([self.middle(cell) for cell in cells[::-1]])


def _passes(room_m: np.ndarray, cell_m: float) -> np.ndarray:
    """Which cells the robot's middle may be in."""
    return room_m > RADIUS_M + cell_m / 2


def _nearest(able: np.ndarray, cell: tuple[int, int]) -> tuple[int, int]:
    cells = np.argwhere(able)
    row, column = cells[np.argmin(np.linalg.norm(cells - np.array(cell), axis=1))]
    return int(row), int(column)


class House:
    """The model with the robot in it."""

    def __init__(self, folder: Path) -> None:
        spec = mujoco.MjSpec.from_file(str(folder / "model.xml"))
        robot = mujoco.MjSpec.from_string(ROBOT)
        spec.worldbody.add_frame().attach_body(robot.body("base"), "robot.", "")
        classes = {text.name: text.data for text in spec.texts}
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.held: dict[int, float] = {}
        """Joints that are moved from outside, by number, and where they are."""
        for number in range(self.model.njnt):
            name = self.model.joint(number).name
            if classes.get(name.rsplit(".", 1)[0]) == "door":
                low, high = self.model.jnt_range[number]
                self.held[number] = float(low if -low > high else high)
        self.fridge = next((name for name, one in classes.items() if one == "refrigerator"), None)
        self._hold()
        mujoco.mj_forward(self.model, self.data)

    def _hold(self) -> None:
        for number, angle in self.held.items():
            self.data.qpos[self.model.jnt_qposadr[number]] = angle
            self.data.qvel[self.model.jnt_dofadr[number]] = 0.0

    def step(self) -> None:
        """One step of time."""
        self._hold()
        mujoco.mj_step(self.model, self.data)

    def leaf(self, joint: int) -> list[np.ndarray]:
        """(4, 2) corners, seen from above, of what turns on a joint."""
        found = []
        signs = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
        body = self.model.jnt_bodyid[joint]
        for geom in np.flatnonzero(self.model.geom_bodyid == body):
            if self.model.geom_contype[geom]:
                turn = self.data.geom_xmat[geom].reshape(3, 3)
                corners = (signs * self.model.geom_size[geom]) @ turn.T
                found.append((self.data.geom_xpos[geom] + corners)[:, :2])
        return found

    def shut(self, joint: int) -> None:
        """Keep a door shut."""
        self.held[joint] = 0.0
        self._hold()
        mujoco.mj_forward(self.model, self.data)

    def fridge_door(self) -> int | None:
        """The joint of the refrigerator that turns furthest."""
        if self.fridge is None:
            return None
        hinges = [
            number
            for number in range(self.model.njnt)
            if self.model.joint(number).name.startswith(f"{self.fridge}.")
            and self.model.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
        ]
        return max(hinges, key=lambda one: np.abs(self.model.jnt_range[one]).max(), default=None)

    def put(self, at_m: np.ndarray, towards_m: np.ndarray) -> None:
        """Put the robot somewhere."""
        yaw = math.atan2(*(towards_m - at_m)[::-1])
        pose = [*at_m, 0.002, math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
        self.data.joint("robot.base").qpos = pose

    def drive(self, way_m: np.ndarray, most_s: float) -> float:
        """Follow a way; how far from its end the robot stops."""
        ends = self.data.time + most_s
        passed = 0
        while self.data.time < ends:
            pose = self.data.body("robot.base")
            at, ahead = pose.xpos[:2], pose.xmat.reshape(3, 3)[:2, 0]
            off = float(np.linalg.norm(way_m[-1] - at))
            if off < THERE_M:
                break
            while passed < len(way_m) - 1 and np.linalg.norm(way_m[passed] - at) < LOOK_AHEAD_M:
                passed += 1
            wanted = way_m[passed] - at
            turn = math.atan2(ahead[0] * wanted[1] - ahead[1] * wanted[0], float(ahead @ wanted))
            # Turns on the spot before it drives off.
            forward = SPEED_M_PER_S * max(math.cos(turn), 0.0) * min(1.0, off / 0.4 + 0.2)
            sideways = float(np.clip(2.5 * turn, -2.0, 2.0)) * TRACK_M / 2
            self.data.actuator("robot.left").ctrl = (forward - sideways) / WHEEL_M
            self.data.actuator("robot.right").ctrl = (forward + sideways) / WHEEL_M
            self.step()
        self.data.ctrl[:] = 0.0
        return float(np.linalg.norm(way_m[-1] - self.data.body("robot.base").xpos[:2]))

    def pull(self, joint: int) -> float:
        """Pull a leaf at its free edge until it is open or OPENING_S have passed.

        The force is PULL_N, square to the leaf. Returns the angle that is reached, in degrees.
        """
        low, high = self.model.jnt_range[joint]
        far = float(low if -low > high else high)
        body = int(self.model.jnt_bodyid[joint])
        handle = self._free_edge(joint)
        address = self.model.jnt_qposadr[joint]
        begun = self.data.time
        while self.data.time < begun + OPENING_S and abs(self.data.qpos[address]) < 0.95 * abs(far):
            turn = self.data.xmat[body].reshape(3, 3)
            at = self.data.xpos[body] + turn @ handle
            arm = at - self.data.xanchor[joint]
            way = np.cross(self.data.xaxis[joint], arm) * np.sign(far)
            force = PULL_N * way / np.linalg.norm(way)
            self.data.qfrc_applied[:] = 0.0
            mujoco.mj_applyFT(self.model, self.data, force, np.zeros(3), at, body,
                              self.data.qfrc_applied)  # fmt: skip
            self.step()
        self.data.qfrc_applied[:] = 0.0
        return math.degrees(self.data.qpos[address])

    def _free_edge(self, joint: int) -> np.ndarray:
        """(3,) in the frame of a leaf: where its handle is, farthest from the hinge."""
        body = int(self.model.jnt_bodyid[joint])
        turn, axis = self.data.xmat[body].reshape(3, 3), self.data.xaxis[joint]
        places = [self.data.geom_xpos[geom] + side * self.data.geom_xmat[geom].reshape(3, 3)[:, way]
                  * self.model.geom_size[geom][way]
                  for geom in np.flatnonzero(self.model.geom_bodyid == body)
                  if self.model.geom_contype[geom]
                  for way in range(3) for side in (-1.0, 1.0)]  # fmt: skip
        arms = [place - self.data.xanchor[joint] for place in places]
        reach = [float(np.linalg.norm(arm - (arm @ axis) * axis)) for arm in arms]
        return np.asarray(turn.T @ (places[int(np.argmax(reach))] - self.data.xpos[body]))


def run(stage: Path, folder: Path) -> Errand:
    """Export the stage into a folder, drive, open."""
    export_stage(stage, folder / "map", "ros")
    export_stage(stage, folder / "model", "mujoco")
    plan, house = Map(folder / "map"), House(folder / "model")
    door = house.fridge_door()
    near: Any = house.data.body(house.fridge).xpos[:2] if house.fridge else None
    start, goal = plan.start(), plan.goal(near)
    for joint in house.held:
        without = plan.free
        for corners in house.leaf(joint):
            plan.draw(corners)
        if not plan.leads(start, goal):  # one leaf of two may stand in the only way when it is open
            plan.free = without
            house.shut(joint)
            for corners in house.leaf(joint):
                plan.draw(corners)
    way = plan.way(start, goal)
    length = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
    house.put(way[0], way[min(4, len(way) - 1)])
    off = house.drive(way, most_s=10.0 + 4.0 * length / SPEED_M_PER_S)
    driven = float(house.data.time)
    return Errand(length, off, driven, house.pull(door) if door is not None else 0.0)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        went = run(Path(sys.argv[1]), Path(scratch))
    sys.stdout.write(
        f"drove {went.way_m:.1f} m in {went.seconds:.0f} s, {100 * went.off_m:.0f} cm off; "
        f"a pull of {PULL_N:.0f} N opens the refrigerator by {abs(went.opened_deg):.0f} degrees\n"
    )
