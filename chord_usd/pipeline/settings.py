"""What a user can choose about a house."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.scene.articulation import FIXED

if TYPE_CHECKING:
    from chord_usd.lists.wishes import Wishes
    from chord_usd.plan.corrections import RoomSaid


@dataclass(frozen=True)
class Settings:
    """What a user can choose about a house."""

    seed: int = 0
    """Same plan, same seed, same settings: same bytes."""
    steps: int | None = None
    """Sampler steps; None takes what the checkpoint was tuned for."""
    sampler: str | None = None
    """ddim, dpm or ddpm (layout.schedule); None takes the checkpoint's own."""
    m_per_px: float | None = None
    """Scale of a plan picture; None measures it."""
    part: int = 1
    """Which plan of a sheet, by floor area, or storey of a file, by rooms with doors."""
    device: str = "auto"
    """auto, cpu or cuda."""
    asset_folders: tuple[Path, ...] = ()
    """Folders of further meshes, tried beside the shipped ones."""
    tabletop: bool = True
    """Whether tables, desks and worktops are laid."""
    dressing: bool = True
    """Whether walls, windows, ceilings, floors, shelves and beds are dressed."""
    style: str = "mixed"
    """Name of a style (scene.styles); `mixed` takes one of them by seed; "" keeps the one that a
    scene or a stage notes, and takes one by seed where none is noted."""
    texture_px: int = 1024
    """Side of the textures of floors and walls, 256 to 4096; furniture has half of it."""
    sky: str = ""
    """Name of a sky or an HDRI's file; "" for the sky of the time of day."""
    articulation: str = FIXED
    """`jointed` where doors and drawers of furniture open (scene.articulation)."""
    lists: bool = True
    """Whether a list of pieces is drawn of each room before they are painted; without, the
    diffusion model alone decides what a room holds, as in the paper."""
    arrange: bool = True
    """Whether what is read is put right by rules, and what cannot be built is left out; without,
    everything stands as it is painted."""
    redraws: int = 2
    """So often a room with faults is drawn again; 0 leaves the first draw as it is."""
    furniture: tuple[tuple[str, Wishes], ...] = ()
    """What generate's rooms shall hold (lists.wishes.read_furniture)."""
    rooms: tuple[RoomSaid, ...] = ()
    """What a user says of rooms (plan.corrections.read_rooms)."""
