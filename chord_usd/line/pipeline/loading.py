"""The networks and the mesh database that furnish houses, loaded as the settings say."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import content_hash
from chord_usd.base.scene.settings import OPTIONS, Settings
from chord_usd.base.scene.types import LayoutImage, Plan, SceneGraph

if TYPE_CHECKING:
    from chord_usd.library.database import AssetDatabase
    from chord_usd.line.graph.detect import ItemDetector
    from chord_usd.line.graph.tabletop import TopModel
    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.lists.list_sampler import ListDrawer

LAYOUT_CHECKPOINT = "plan2layout"
LISTS_CHECKPOINT = "lists"
TABLE_CHECKPOINT = "table"
THINGS_CHECKPOINT = "things"
DETECTOR_CHECKPOINT = "detector_items"


def load_model(settings: Settings) -> LayoutModel:
    """The layout model, with torch."""
    from chord_usd.line.layout.sample import LayoutModel

    return LayoutModel.load(checkpoint_folder(LAYOUT_CHECKPOINT), settings.device)


def load_table_model(settings: Settings) -> TopModel | None:
    """The model of what stands on tables; None where that is not wanted."""
    if not settings.tabletop:
        return None
    if settings.lists:
        from chord_usd.line.lists.things import load_lister

        return load_lister(checkpoint_folder(THINGS_CHECKPOINT))
    from chord_usd.line.graph.table_items import TopPainter
    from chord_usd.line.layout.sample import LayoutModel

    model = LayoutModel.load(checkpoint_folder(TABLE_CHECKPOINT), settings.device)
    sample = partial(model.sample_batch, sampler=settings.sampler)
    return TopPainter(sample, model.checkpoint.content_hash)


def load_reader(settings: Settings) -> GraphReader:
    """The detector and the mesh database, whose meshes are drawn when they are first needed."""
    from chord_usd.library.database import load_database
    from chord_usd.line.arrange.rules import RULES
    from chord_usd.line.graph.detect import load_item_detector

    without = frozenset() if settings.arrange else frozenset(rule.name for rule in RULES)
    database = load_database(settings.asset_folders, texture_px=settings.texture_px)
    return GraphReader(load_item_detector(), database, without)


@dataclass(frozen=True, eq=False)
class GraphReader:
    """What it takes to read a layout."""

    detector: ItemDetector
    database: AssetDatabase
    without: frozenset[str] = frozenset()
    """Names of rules that are left out."""

    def read(self, layout: LayoutImage, plan: Plan | None = None) -> SceneGraph:
        """LayoutImage -> SceneGraph, arranged and with meshes; without a plan, rooms are read,
        too."""
        from chord_usd.line.arrange.arrangement import Arrangement, Painted
        from chord_usd.line.arrange.rules import arrange
        from chord_usd.line.graph.colours import read_pixels
        from chord_usd.line.graph.extract import extract_graph
        from chord_usd.line.graph.match import match_assets

        pixels = read_pixels(layout.rgb)
        graph = extract_graph(layout, plan, self.detector, pixels=pixels)
        work = Arrangement.of(graph, painted=Painted(pixels.item, layout.frame))
        graph = arrange(work, "read", self.without)
        return match_assets(graph, self.database)


@dataclass(frozen=True, eq=False)
class Models:
    """What takes longest to load; it furnishes any number of houses."""

    layout: LayoutModel
    table: TopModel | None
    """Of what stands on tables; None where that is not wanted."""
    reader: GraphReader
    lists: ListDrawer | None = None
    """None where the layout model decides alone."""

    def in_style(self, name: str) -> Models:
        """The same, with meshes of this style before others."""
        database = self.reader.database.in_style(name)
        return replace(self, reader=replace(self.reader, database=database))


def checkpoints(settings: Settings) -> tuple[str, ...]:
    """Names of the checkpoints that decide what a house looks like."""
    of_tables = THINGS_CHECKPOINT if settings.lists else TABLE_CHECKPOINT
    table = (of_tables,) if settings.tabletop else ()
    lists = (LISTS_CHECKPOINT,) if settings.lists else ()
    return (LAYOUT_CHECKPOINT, DETECTOR_CHECKPOINT, *lists, *table)


def with_networks(graph: SceneGraph, settings: Settings) -> SceneGraph:
    """The graph that notes the content hash of each checkpoint that it was made with."""
    hashes = {name: content_hash(checkpoint_folder(name)) for name in checkpoints(settings)}
    made = graph.provenance
    configuration = {**made.configuration, "checkpoints": hashes}
    if settings.standard:
        configuration["standard"] = settings.standard
    return replace(graph, provenance=replace(made, configuration=configuration))


_kept: dict[Settings, Models] = {}
"""What a process that furnishes many houses has loaded, by the settings that decide of it."""


def keep_models(settings: Settings) -> None:
    """Load everything for good: whoever asks for the same is given it. For a process that waits
    for houses to come. Raises CheckpointError, AssetError."""
    _kept[_deciding(settings)] = load_models(settings)


def _deciding(settings: Settings) -> Settings:
    """The settings without those that have no say in what is loaded."""
    others = (option for option in OPTIONS.values() if not option.decides_models)
    return replace(settings, **{option.name: option.default for option in others})


def load_models(settings: Settings) -> Models:
    """Everything that furnishes a house. Raises CheckpointError, AssetError."""
    if kept := _kept.get(_deciding(settings)):
        return kept
    layout = load_model(settings)
    return Models(
        layout, load_table_model(settings), load_reader(settings), load_lists(settings, layout)
    )


def load_lists(settings: Settings, layout: LayoutModel) -> ListDrawer | None:
    """What decides which pieces rooms have; None where that is not wanted, or where the layout
    model was not trained to see it."""
    if not settings.lists or not layout.config.draft:
        return None
    from chord_usd.line.lists import list_sampler, pieces

    return list_sampler.load_lists(checkpoint_folder(LISTS_CHECKPOINT), pieces.PIECES)
