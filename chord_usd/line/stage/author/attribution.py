"""Who made the pieces and skies of a house: many licences ask for the name beside the work.

Components and skies keep the licence and the author that their library states. What is drawn here
asks for nothing, so only a house with work by others has a text file `NAME_attribution.txt` beside
it; beside an archive too, which may hold nothing but what USD reads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from pxr import Sdf

from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.credits import AUTHOR

_UNKNOWN = "not told"


def attribution_file(stage: Path) -> Path:
    """Where the names of the makers stand."""
    return stage.with_name(f"{stage.stem}_attribution.txt")


def write_attribution(layer: Sdf.Layer, folders: Sequence[Path], staged: Path, final: Path) -> None:
    """Write the names of those who made the house's pieces, if others than this program did.

    folders: where the packages that the layer refers to are. staged: the stage being written.
    final: what it becomes; names that stand beside it already are written again.
    """
    made, skies = sorted(_made_by_others(layer, folders)), sorted(_skies(layer))
    if made or skies or attribution_file(final).exists():
        lines = made or ["All pieces were drawn by this program and are free to use."]
        sky_lines = ["", f"Skies over {final.name}", "", *skies] if skies else []
        text = "\n".join([f"Furniture in {final.name}", "", *lines, *sky_lines, ""])
        attribution_file(staged).write_text(text, encoding="utf-8")


def _made_by_others(layer: Sdf.Layer, folders: Sequence[Path]) -> Iterator[str]:
    """A line for each component that has another author."""
    roots = [folder.resolve() for folder in folders]
    for path in _referred_to(layer):
        source = next((folder / path for folder in roots if _holds(folder, path)), None)
        component = open_layer(source) if source else None
        root = component.GetPrimAtPath(f"/{component.defaultPrim}") if component else None
        facts = root.customData.get("chord", {}) if root else {}
        if root and facts and facts.get("author") != AUTHOR:
            author, licence = (facts.get(key) or _UNKNOWN for key in ("author", "licence"))
            yield f"{facts.get('label') or root.name} ({path}): author {author}, licence {licence}"


def _skies(layer: Sdf.Layer) -> set[str]:
    """A line for each picture of a sky, in any choice of the house's lighting."""
    lines: set[str] = set()

    def visit(path: Sdf.Path) -> None:
        prim = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
        if prim and prim.typeName == "DomeLight" and "chord" in prim.customData:
            facts = prim.customData["chord"]
            author, licence = (facts.get(key) or _UNKNOWN for key in ("author", "licence"))
            file = prim.attributes["inputs:texture:file"].default.path.removeprefix("./")
            lines.add(f"{facts.get('label')} ({file}): author {author}, licence {licence}")

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return lines


def _holds(folder: Path, path: str) -> bool:
    """Whether the folder, whose path is resolved, holds this file; one that lies elsewhere is
    nobody's business here."""
    place = (folder / path).resolve()
    return place.is_file() and place.is_relative_to(folder)


def _referred_to(layer: Sdf.Layer) -> set[str]:
    """Paths of all references of a layer."""
    paths: set[str] = set()

    def visit(path: Sdf.Path) -> None:
        prim = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
        if prim:
            references = prim.referenceList.prependedItems
            paths.update(
                reference.assetPath.removeprefix("./")
                for reference in references
                if reference.assetPath
            )

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return paths
