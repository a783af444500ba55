"""The line as a whole: `whole_house` makes houses, `steps` holds a function for each step."""

from chord_usd.base.scene.settings import Settings
from chord_usd.line.pipeline.loading import (
    LISTS_CHECKPOINT,
    THINGS_CHECKPOINT,
    GraphReader,
    Models,
    checkpoints,
    load_lists,
    load_model,
    load_models,
    load_reader,
)
from chord_usd.line.pipeline.steps import (
    arrange_given,
    draw_layout,
    draw_plan,
    dress_rooms,
    in_style,
    lay_tables,
    load_usd,
    read_plan,
    read_scene_file,
    refuse_shut,
    require,
    require_lists,
    sampling,
    score_outliers,
    settle,
    write_stage,
)
from chord_usd.line.pipeline.whole_house import House, furnished, generate

__all__ = [
    "LISTS_CHECKPOINT", "THINGS_CHECKPOINT", "GraphReader", "House", "Models", "Settings",
    "arrange_given", "checkpoints", "draw_layout", "draw_plan", "dress_rooms",
    "furnished", "generate", "in_style", "lay_tables", "load_lists", "load_model", "load_models",
    "load_reader", "load_usd", "read_plan", "read_scene_file", "refuse_shut", "require",
    "require_lists", "sampling", "score_outliers", "settle", "write_stage",
]  # fmt: skip
