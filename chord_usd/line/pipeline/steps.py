"""Steps of the line, a function each: what verbs for a single step call, too."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import CheckpointError, ChordError, PlanError
from chord_usd.base.runtime.files import hash_file
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.drawn_pieces import DRAWN
from chord_usd.base.scene.dwellings import NO_HOME, only_dwelling
from chord_usd.base.scene.roof_forms import NO_ROOF
from chord_usd.base.scene.settings import Settings
from chord_usd.base.scene.styles import MIXED, HomeStyle, style_named
from chord_usd.base.scene.types import (
    LayoutImage,
    Plan,
    PlanImage,
    SceneGraph,
    StageFile,
)
from chord_usd.line.pipeline.loading import (
    LAYOUT_CHECKPOINT,
    LISTS_CHECKPOINT,
)
from chord_usd.line.pipeline.redraw import Draw, arrange_drawn

if TYPE_CHECKING:
    from chord_usd.library.database import AssetDatabase
    from chord_usd.line.graph.tabletop import Tabletops, TopModel
    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.lists.list_sampler import ListDrawer
    from chord_usd.line.lists.wishes import Asked
    from chord_usd.line.stage.author.stage_levels import Level


def read_plan(plan_file: Path, settings: Settings) -> Plan:
    """Plan file, a picture, vector file or CHOrD JSON -> Plan."""
    from chord_usd.line.plan.read import read_plan_file

    plan = read_plan_file(plan_file, settings.m_per_px, settings.part)
    if settings.rooms:
        from chord_usd.line.plan.corrections import read_rooms, with_rooms

        plan = with_rooms(plan, read_rooms(settings.rooms))
    if not settings.drawn:
        plan = replace(plan, extra={k: v for k, v in plan.extra.items() if k != DRAWN})
    return only_dwelling(plan, settings.dwelling) if settings.dwelling else plan


def refuse_no_home(plan: Plan, plan_file: Path) -> None:
    """Raises PlanError for an office, a school or a shop."""
    reason = next(
        (warning for warning in plan.extra.get("warnings", ()) if warning.startswith(NO_HOME)), None
    )
    if reason:
        raise PlanError(reason, where=str(plan_file), expected="a home", try_="<homes_only>")


def refuse_shut(plan: Plan, plan_file: Path) -> None:
    """Raises PlanError for a house that nobody can enter: most likely its doors were not seen."""
    if not any(opening.kind != "window" for opening in plan.openings):
        raise PlanError(
            "has no door that could be found",
            where=str(plan_file),
            expected="at least one door or passage",
            try_=f"<plan read={plan_file.name}>",
        )


def draw_plan(plan: Plan) -> PlanImage:
    """Plan -> PlanImage."""
    from chord_usd.base.raster import canvas

    return canvas.draw_plan(plan, canvas.house_frame(plan))


def draw_layout(
    plan: Plan,
    plan_image: PlanImage,
    model: LayoutModel,
    plan_file: Path,
    settings: Settings,
    listed: SceneGraph | None = None,
    progress: Progress | None = None,
) -> LayoutImage:
    """PlanImage -> LayoutImage, by the diffusion model; its provenance names the plan file.

    plan: what the raster was drawn from; its rooms are laid out with their walls upright.
    listed: the plan with the pieces that lists tell.
    """
    from chord_usd.line.layout.upright import sample_upright

    layout = sample_upright(
        model,
        plan,
        plan_image,
        listed=listed,
        seed=settings.seed,
        steps=settings.steps,
        sampler=settings.sampler,
        progress=progress,
    )
    provenance = replace(layout.provenance, input_hash=hash_file(plan_file)[:16])
    return replace(layout, provenance=provenance)


def sampling(
    settings: Settings, lists: ListDrawer | None, asked: Mapping[str, Asked] | None = None
) -> Draw:
    """How layouts are sampled, with lists where there is a network for them."""
    if asked and lists is None:
        require_lists(settings)
    return Draw(
        settings.seed, settings.steps, settings.sampler, lists, asked or {},
        composes=settings.arrange,
    )  # fmt: skip


def require(settings: Settings) -> None:
    """Raises ChordError for what cannot be had, before anything is loaded: an unknown sky, a file
    that is no HDRI, pieces where there are no lists, furniture and rooms that cannot be read."""
    from chord_usd.base.raster.hdri import require_picture
    from chord_usd.base.scene.skies import sky_named

    require_picture(sky_named(settings.sky))
    if settings.furniture:
        from chord_usd.line.lists.wishes import read_furniture

        read_furniture(settings.furniture)
        require_lists(settings)
    if settings.rooms:
        from chord_usd.line.plan.corrections import read_rooms

        read_rooms(settings.rooms)
    if settings.standard:
        from chord_usd.base.metrics.design.standard import standards_in

        standards_in(settings.standard)


def plan_limits(plans: Sequence[Plan], settings: Settings) -> list[str]:
    """What the empty rooms of storeys cannot keep of the standard of the settings, a line each
    with its place."""
    if not settings.standard:
        return []
    from chord_usd.base.metrics.design.standard import keeping, standards_in

    graphs = [SceneGraph(plan.rooms, plan.openings, ()) for plan in plans]
    kept = [keeping(standard, graphs, of_plan=True) for standard in standards_in(settings.standard)]
    return [f"the plan cannot keep: {line}" for result in kept for line in result.lines]


def refuse_roof(plan: Plan, settings: Settings) -> None:
    """Raises PlanError for a roof that does not fit over a plan."""
    if settings.roof != NO_ROOF:
        from chord_usd.line.stage.shell.roof import require_roof

        require_roof(plan, settings.roof)


def require_lists(settings: Settings) -> None:
    """Raises ChordError where there are no lists that could hold what is wished for."""
    from chord_usd.line.layout.description import read_description

    if not settings.lists:
        raise ChordError("pieces cannot be asked for without lists", expected="no <lists>")
    folder = checkpoint_folder(LAYOUT_CHECKPOINT)
    if not read_description(folder).config.draft:
        raise CheckpointError(
            "the layout model does not see lists, and pieces cannot be asked for without",
            where=str(folder),
            expected="one that was trained with drafts",
            try_="<train=plan2layout>",
        )
    checkpoint_folder(LISTS_CHECKPOINT)


def score_outliers(graph: SceneGraph, plan_image: PlanImage, model: LayoutModel) -> SceneGraph:
    """The graph with each item's out-of-distribution score."""
    from chord_usd.line.layout.outlier import NoiseError

    scores = NoiseError(model).item_scores(plan_image, graph.items)
    items = tuple(
        item.with_facts(ood=scores[item.id]) if item.id in scores else item for item in graph.items
    )
    return replace(graph, items=items)


def lay_tables(
    graph: SceneGraph,
    model: TopModel,
    database: AssetDatabase,
    settings: Settings,
    progress: Progress | None = None,
    rooms: Collection[str] = (),
    but: Collection[str] = (),
) -> Tabletops:
    """SceneGraph -> the same with items on every supporting piece, all of them in one batch.

    rooms: ids of the rooms whose pieces are laid, by default all. but: ids of pieces that stay as
    they are.
    """
    from chord_usd.library.asset_shapes import relief_of
    from chord_usd.line.graph.tabletop import lay_pieces, table_views, with_items

    views = [view for view in table_views(graph, relief_of, rooms) if view.item.id not in but]
    laid = lay_pieces(views, model, settings.seed, database, relief_of, progress)
    return with_items(graph, views, laid)


def settle(
    graph: SceneGraph,
    settings: Settings,
    rooms: Collection[str] = (),
    but: Collection[str] = (),
    database: AssetDatabase | None = None,
) -> SceneGraph:
    """The graph after the rules that look at meshes, if it is to be arranged.

    rooms: ids of the rooms whose pieces may move, by default all. but: ids of items that stay.
    database: models for pieces whose leaves open nowhere.
    """
    from chord_usd.line.arrange.arrangement import Arrangement
    from chord_usd.line.arrange.rules import arrange

    if not settings.arrange:
        return graph
    movable = {
        item.id
        for item in graph.items
        if (not rooms or item.room_id in rooms) and item.id not in but
    }
    return arrange(Arrangement.of(graph, movable=movable, database=database), "meshed")


def arrange_given(graph: SceneGraph) -> SceneGraph:
    """A house whose pieces somebody else placed, none in another, out of its room or before a door:
    moved aside, or else left out."""
    from chord_usd.line.arrange.arrangement import Arrangement
    from chord_usd.line.arrange.rules import arrange

    return arrange_drawn(arrange(Arrangement.of(graph), "given"), Draw())


def dress_rooms(
    graph: SceneGraph,
    database: AssetDatabase,
    settings: Settings,
    rooms: Collection[str] = (),
    keep: Collection[str] = (),
) -> SceneGraph:
    """The graph with its rooms dressed again, in its style or else that of the settings.

    rooms: ids, by default all. keep: ids of dressing that stays as it is.
    """
    from chord_usd.line.dressing.dress import dress

    style = style_named(graph.style or settings.style or MIXED, settings.seed)
    return dress(graph, database, style, settings.seed, rooms, keep)


def load_usd() -> None:
    """Import what writes stages, so that the time of the step is its own."""
    import chord_usd.line.stage.author.author_stage  # noqa: F401


def write_stage(graph: SceneGraph, stage_path: Path, settings: Settings) -> StageFile:
    """SceneGraph -> StageFile, in the graph's style, else in that of the settings."""
    from chord_usd.line.stage.author.stage_levels import one_level

    style = style_named(graph.style or settings.style or MIXED, settings.seed)
    return write_levels([one_level(graph)], stage_path, settings, style)


def write_levels(
    levels: Sequence[Level], stage_path: Path, settings: Settings, style: HomeStyle,
    requests: Mapping[str, str] | None = None,
) -> StageFile:  # fmt: skip
    """Levels of a house, the lowest first -> StageFile. requests: as author_levels takes them."""
    from chord_usd.library.looks.look_library import style_looks
    from chord_usd.line.stage.author.author_stage import author_levels

    looks = style_looks(style, settings.seed, settings.texture_px)
    stage = author_levels(
        levels, stage_path, seed=settings.seed, looks=looks, style=style.name, sky=settings.sky,
        articulation=settings.articulation, roof=settings.roof, requests=requests,
    )  # fmt: skip
    if settings.state:
        from chord_usd.line.pipeline.house_states import set_states

        set_states(stage_path, stage_path, settings.state)
        stage = replace(stage, content_hash=hash_file(stage_path))
    return stage


def in_style(graph: SceneGraph, style: HomeStyle) -> SceneGraph:
    """The graph that notes its style, also where it says how it was made."""
    made = graph.provenance
    configuration = {**made.configuration, "style": style.name}
    return replace(graph, style=style.name, provenance=replace(made, configuration=configuration))


def read_scene_file(scene_file: Path, settings: Settings) -> SceneGraph:
    """Scene graph file -> SceneGraph; items without a mesh on this machine get the nearest one.

    Raises SceneError, and AssetError for a mesh that is neither beside the scene nor in a folder
    of the settings.
    """
    from chord_usd.base.scene.chord_json import read_scene
    from chord_usd.library.database import load_database
    from chord_usd.library.named import with_found_assets
    from chord_usd.line.graph.match import match_assets

    folders = settings.asset_folders
    graph = read_scene(scene_file)
    style = style_named(settings.style or graph.style or MIXED, settings.seed)
    database = load_database(folders, style.name, settings.texture_px)
    graph = with_found_assets(in_style(graph, style), scene_file, folders, database)
    return match_assets(graph, database)
