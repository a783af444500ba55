"""train: data -> checkpoint; a run in the same folder is resumed.

The detector is resumed from its weights alone: its optimizer starts again.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.locations import RUN_CHECKPOINT, name_checkpoint
from chord_usd.faces.commands import train_lists, train_next
from chord_usd.faces.commands.common import (
    Outcome,
    Parser,
    Run,
    UsageError,
    Verbs,
    add_group,
    add_verb,
    positive,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.train_options import (
    add_flats,
    add_furnished,
    add_houses,
    add_loop_options,
    add_processor_time,
    add_training_options,
    device_of,
    furnished_of,
    judges_of,
    run_of,
    start_of,
    unseen_of,
)

if TYPE_CHECKING:
    from chord_usd.line.layout.config import LayoutConfig
    from chord_usd.workshop.training.detector_data import Sample
    from chord_usd.workshop.training.stream import BatchStream
    from chord_usd.workshop.training.trainer import LayoutTrainer

_READER_CROPS = 24
"""Held-out crops that the reader is scored on."""

_SYMBOL_CROPS = 96
"""Held-out crops of about seven metres that drawn pieces are scored on."""


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "train", "train the networks; a run in the same folder is resumed")
    layout = add_verb(group, "plan2layout", run_plan2layout, "train the layout model")
    add_training_options(layout, minutes=60.0, batch=None)
    layout.add_argument(
        "--preset", default="default", metavar="NAME",
        help="default, large, paper, small or small-pure (default)",
    )  # fmt: skip
    add_processor_time(layout)
    add_houses(layout)
    add_furnished(layout)
    add_flats(layout)
    add_loop_options(layout)
    _add_guidance(layout)
    table = add_verb(group, "table", run_table, "train the model of what stands on tables")
    add_training_options(table, minutes=40.0, batch=None)
    add_loop_options(table)
    for verb, what, run in (
        ("text2plan", "from words", run_text2plan),
        ("outline2plan", "in open plans", run_outline2plan),
    ):
        floors = add_verb(group, verb, run, f"train the model that plans floors {what}")
        add_training_options(floors, minutes=60.0, batch=None)
        add_flats(floors)
        add_loop_options(floors)
        if verb == "text2plan":
            floors.add_argument(
                "--text-encoder",
                type=Path,
                metavar="DIR",
                help="a text model as transformers saves it, such as CLIP; kept in the checkpoint "
                "(MiniLM, which comes with chord-usd)",
            )
    bubbles = add_verb(
        group, "bubbles", run_bubbles, "train the model that sketches where rooms go"
    )
    add_training_options(bubbles, minutes=30.0, batch=None)
    add_flats(bubbles)
    bubbles.add_argument(
        "--houses",
        type=whole_number(1, 10_000_000),
        default=40_000,
        metavar="N",
        help="procedural houses to learn from (40000)",
    )
    train_lists.add(group)
    train_next.add(group)
    reader = add_verb(group, "reader", run_reader, "train the model that reads pages of plans")
    add_training_options(reader, minutes=60.0, batch=None)
    add_flats(reader)
    add_loop_options(reader)
    reader.add_argument(
        "--kinds-only",
        action="store_true",
        help="learn what floors are for, and leave all else as --start has it",
    )
    symbols = add_verb(
        group, "symbols", run_symbols, "train the model that finds drawn furniture and fixtures"
    )
    add_training_options(symbols, minutes=60.0, batch=None)
    add_loop_options(symbols)
    detector = add_verb(group, "detector", run_detector, "train the detector of layout rasters")
    add_training_options(detector, minutes=15.0, batch=16)
    detector.add_argument(
        "--kind",
        choices=("items", "rooms"),
        default="items",
        help="oriented boxes of items, or masks of rooms (items)",
    )
    detector.add_argument(
        "--start",
        type=Path,
        metavar="DIR",
        help="checkpoint, of either kind, to take what fits from where no run is there",
    )
    detector.add_argument(
        "--generated",
        type=whole_number(0, 10_000_000),
        default=0,
        metavar="N",
        help="layouts that plan2layout paints first, half of all that is seen then (0)",
    )
    detector.add_argument(
        "--score-houses",
        type=whole_number(1, 1_000_000),
        default=200,
        metavar="N",
        help="held-out houses to score the result on (200)",
    )
    for verb, parser in group.choices.items():
        parser.set_defaults(run=partial(_run_named, parser.get_default("run"), verb))


def _add_guidance(parser: Parser) -> None:
    parser.add_argument(
        "--teacher", type=Path, metavar="DIR", help="checkpoint to learn from, guided by --guide"
    )
    parser.add_argument(
        "--guide", type=Path, metavar="DIR", help="less trained checkpoint to lead away from"
    )
    parser.add_argument(
        "--guidance",
        type=positive,
        default=2.0,
        metavar="W",
        help="how far: 1 is the teacher as it is (2)",
    )


def _run_named(run: Run, verb: str, options: argparse.Namespace) -> Outcome:
    """Runs a verb, and notes in its folder which checkpoint it trains, also where it is ended."""
    names = {
        "detector": f"detector_{getattr(options, 'kind', '')}",
        "lists": "things" if getattr(options, "of", "") == "things" else "lists",
    }
    if getattr(options, "start", None):
        options.start = start_of(options)
    try:
        return run(options)
    finally:
        name_checkpoint(options.output, names.get(verb, verb))


def run_plan2layout(options: argparse.Namespace) -> Outcome:
    """Runs train plan2layout."""
    from chord_usd.line.layout.config import PRESETS
    from chord_usd.workshop.data.flats import furnishable, read_flats
    from chord_usd.workshop.training.stream import LayoutStream, StreamConfig

    if options.preset not in PRESETS:
        raise UsageError(
            f"unknown preset {options.preset!r}",
            where="--preset",
            expected=f"one of {', '.join(PRESETS)}",
        )
    furnished = furnished_of(options)
    trainer = _layout_trainer(options, PRESETS[options.preset])
    real = read_flats(options.flats, part="train") if options.flats else []
    flats = furnishable(real)
    drawing = StreamConfig(seed=options.seed, procedural=options.houses)
    shape = trainer.network.config, trainer.config.batch
    stream = LayoutStream(drawing, flats, *shape, furnished, unseen_of(options))
    facts = {
        "real_plans": len(flats),
        "real_plans_left_out": len(real) - len(flats),
        "furnished": len(furnished),
    }
    return _trained(options, trainer, stream, facts)


def _layout_trainer(options: argparse.Namespace, network: LayoutConfig) -> LayoutTrainer:
    """That of a layout model, which learns from its data or from a guided teacher."""
    from chord_usd.workshop.training.guided import GUIDED_TRAINING, GuidedTrainer
    from chord_usd.workshop.training.trainer import PAPER_TRAINING, LayoutTrainer, TrainingConfig

    if not options.teacher and not options.guide:
        base = PAPER_TRAINING if options.preset == "paper" else TrainingConfig()
        return LayoutTrainer(network, run_of(options, base), options.output)
    if not options.teacher or not options.guide or network.state == "rgb":
        raise UsageError(
            "no guided teacher",
            where="--teacher, --guide",
            expected="both, of a preset that says categories",
        )
    return GuidedTrainer(
        network,
        run_of(options, GUIDED_TRAINING),
        options.output,
        options.teacher,
        options.guide,
        options.guidance,
    )


def run_table(options: argparse.Namespace) -> Outcome:
    """Runs train table."""
    from chord_usd.line.layout.config import TABLE
    from chord_usd.workshop.training.stream import TableStream, TableStreamConfig
    from chord_usd.workshop.training.trainer import TABLE_TRAINING, LayoutTrainer

    config = run_of(options, TABLE_TRAINING)
    trainer = LayoutTrainer(TABLE, config, options.output)
    stream = TableStream(TableStreamConfig(options.seed), TABLE, config.batch)
    return _trained(options, trainer, stream, {})


def run_text2plan(options: argparse.Namespace) -> Outcome:
    """Runs train text2plan."""
    from chord_usd.base.runtime.targets import begin_run
    from chord_usd.line.layout.config import FLOOR
    from chord_usd.line.planning.encoder import ENCODER_FOLDER, TransformersEncoder
    from chord_usd.line.planning.words import PROGRAMME_CHANNELS

    if options.text_encoder is None:
        return _run_floors(options, "text", FLOOR)
    encoder = TransformersEncoder(options.text_encoder)
    begin_run(options.output)
    encoder.save(options.output / "checkpoint" / ENCODER_FOLDER)
    network = replace(FLOOR, word_channels=encoder.channels + PROGRAMME_CHANNELS)
    load_encoder = partial(TransformersEncoder, options.text_encoder)
    return _run_floors(options, "text", network, load_encoder=load_encoder)


def run_outline2plan(options: argparse.Namespace) -> Outcome:
    """Runs train outline2plan."""
    from chord_usd.line.layout.config import FLOOR

    return _run_floors(options, "outline", FLOOR)


def _run_floors(
    options: argparse.Namespace, condition: str, network: LayoutConfig, **words: Any
) -> Outcome:
    """words: what FloorStream takes of them beside the network."""
    from chord_usd.workshop.data.flats import read_flats
    from chord_usd.workshop.training.floor_stream import FloorStream, FloorStreamConfig
    from chord_usd.workshop.training.trainer import FLOOR_TRAINING, LayoutTrainer

    config = run_of(options, FLOOR_TRAINING)
    real = read_flats(options.flats, part="train") if options.flats else []
    trainer = LayoutTrainer(network, config, options.output)
    drawing = FloorStreamConfig(options.seed, condition)
    stream = FloorStream(drawing, real, network, config.batch, **words)
    return _trained(options, trainer, stream, {"real_plans": len(stream.real_plans)})


def run_bubbles(options: argparse.Namespace) -> Outcome:
    """Runs train bubbles."""
    from chord_usd.line.planning.sketcher import load_sketcher
    from chord_usd.workshop.data.flats import read_flats
    from chord_usd.workshop.evaluation.floors import held_out_cases
    from chord_usd.workshop.evaluation.sketch_sheet import draw_sketches
    from chord_usd.workshop.training.sketch_data import Procedural, held_out, sketched
    from chord_usd.workshop.training.sketch_trainer import SketchTraining, train_sketches

    config = run_of(options, SketchTraining())
    flats = read_flats(options.flats, part="train") if options.flats else []
    watch = stopwatch(options)
    houses = Procedural(options.houses, options.seed)
    with watch.step("draw"):
        real = [house for plan in flats if (house := sketched(plan))]
    with watch.step("train") as progress:
        facts = train_sketches(config, options.output, houses, real, held_out(200), progress)
    with watch.step("draw"):
        sketcher = load_sketcher(options.output / "checkpoint")
        draw_sketches(sketcher, held_out_cases(3, aligned=True), options.output / "sheet.png")
    data = {"checkpoint": str(options.output / "checkpoint"), **facts}
    return Outcome(f"{data['checkpoint']}: {counted(facts['steps'], 'step')}", data)


def run_reader(options: argparse.Namespace) -> Outcome:
    """Runs train reader."""
    from chord_usd.workshop.data.flats import read_flats
    from chord_usd.workshop.training.reader_data import held_out
    from chord_usd.workshop.training.reader_trainer import ON_GPU, ReaderTraining, train_reader

    if options.kinds_only and not options.start:
        raise UsageError("--kinds-only without --start", expected="the checkpoint to keep")
    on_cpu = device_of(options) == "cpu"
    config = run_of(options, ReaderTraining() if on_cpu else ON_GPU)
    flats = read_flats(options.flats, part="train") if options.flats else []
    watch = stopwatch(options)
    with watch.step("draw"):
        crops = held_out(judges_of(options, _READER_CROPS))
    with watch.step("train") as progress:
        facts = train_reader(
            config, options.output, crops, progress, start=options.start, flats=flats
        )
    data = {"checkpoint": str(options.output / "checkpoint"), **facts}
    return Outcome(f"{data['checkpoint']}: {counted(facts['steps'], 'step')}", data)


def run_symbols(options: argparse.Namespace) -> Outcome:
    """Runs train symbols."""
    from chord_usd.workshop.training.symbols_data import held_out
    from chord_usd.workshop.training.symbols_trainer import SymbolsTraining, train_symbols

    device_of(options)
    watch = stopwatch(options)
    with watch.step("draw"):
        crops = held_out(judges_of(options, _SYMBOL_CROPS))
    with watch.step("train") as progress:
        facts = train_symbols(
            run_of(options, SymbolsTraining()), options.output, crops, progress, options.start
        )
    data = {"checkpoint": str(options.output / "checkpoint"), **facts}
    return Outcome(f"{data['checkpoint']}: {counted(facts['steps'], 'step')}", data)


def _trained(
    options: argparse.Namespace, trainer: LayoutTrainer, stream: BatchStream, facts: dict[str, Any]
) -> Outcome:
    """Train on the stream, going on where a run in the folder stopped."""
    resumed = trainer.resume()
    if options.start and not resumed:
        trainer.warm_start(options.start)
    watch = stopwatch(options)
    with watch.step("train") as progress:
        trainer.train(
            stream, lambda row: progress(round(trainer.minutes * 60), round(options.minutes * 60))
        )
    record = {"checkpoint": str(options.output / "checkpoint"), "resumed": resumed, **facts}
    data = {**record, **trainer.training_record()}
    return Outcome(f"{data['checkpoint']}: {counted(trainer.step, 'step')}", data)


def run_detector(options: argparse.Namespace) -> Outcome:
    """Runs train detector."""
    from chord_usd.base.runtime.networks import WEIGHTS_FILE
    from chord_usd.base.runtime.targets import begin_run
    from chord_usd.line.pipeline import Settings, load_model
    from chord_usd.workshop.data.splits import split_hash
    from chord_usd.workshop.evaluation.detector_cases import clean_cases
    from chord_usd.workshop.evaluation.detector_networks import score_checkpoint
    from chord_usd.workshop.training.detector import DetectorTraining, train_detector
    from chord_usd.workshop.training.detector_card import write_card
    from chord_usd.workshop.training.detector_generated import generated_samples

    config = DetectorTraining(
        minutes=options.minutes,
        batch=options.batch,
        seed=options.seed,
        device=device_of(options),
        start=options.start,
    )
    checkpoint = options.output / RUN_CHECKPOINT
    resumed = (checkpoint / WEIGHTS_FILE).exists()
    watch = stopwatch(options)
    generated: list[Sample] = []
    if options.generated:
        begin_run(options.output)
        with watch.step("generate") as progress:
            model = load_model(Settings(device=device_of(options)))
            folder = options.output / "generated"
            generated = generated_samples(model, options.generated, folder, progress)
    with watch.step("train") as progress:
        facts = train_detector(options.kind, options.output, config, resumed, progress, generated)
    with watch.step("score"):
        cases = list(clean_cases(options.score_houses))
        scores = asdict(score_checkpoint(options.kind, checkpoint, cases))
    scores |= {"layouts": len(cases), "split": split_hash(case.name for case in cases)}
    write_card(options.kind, checkpoint, facts, scores)
    data = {"checkpoint": str(checkpoint), "resumed": resumed, **facts, "scores": scores}
    text = f"mAP50 {scores['map50']:.3f}, n = {scores['truths']} {options.kind}"
    return Outcome(f"{checkpoint}: {text} in {counted(len(cases), 'house')}", data)
