"""What a user can choose about a house."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.articulation import FIXED, JOINTED
from chord_usd.base.scene.limits import M_PER_PX, PARTS, REDRAWS, SEEDS, STEPS, TEXTURE_PX
from chord_usd.base.scene.roof_forms import NO_ROOF, ROOF_FORMS, RoofForm
from chord_usd.base.scene.styles import MIXED, style_named

if TYPE_CHECKING:
    from chord_usd.line.lists.wishes import Wishes
    from chord_usd.line.plan.corrections import RoomSaid


DEVICES = ("auto", "cpu", "cuda")


@dataclass(frozen=True)
class Settings:
    """What a user can choose about a house. Raises ChordError for a value out of its range."""

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
    roof: RoofForm = NO_ROOF
    """What the house can wear over its top storey (scene.roof_forms)."""
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

    def __post_init__(self) -> None:
        for name, least, most in (
            ("seed", *SEEDS), ("steps", *STEPS), ("part", *PARTS), ("redraws", *REDRAWS),
            ("texture_px", *TEXTURE_PX),
        ):  # fmt: skip
            value = getattr(self, name)
            whole = isinstance(value, int) and not isinstance(value, bool)
            if not (whole and least <= value <= most) and (name, value) != ("steps", None):
                raise _odd(name, value, f"a whole number from {least} to {most}")
        (least_m, most_m), scale = M_PER_PX, self.m_per_px
        real = isinstance(scale, int | float)
        if scale is not None and not (real and least_m <= scale <= most_m):
            raise _odd("m_per_px", self.m_per_px, f"{least_m:g} to {most_m:g} metres per pixel")
        for name, offered in (
            ("device", DEVICES),
            ("articulation", (FIXED, JOINTED)),
            ("roof", ROOF_FORMS),
        ):
            if getattr(self, name) not in offered:
                raise _odd(name, getattr(self, name), f"one of {', '.join(offered)}")
        if self.style not in ("", MIXED):
            style_named(self.style, self.seed)


def _odd(name: str, value: object, expected: str) -> ChordError:
    return ChordError(f"cannot be {repr(value)[:30]}", where=name, expected=expected)
