"""New furniture and dressing for one room of a written stage; every other opinion stays as it is,
byte for byte.

The stage's own layer is edited and not rewritten, so that what an artist has changed elsewhere,
looks chosen and lights moved, survives.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from pxr import Sdf, UsdUtils

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.archives import Archive
from chord_usd.base.runtime.files import Copies, deliver, destination, hash_file
from chord_usd.base.runtime.house_history import Deed, recorded
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.stages import (
    ELEVATION,
    open_layer,
    own_files,
    reading,
)
from chord_usd.base.scene.articulation import FIXED
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.states import LIT
from chord_usd.base.scene.styles import style_named
from chord_usd.base.scene.types import Item, Provenance, Room, StageFile
from chord_usd.line.stage.author.attribution import write_attribution
from chord_usd.line.stage.author.author_stage import ARCHIVE_TIME_S
from chord_usd.line.stage.author.design_notes import forget_design
from chord_usd.line.stage.author.furniture import (
    DRESSING,
    FURNITURE,
    ITEMS,
    JOINTS,
    place_dressing,
    place_furniture,
)
from chord_usd.line.stage.author.lighting import (
    MOODS,
    forget,
    hang_lamps,
    light_name,
    shine,
    variants_of,
)
from chord_usd.line.stage.author.names import REQUESTS, NamedRoom, name_items
from chord_usd.line.stage.author.prims import Types, attribute, note
from chord_usd.line.stage.author.stage_levels import STOREY, room_spec, room_specs
from chord_usd.line.stage.author.variants import Wardrobe
from chord_usd.line.stage.edit.staged_house import SEED
from chord_usd.line.stage.export.packages import (
    Packages,
    is_copy,
    prop_beside,
    share_pictures,
)
from chord_usd.line.stage.read.leaf_states import STATE
from chord_usd.line.stage.views.cameras import clear_camera

CHECKPOINT = "chord:checkpoint_hash"


def require_furniture(path: Path, room_name: str) -> None:
    """Raises StageError where a room's furniture is in another layer, which is not written."""
    layer = open_layer(path)  # what it holds lives as long as it does
    room = room_spec(layer, room_name)
    if not room or FURNITURE not in room.nameChildren:
        raise StageError(
            f"the furniture of {room_name!r} is not in this layer",
            where=str(path),
            expected="the stage as chord-usd wrote it, not one that refers to it",
            try_="<edits>",
        )


@dataclass(frozen=True, eq=False)
class NewFurniture:
    """What a room gets."""

    room_name: str
    """Name of the room's prim."""
    room: Room
    items: Sequence[Item]
    """Posed in the world, as in the scene graph."""
    made: Provenance
    dressing: Sequence[Item] = ()
    """Of a house that is dressed; others stay undressed."""
    kept: Sequence[str] = ()
    """Names of the room's prims that stay as they are."""
    style: str = ""
    """Name of the style it is furnished in; "" for none."""
    home_seed: int = 0
    """Seed of the house, by which its rooms agree."""
    requests: str | None = None
    """Pieces that the room must and must not hold, in words; None leaves them as they are."""


EditLayer = Callable[[Path, Sequence[Path]], Sdf.Layer]
"""Edits the layer at a path and saves it, given the folders that hold what it points to."""


def refurnish(source: Path, target: Path, new: NewFurniture) -> StageFile:
    """Write source to target with one room's furniture taken out and new furniture put in.

    As rewrite does it, and with its errors.
    """
    require_furniture(source, new.room_name)
    deed = Deed("regenerate", new.room_name)
    return rewrite(
        source, target, lambda path, finals: furnish_layer(path, finals, new), new.made, deed
    )


def rewrite(
    source: Path,
    target: Path,
    edit: EditLayer,
    made: Provenance,
    deed: Deed,
    accept: Callable[[Path], None] | None = None,
) -> StageFile:
    """Write source to target with its own layer edited, and note the deed in target's history.

    target may be source itself; elsewhere, everything the stage points to is copied beside it.
    accept: looks at the stage, whole, before it is delivered, and raises what speaks against it.
    Nothing is left behind on failure. Raises StageError for a stage that chord-usd did not write,
    AssetError, OutputError.
    """
    if source.suffix != target.suffix and ".usdz" in (source.suffix, target.suffix):
        raise StageError(
            f"cannot become a {target.suffix}",
            where=str(source),
            expected=f"-o with the suffix {source.suffix}",
        )
    _require_own(source, target)
    with reading(source), recorded(target, deed), deliver() as delivery:
        staged = delivery.place(target)
        if source.suffix == ".usdz":
            _edit_archive(source, staged, target, edit)
        else:
            final = destination(target.parent)
            if final != absolute(source).parent:
                _copy_what_it_points_to(source, staged, target)
            _copy_layer(source, staged)
            layer = edit(staged, [final, staged.parent])
            write_attribution(layer, (staged.parent, final), staged, target)
        if accept:
            with _whole(staged, target) as seen:
                accept(seen)
        content_hash = hash_file(staged)
    layer = Sdf.Layer.Find(str(target))
    if layer:
        layer.Reload()
    return StageFile(target, content_hash, made)


@contextmanager
def _whole(staged: Path, target: Path) -> Iterator[Path]:
    """A stage on its way as it will be seen: in a folder with links to what lies there already."""
    home = destination(target.parent)
    if staged.suffix == ".usdz":
        yield staged
        return
    with tempfile.TemporaryDirectory(prefix="chord-usd-") as scratch:
        folder = Path(scratch)
        for at in (staged.parent, home):
            for entry in at.iterdir():
                _link(entry, folder / entry.name)
        yield folder / staged.name


def _link(source: Path, link: Path) -> None:
    """A link to a file or folder; of folders that two places have, one to each thing in them."""
    if not os.path.lexists(link):
        link.symlink_to(absolute(source))
    elif source.is_dir() and link.is_dir():
        if link.is_symlink():
            first = link.readlink()
            link.unlink()
            link.mkdir()
            for inner in first.iterdir():
                _link(inner, link / inner.name)
        for inner in source.iterdir():
            _link(inner, link / inner.name)


def _require_own(source: Path, target: Path) -> None:
    """Raises StageError for a stage with files elsewhere, where more than its layer is written."""
    if source.suffix == ".usdz" or absolute(target).parent != absolute(source).parent:
        own_files(source)


def _copy_layer(source: Path, staged: Path) -> None:
    """The root layer under its new name; an identifier that is its file name follows."""
    shutil.copyfile(source, staged)
    if source.name == staged.name:
        return
    layer = open_layer(staged)
    root = layer.GetPrimAtPath(f"/{layer.defaultPrim}")
    info = dict(root.GetInfo("assetInfo")) if root and root.HasInfo("assetInfo") else {}
    if info.get("identifier") == Sdf.AssetPath(f"./{source.name}"):
        info["identifier"] = Sdf.AssetPath(f"./{staged.name}")
        root.SetInfo("assetInfo", info)
        layer.Save()


def _copy_what_it_points_to(source: Path, staged: Path, target: Path) -> None:
    """Layers and textures of a stage, at the same places relative to another folder.

    Raises StageError where another file lies at such a place, which may be another house's.
    """
    home, final = absolute(source).parent, destination(target.parent)
    files = own_files(source)
    props = [file for layer in files.layers[1:] for file in prop_beside(layer)]
    copies = Copies()
    for file in (*files.layers[1:], *files.others, *props):
        name = file.relative_to(home)
        place, there = staged.parent / name, final / name
        is_of_target = name.parts[0] in (target.name, f"{target.stem}_architecture")
        if not is_of_target and os.path.lexists(there) and not is_copy(file, there):
            raise StageError(
                f"needs {name}, and another file lies there already",
                where=str(source),
                expected=f"an output folder without another {name.parts[0]}",
                try_="-o in an empty folder",
            )
        copies.add(file, place)


def _edit_archive(source: Path, staged: Path, target: Path, edit: EditLayer) -> None:
    """Unpack, edit the root layer, which is an archive's first file, and pack again."""
    with tempfile.TemporaryDirectory(dir=staged.parent) as scratch:
        folder = Path(scratch)
        with Archive(source, StageError, expected="a .usdz package") as archive:
            archive.require_package()
            archive.unpack(folder)
            root = folder / archive.names[0]
        layer = edit(root, [root.parent])
        write_attribution(layer, (root.parent,), staged, target)
        for file in folder.rglob("*"):
            os.utime(file, (ARCHIVE_TIME_S, ARCHIVE_TIME_S))
        # Unpacked, its files lie where a package's files cannot: check again before packing.
        own_files(root, source)
        share_pictures(root.parent / "assets")
        UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(root)), str(staged))


def furnish_layer(path: Path, finals: Sequence[Path], new: NewFurniture) -> Sdf.Layer:
    """Give a room of the layer at path its new furniture.

    finals: the folders that hold what it points to.
    """
    layer = open_layer(path)
    room = room_spec(layer, new.room_name)
    assert room, "refurnish looks for it"
    furniture, dressing = (room.nameChildren.get(name) for name in (FURNITURE, DRESSING))
    for group in (furniture, dressing):
        for name in list(group.nameChildren.keys()) if group else ():
            if name not in new.kept:
                del group.nameChildren[name]
    _untie(layer, room)
    taken = _names_of_things(layer)
    items, hung = (name_items(things, taken) for things in (new.items, new.dressing))
    group = room.nameParent.name if room.nameParent.name.startswith(STOREY) else ""
    named = NamedRoom(0, new.room_name, new.room, items, (), hung, group)
    with tempfile.TemporaryDirectory(dir=path.parent) as scratch:
        style = style_named(new.style, new.home_seed) if new.style else None
        home = style.agreed(new.home_seed) if style else None
        noted = layer.customLayerData.get("chord", {})
        articulation = str(noted.get("articulation", FIXED))
        wardrobe = Wardrobe(new.made.seed, style, home, articulation)
        packages = Packages(path.parent, finals, "assets")
        place_furniture(layer, named, packages, Path(scratch), wardrobe)
        if dressing or hung:
            place_dressing(layer, named, packages, Path(scratch), wardrobe)
    _light_lamps(layer, room.path, finals)
    if new.made.checkpoint_hash:  # nothing else was drawn
        _note_making(furniture, new.made)
    if new.requests is not None and (new.requests or REQUESTS in furniture.attributes):
        note(furniture, requests=new.requests)
    noted = room.nameParent.attributes.get(ELEVATION)
    floor_m = float(noted.default) if noted else 0.0
    standing = [*new.items, *new.dressing]
    clear_camera(layer, new.room_name, room_polygon(new.room), standing, floor_m)
    if new.items:  # a lock changes no rule
        forget_design(layer, [new.room_name])
    layer.Save()
    return layer


def _names_of_things(layer: Sdf.Layer) -> set[str]:
    """Names of what stands and hangs in all rooms, and of what stands on it."""
    groups = [room.nameChildren.get(name) for room in room_specs(layer)
              for name in (FURNITURE, DRESSING)]  # fmt: skip
    things = [thing for group in groups if group for thing in group.nameChildren]
    carried = [thing.nameChildren.get(ITEMS) for thing in things]
    return {spec.name for spec in (*things, *(c for on in carried if on for c in on.nameChildren))}


def _untie(layer: Sdf.Layer, room: Sdf.PrimSpec) -> None:
    """Remove the joints of a room whose ends are gone."""
    joints = room.nameChildren.get(JOINTS)
    for joint in list(joints.nameChildren) if joints else ():
        ends = [
            end
            for relation in joint.relationships
            for end in relation.targetPathList.prependedItems
        ]
        if not all(layer.GetPrimAtPath(end) for end in ends):
            del joints.nameChildren[joint.name]


def _light_lamps(layer: Sdf.Layer, room: Sdf.Path, folders: Sequence[Path]) -> None:
    """Let the lamps that the room has now shine, and no others."""
    house, scope = (layer.GetPrimAtPath(p) for p in ("/House", room.AppendChild("Lights")))
    variants = variants_of(house)
    if not scope or not variants:
        return
    gone = [light for light in scope.nameChildren if light.typeName == "SphereLight"]
    suffix = light_name("", room.name)  # which houses of earlier versions lack
    given = {
        light.name.removesuffix(suffix): light.attributes[STATE].default
        for light in gone
        if STATE in light.attributes
    }
    forget(house, [light.path for light in gone])
    for name in [light.name for light in gone]:
        del scope.nameChildren[name]
    lamps = hang_lamps(layer, str(room), folders)
    for lamp in lamps:
        state = given.get(lamp.path.name.removesuffix(suffix))
        if state is not None:  # a lamp of this name keeps what somebody gave it
            give_light(layer.GetPrimAtPath(lamp.path), state, lamp.intensity)
    for time, variant in variants.items():
        shine(variant, lamps, MOODS[time])


def give_light(light: Sdf.PrimSpec, state: str, intensity: float) -> None:
    """Say that a light is on or off at every time of day. intensity: fully on."""
    attribute(light, "inputs:intensity", Types.Float, intensity if LIT[state] else 0.0)
    note(light, state=state)


def _note_making(furniture: Sdf.PrimSpec, made: Provenance) -> None:
    for name, type_, value in (
        (SEED, Types.Int, made.seed),
        (CHECKPOINT, Types.String, made.checkpoint_hash),
    ):
        if name in furniture.attributes:
            furniture.attributes[name].default = value
        else:
            attribute(furniture, name, type_, value, custom=True)
