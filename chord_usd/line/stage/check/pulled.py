"""Every joint of a house pulled alone, by force, in MuJoCo: an engine judges swept volumes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Sdf, Usd

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.runtime.stages import open_stage, reading
from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.line.stage.export.exchange.mjcf_frames import dotted
from chord_usd.line.stage.export.exchange.mjcf_model import MODEL_FILE, write_mjcf

if TYPE_CHECKING:
    from chord_usd.line.stage.check.check_openables import Opens

TORQUE_N_M, FORCE_N = 30.0, 80.0
"""A hand on a handle: of hinges, and of slides (shared design: robots, by force)."""

PULL_S = 1.6
OPEN_SHARE = 0.9
"""Share of its range from which a joint counts as open."""

STUCK_SHARE = 0.5
"""Share below which a joint is of no use."""


@dataclass(frozen=True)
class Pulled:
    """How far one joint opens by force."""

    path: str
    """Of the body that it moves, in the variant `jointed`."""
    share: float
    """Of its range, [0, 1]."""

    @property
    def is_open(self) -> bool:
        """Whether it reaches OPEN_SHARE."""
        return self.share >= OPEN_SHARE

    @property
    def is_stuck(self) -> bool:
        """Whether it stays below STUCK_SHARE."""
        return self.share < STUCK_SHARE


def pull_joints(file: Path) -> tuple[Pulled, ...]:
    """Each hinge and slide of a house with all furniture jointed, pulled alone for PULL_S.

    Variants are selected in memory: the file stays as it is. Raises StageError for a file that
    cannot be opened, MissingExtraError without MuJoCo.
    """
    with needed_for("opening what can be opened, by force,"):
        import mujoco
    with scratch_folder() as folder, reading(file):
        stage = open_stage(file)
        _select_jointed(stage)
        write_mjcf(stage, folder)
        paths = {dotted(prim.GetPath()): str(prim.GetPath()) for prim in stage.TraverseAll()}
        model = mujoco.MjModel.from_xml_path(str(folder / MODEL_FILE))
    return tuple(Pulled(paths.get(name, name), share) for name, share in shares(model))


def _select_jointed(stage: Usd.Stage) -> None:
    """Variant selections in the session layer."""
    stage.SetEditTarget(stage.GetSessionLayer())
    with Sdf.ChangeBlock():
        pieces = [
            prim for prim in stage.Traverse() if prim.GetVariantSets().HasVariantSet(ARTICULATION)
        ]
    for piece in pieces:
        piece.GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)


def shares(model: Any, only: str = "") -> Iterator[tuple[str, float]]:
    """Names of bodies, and the share of its range that the joint of each opens.

    only: bodies whose name holds this.
    """
    import mujoco

    pulls = {
        int(mujoco.mjtJoint.mjJNT_HINGE): TORQUE_N_M,
        int(mujoco.mjtJoint.mjJNT_SLIDE): FORCE_N,
    }
    for joint in range(model.njnt):
        name = model.body(model.jnt_bodyid[joint]).name
        pull = pulls.get(int(model.jnt_type[joint]))
        if pull is None or only not in name:
            continue
        yield name, _share(mujoco, model, joint, pull)


def _share(mujoco: Any, model: Any, joint: int, pull: float) -> float:
    """The widest share of its range that one joint reaches, from rest."""
    low, high = model.jnt_range[joint]
    widest = low if abs(low) > abs(high) else high
    data = mujoco.MjData(model)
    share = 0.0
    while data.time < PULL_S and share < OPEN_SHARE:
        data.qfrc_applied[model.jnt_dofadr[joint]] = np.sign(widest) * pull
        mujoco.mj_step(model, data)
        share = max(share, float(data.qpos[model.jnt_qposadr[joint]] / widest))
    return round(share, 3)


def contradictions(opens: Iterable[Opens], pulled: Sequence[Pulled]) -> list[str]:
    """Leaves that geometry and force judge differently, a line each."""
    by_force = {pull.path: pull for pull in pulled}
    lines = []
    for leaf in opens:
        pull = by_force.get(leaf.path)
        if pull is not None and pull.is_open != leaf.is_free:
            lines.append(
                f"{leaf.path} opens {leaf.free} by its swept volume, {pull.share:.0%} by force"
            )
    return lines
