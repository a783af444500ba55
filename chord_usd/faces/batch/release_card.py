"""The card of a data set of houses: what data set hubs show of it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from chord_usd import __version__
from chord_usd.faces.batch.index import INDEX_FILE, PARQUET_FILE
from chord_usd.faces.batch.shared import SHARED_FOLDERS

if TYPE_CHECKING:
    from chord_usd.faces.batch.release import Release


def card(release: Release) -> str:
    """Markdown with the head that data set hubs read."""
    recipe = next((dict(record.recipe) for record in release.records.values()), {})
    settings = {
        key: value
        for key, value in sorted(recipe.items())
        if key not in ("procedural_plan", "seed", "checkpoints", "version", "asset_indexes")
    }
    parts = {name: len(part) for name, part in release.splits.items()}
    figures = "\n".join(f"| {words} | {release.figure(name):.3g} |" for words, name in _FIGURES)
    checkpoints = ", ".join(
        f"{name} `{digest[:12]}`" for name, digest in recipe.get("checkpoints", {}).items()
    )
    return _CARD.format(
        houses=len(release.records),
        holding=len(release.holding),
        size=_size_category(len(release.records)),
        train=parts["train"],
        test=parts["test"],
        hash=release.split_hash,
        figures=figures,
        megabytes=release.megabytes,
        version=__version__,
        checkpoints=checkpoints,
        settings=json.dumps(settings),
        shared=" and ".join(f"`{kind}/`" for kind in SHARED_FOLDERS),
        index=INDEX_FILE,
        parquet=PARQUET_FILE,
    )


_FIGURES = (
    ("rooms", "rooms"),
    ("pieces of furniture", "furniture"),
    ("furniture and what stands on it", "items"),
    ("dressing: curtains, lamps, pictures, plants, textiles", "dressing"),
    ("doors, windows and passages", "openings"),
    ("share of the floor that one can walk on", "walkable"),
    ("share of rooms reached from the entrance", "reachable_rooms"),
    ("share of rooms that hold what their kind needs", "complete"),
    ("share of rooms where, besides, nothing stands wrongly", "right"),
)
"""Figures of the card, and their names in a record; means over houses."""


def _size_category(houses: int) -> str:
    """As data set hubs name it."""
    steps = (1_000, 10_000, 100_000, 1_000_000)
    words = ("n<1K", "1K<n<10K", "10K<n<100K", "100K<n<1M")
    return next((word for step, word in zip(steps, words, strict=True) if houses < step), "n>1M")


_CARD = """\
---
pretty_name: Furnished houses of chord-usd
license: cc0-1.0
tags: [openusd, 3d, indoor, floor-plans, simulation, embodied-ai]
size_categories: [{size}]
---

# {houses} furnished houses

Procedural floor plans, furnished, dressed and lit by chord-usd {version}: hierarchical OpenUSD
stages (house > room > furniture > tabletop items) with physics, labels, cameras and an area light
per room, the plan and the layout each was made from, scene graphs and certificates. {holding} of
{houses} houses hold the certificate: the stage is valid, nothing collides, stands outside its
room, blocks a door or floats.

| mean of a house | |
|---|---|
{figures}

## Files

| path | what it is |
|---|---|
| `NAME/house.usda`, with what it points to | the stage, whole in itself |
| `NAME/plan.json`, `plan.png` | the floor plan |
| `NAME/layout.png` | the layout that the diffusion model painted |
| `NAME/scene.json` | the scene graph, CHOrD JSON |
| `NAME/house.json` | how it was made, the SHA-256 of every file, the certificate's figures |
| `NAME/pictures/`, where there are any | pictures of its cameras with annotations |
| {shared} | meshes and materials; the houses' own files are hard links to these |
| `{index}`, `{parquet}` | a row for each house and picture |
| `splits.json` | {train} train, {test} test: by the hash of the name; of the {holding} that hold |
| `statistics.json` | rooms and pieces by kind |
| `checksums.sha256` | for `sha256sum -c` |

```python
import json
from pxr import Usd

for name in json.load(open("splits.json"))["train"]:
    stage = Usd.Stage.Open(f"{{name}}/house.usda")
```

## How it was made

`chord-usd dataset release`, settings `{settings}`; house N stands on the procedural plan N and has
the seed N, so that the same command makes the same houses. Networks: {checkpoints}. A house takes
{megabytes:.1f} MB on disk. The hash of the splits is `{hash}`.

## Limits

The plans are drawn by rules, single-storey and mostly rectangular; the networks were trained on
plans of the same kind, so the test part measures what is learned from this data set, not the
networks that made it. Furniture comes from parametric families, in styles; nobody's home is
copied, and nobody appears.

## Licence

CC0-1.0, see LICENSE.txt. Cite the paper that the pipeline implements: Su et al., *CHOrD:
Generation of Collision-Free, House-Scale, and Organized Digital Twins for 3D Indoor Scenes with
Controllable Floor Plans and Optimal Layouts*, ICCV 2025.
"""
