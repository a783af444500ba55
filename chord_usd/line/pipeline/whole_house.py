"""The line of the paper's figure 2: floor plans, the storeys of a house, become a furnished stage.

plan file -> Plan -> PlanImage -> LayoutImage -> SceneGraph -> StageFile

STEPS is the table of contents: each storey goes through it, the lowest first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.progress import Progress, Stopwatch
from chord_usd.base.scene.drawn_pieces import Placed
from chord_usd.base.scene.dwellings import is_common
from chord_usd.base.scene.estimates import Estimate, of_furnishing, of_stage
from chord_usd.base.scene.limits import MOST_JSON_BYTES, SEEDS
from chord_usd.base.scene.settings import Settings
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.storeys import Building, Storey, StoreyPlan, one_storey, storey_title
from chord_usd.base.scene.styles import MIXED, HomeStyle, style_named
from chord_usd.base.scene.types import LayoutImage, Plan, PlanImage, SceneGraph, StageFile
from chord_usd.line.pipeline import steps
from chord_usd.line.pipeline.as_drawn import hindering_left_out, parted, placed_pieces
from chord_usd.line.pipeline.loading import Models, load_models, with_networks
from chord_usd.line.pipeline.redraw import Draw, arrange_drawn
from chord_usd.line.pipeline.resample import Mended, Resampler, as_listed, listed_well, mend_rooms

if TYPE_CHECKING:
    from chord_usd.line.graph.tabletop import Tabletops
    from chord_usd.line.lists.wishes import Asked

_SEEDS_APART = 7919
"""Between the seeds of storeys."""


@dataclass(eq=False)
class FurnishedStorey:
    """A storey on its way through STEPS, and at their end."""

    storey: Storey
    file: Path
    """The plan was read from it: provenance notes its hash."""
    plan_image: PlanImage
    settings: Settings
    models: Models
    draw: Draw
    style: HomeStyle
    graph: SceneGraph
    """Without furniture at first; with objects on tables and dressing at the end."""
    layout: LayoutImage
    """Of the last sample; the plan's raster at first."""
    first_graph: SceneGraph
    first_layout: LayoutImage
    """Before rooms with faults are sampled again."""
    drawn: Sequence[Placed] = ()
    """The pieces that the plan's drawing shows."""
    listed: SceneGraph | None = None
    """The pieces of lists; None without lists."""
    listed_wrong: frozenset[str] = frozenset()
    """Ids of rooms that no list leaves right: they are sampled once more, not twice."""
    listed_again: frozenset[str] = frozenset()
    """Ids of rooms that hold a later list than the first."""
    mended: Mended | None = None
    tabletops: Tabletops | None = None

    @property
    def plan(self) -> Plan:
        """The plan, in the frame of the house."""
        return self.storey.plan

    @property
    def redrawn(self) -> tuple[str, ...]:
        """Ids of the rooms whose furniture is that of a later sample."""
        painted = self.mended.rooms if self.mended else ()
        return (*painted, *sorted(self.listed_again.difference(painted)))

    @property
    def left_out(self) -> tuple[str, ...]:
        """Ids of pieces of the layout that are not built: they overlap or block openings."""
        if self.mended is None:
            return ()
        built = {item.id for item in self.graph.items}
        later = (item.id for item in self.mended.graph.items if item.id not in built)
        return (*self.mended.left_out, *later)


@dataclass(frozen=True, eq=False)
class House:
    """Every artefact of one run."""

    building: Building
    storeys: tuple[FurnishedStorey, ...]
    """The lowest first."""
    stage: StageFile
    plan_limits: tuple[str, ...] = ()
    """What the plan cannot keep of the standard."""

    @property
    def ground(self) -> FurnishedStorey:
        """The lowest storey."""
        return self.storeys[0]

    @property
    def graphs(self) -> tuple[SceneGraph, ...]:
        """Of all storeys, the lowest first."""
        return tuple(made.graph for made in self.storeys)

    @property
    def verdict(self) -> str | None:
        """Of the plan that is most likely read wrong; None where none was read from a drawing."""
        read = [str(made.plan.extra.get("verdict")) for made in self.storeys]
        return next((verdict for verdict in ("wrong", "look", "right") if verdict in read), None)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of the stack of storeys and of their plans, each once."""
        read = (w for made in self.storeys for w in made.plan.extra.get("warnings", ()))
        every = (*self.building.warnings, *map(str, read), *self.plan_limits)
        return tuple(dict.fromkeys(every))


def generate(
    plans: Path | Sequence[Path],
    stage_path: Path,
    settings: Settings | None = None,
    stopwatch: Stopwatch | None = None,
    models: Models | None = None,
    *,
    every: bool = False,
) -> House:
    """Furnish plans, the storeys of a house, the lowest first, and write the stage.

    Args:
        plans: files: pictures, vector files or CHOrD JSON, of a storey or of several.
        models: those of earlier houses with the same settings, but for the seed; by default they
            are loaded.
        stopwatch: times plan, load, STEPS and stage.
        every: take all storeys that a file shows.

    Raises ChordError.
    """
    from chord_usd.base.metrics.design.standard import planning_to, standards_in

    settings, watch = settings or Settings(), stopwatch or Stopwatch()
    # Plans are read before networks are loaded: an invalid picture is reported within a second.
    with watch.step("plan"):
        files = [plans] if isinstance(plans, Path) else list(plans)
        building = _stacked(read_storeys(files, settings, every=every))
        files = [files[min(storey.index, len(files) - 1)] for storey in building.storeys]
        images = _checked(building, files, settings, watch)
        asked = _asked(building, settings)
        limits = steps.plan_limits([storey.plan for storey in building.storeys], settings)
    for line in limits:
        watch.announce(line)
    style = style_named(settings.style or MIXED, settings.seed)
    with watch.step("load"):
        models = (models or load_models(settings)).in_style(style.name)
        steps.load_usd()
    storeys = []
    with planning_to(standards_in(settings.standard)):
        for storey, file, image in zip(building.storeys, files, images, strict=True):
            made = _begun(storey, file, image, settings, models, style, asked)
            for name, step in _due(settings).items():
                with watch.step(name) as progress:
                    step(made, progress)
            storeys.append(made)
    with watch.step("stage"):
        stage = _write(building, storeys, stage_path, settings, style)
    return House(building, tuple(storeys), stage, tuple(limits))


def furnished(plan: Path, settings: Settings, models: Models) -> SceneGraph:
    """The lowest storey of a plan file as generate furnishes it, neither dressed nor written.

    Raises ChordError.
    """
    building = _stacked(read_storeys([plan], settings))
    images = _checked(building, [plan], settings, Stopwatch())
    style = style_named(settings.style or MIXED, settings.seed)
    made = _begun(
        building.storeys[0], plan, images[0], settings, models.in_style(style.name), style, {}
    )
    for name in ("list", "layout", "graph", "redraw", "settle"):
        STEPS[name](made, lambda done, total: None)
    return made.graph


def list_pieces(made: FurnishedStorey, _: Progress) -> None:
    """List the pieces of each room, the draft that the painter sees."""
    made.listed, made.listed_wrong, made.listed_again = listed_well(
        made.graph, made.plan.rooms, made.draw, made.settings.redraws
    )
    if made.listed is not None and made.draw.locked:
        made.draw, made.listed = made.draw.freed(made.listed)
        made.drawn = hindering_left_out(made.drawn, made.draw.locked)


def paint(made: FurnishedStorey, progress: Progress) -> None:
    """Sample the layout."""
    model, settings = made.models.layout, made.settings
    made.layout = made.first_layout = steps.draw_layout(
        made.plan, made.plan_image, model, made.file, settings, made.listed, progress
    )


def read(made: FurnishedStorey, _: Progress) -> None:
    """Read the layout as a scene graph, arranged by rules, with meshes."""
    graph = made.models.reader.read(made.layout, made.plan)
    made.graph = made.first_graph = made.draw.heeded(graph, made.listed)


def redraw(made: FurnishedStorey, progress: Progress) -> None:
    """Sample rooms with faults again, and keep the better sample."""
    from chord_usd.line.graph.match import match_assets

    settings, draw, models = made.settings, made.draw, made.models
    leave_out = partial(arrange_drawn, draw=draw) if settings.arrange else None
    if made.listed is not None and leave_out is not None:
        made.graph, made.layout = as_listed(
            made.graph, made.listed, made.layout, made.plan_image, draw, leave_out
        )
    locked = frozenset(item.id for item in draw.locked)
    sampler = Resampler(made.plan_image, models.layout, models.reader.read, draw, locked)
    made.mended = mend_rooms(
        made.graph,
        made.layout,
        sampler,
        times=settings.redraws,
        spared=made.listed_wrong,
        settle=leave_out,
        progress=progress,
    )
    database = models.reader.database
    graph, made.layout = made.mended.graph, made.mended.layout
    if not settings.arrange:
        graph = match_assets(graph, database)
    else:

        def finish(house: SceneGraph) -> SceneGraph:
            return match_assets(arrange_drawn(match_assets(house, database), draw), database)

        graph = finish(graph)
        if made.listed is not None:
            from chord_usd.line.lists.put_back import put_back

            open_rooms = {room.id for room in graph.rooms} - draw.shut
            graph = put_back(graph, made.listed, open_rooms, draw.asked, finish, is_searched=True)
    draw.refuse_lacking(graph)
    made.graph = steps.in_style(with_networks(graph, settings), made.style)


def score_outliers(made: FurnishedStorey, _: Progress) -> None:
    """Give each item its out-of-distribution score."""
    made.graph = steps.score_outliers(made.graph, made.plan_image, made.models.layout)


def lay_tables(made: FurnishedStorey, progress: Progress) -> None:
    """Lay objects on pieces with tops."""
    models = made.models
    assert models.table is not None, "loaded where tables are laid"
    made.tabletops = steps.lay_tables(
        made.graph, models.table, models.reader.database, made.settings, progress
    )
    made.graph = made.tabletops.graph


def settle(made: FurnishedStorey, _: Progress) -> None:
    """Apply the rules that need meshes."""
    database = made.models.reader.database
    made.graph = steps.settle(made.graph, made.settings, database=database)


def dress(made: FurnishedStorey, _: Progress) -> None:
    """Dress rooms; those of stairs and common parts stay bare."""
    shut = made.draw.shut
    rooms = [room.id for room in made.plan.rooms if room.id not in shut] if shut else ()
    database = made.models.reader.database
    made.graph = steps.dress_rooms(made.graph, database, made.settings, rooms)


STEPS: Mapping[str, Callable[[FurnishedStorey, Progress], None]] = {
    "list": list_pieces,
    "layout": paint,
    "graph": read,
    "redraw": redraw,
    "outliers": score_outliers,
    "tabletop": lay_tables,
    "settle": settle,
    "dress": dress,
}
"""The steps from a plan to a scene graph that is ready to be written."""


def _due(settings: Settings) -> Mapping[str, Callable[[FurnishedStorey, Progress], None]]:
    """STEPS without those that the settings leave out."""
    wanted = {"tabletop": settings.tabletop, "dress": settings.dressing}
    return {name: step for name, step in STEPS.items() if wanted.get(name, True)}


def _stacked(storeys: Sequence[StoreyPlan]) -> Building:
    """Storeys as a house. Raises PlanError for storeys that do not fit on each other."""
    if len(storeys) == 1:
        return one_storey(storeys[0])
    from chord_usd.base.scene.stacking import stack

    return stack(storeys)


def _checked(
    building: Building, files: Sequence[Path], settings: Settings, watch: Stopwatch
) -> list[PlanImage]:
    """Rasters of the storeys. Raises ChordError for a house that cannot be made."""
    images, estimate = [], Estimate(0.0, 0)
    for storey, file in zip(building.storeys, files, strict=True):
        steps.refuse_shut(storey.plan, file)
        if settings.homes_only:
            steps.refuse_no_home(storey.plan, file)
        images.append(steps.draw_plan(storey.plan))
        estimate += of_furnishing(storey.plan, images[-1]) + of_stage(storey.plan.scene())
    steps.refuse_roof(building.storeys[-1].plan, settings)
    estimate.require_memory(str(files[0]))
    watch.announce(estimate.said())
    return images


def _begun(
    storey: Storey, file: Path, image: PlanImage, settings: Settings, models: Models,
    style: HomeStyle, asked: Mapping[str, Asked],
) -> FurnishedStorey:  # fmt: skip
    """A storey before STEPS, with its part of the requests and a seed apart from the others."""
    from chord_usd.base.raster.canvas import layout_image

    local = replace(settings, seed=(settings.seed + _SEEDS_APART * storey.index) % (SEEDS[1] + 1))
    ids = {room.id for room in storey.plan.rooms}
    wishes = {room_id: wish for room_id, wish in asked.items() if room_id in ids}
    bare = frozenset(room.id for room in storey.plan.rooms if is_cell(room) or is_common(room))
    placed = placed_pieces(storey.plan) if settings.drawn and settings.arrange else []
    locked, shown = parted(placed)
    draw = replace(
        steps.sampling(local, models.lists, wishes), shut=bare, locked=locked, shown=shown
    )
    graph, empty = storey.plan.scene(), layout_image(image, ())
    return FurnishedStorey(
        storey, file, image, local, models, draw, style, graph, empty, graph, empty, placed
    )


def _asked(building: Building, settings: Settings) -> dict[str, Asked]:
    """Required and excluded pieces of rooms on all storeys, by id. Raises ChordError."""
    if not settings.furniture:
        return {}
    from chord_usd.line.lists.wishes import furniture_asked, read_furniture
    from chord_usd.line.stage.author.stage_levels import levels_of

    levels = levels_of(building, [storey.plan.scene() for storey in building.storeys])
    rooms = {named.name: named.room for level in levels for named in level.rooms}
    return furniture_asked(read_furniture(settings.furniture), rooms)


def _write(
    building: Building,
    storeys: Sequence[FurnishedStorey],
    stage_path: Path,
    settings: Settings,
    style: HomeStyle,
) -> StageFile:
    from chord_usd.line.stage.author.stage_levels import levels_of

    levels = levels_of(building, [made.graph for made in storeys])
    asked = [asked for made in storeys for asked in made.draw.asked.values()]
    requests = {each.room: each.wishes.in_words() for each in asked}
    return steps.write_levels(levels, stage_path, settings, style, requests)


def read_storeys(
    files: Sequence[Path], settings: Settings, *, every: bool = False
) -> tuple[StoreyPlan, ...]:
    """The storeys in these files, the lowest first: a plan each, or a JSON that holds several.

    every: whether of each file all storeys are taken that it shows. Of the settings, rooms name
    their storey, too, where there are several (corrections.on_storeys). Raises PlanError.
    """
    held = [storeys_in(file) for file in files]
    if len(files) == 1 and not every and not held[0]:
        return (StoreyPlan(steps.read_plan(files[0], settings)),)
    if not files:
        raise PlanError("no plan was given", where="plan", expected="a file, or several")
    bare, storeys = replace(settings, rooms=""), list[StoreyPlan]()
    for file, several in zip(files, held, strict=True):
        if several or not every:
            storeys += several or [StoreyPlan(steps.read_plan(file, bare))]
            continue
        from chord_usd.line.plan.read import read_storey_plans

        storeys += read_storey_plans(file, settings.m_per_px)
    return _corrected(storeys, settings.rooms) if settings.rooms else tuple(storeys)


def _corrected(storeys: Sequence[StoreyPlan], said: str) -> tuple[StoreyPlan, ...]:
    from chord_usd.line.plan.corrections import on_storeys, read_rooms, with_rooms

    names = [storey.name or storey_title(index) for index, storey in enumerate(storeys)]
    return tuple(
        replace(storey, plan=with_rooms(storey.plan, rooms)) if rooms else storey
        for storey, rooms in zip(storeys, on_storeys(read_rooms(said), names), strict=True)
    )


def storeys_in(file: Path) -> tuple[StoreyPlan, ...]:
    """The storeys in a JSON file that holds several; none for any other file. Raises PlanError."""
    if file.suffix.lower() != ".json":
        return ()
    from chord_usd.base.scene.json_stairs import is_storeys, storeys_from_json

    refuse_odd_file(file, PlanError, MOST_JSON_BYTES)
    data = parse_json(file.read_bytes(), str(file), PlanError)
    return storeys_from_json(data, str(file)) if is_storeys(data) else ()
