"""Words and open plans to plans with the shipped models, and the text encoders behind them."""

from __future__ import annotations

import json
import pickle
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch
from tokenizers import Tokenizer

from chord_usd.base.errors import CheckpointError, ChordError, PlanError
from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.raster.plan_labels import sheet_frame
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import WEIGHTS_FILE, read_weights
from chord_usd.base.scene.chord_json import read_plan, write_plan
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.base.scene.wish import Wish
from chord_usd.line.layout.checkpoint import save_checkpoint
from chord_usd.line.layout.config import FLOOR
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.plan.read import read_plan_file
from chord_usd.line.planning.encoder import (
    ENCODER_FOLDER,
    MINILM_CHECKPOINT,
    MOST_WORDS,
    TOKENIZER_FILE,
    MiniLM,
    TransformersEncoder,
    encoder_of,
)
from chord_usd.line.planning.floor_sheet import blank_sheet
from chord_usd.line.planning.outline import open_shell, shell_of
from chord_usd.line.planning.words import PROGRAMME_CHANNELS, WORDS, condition_words
from chord_usd.workshop.data.descriptions import describe
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.training.floor_stream import FloorStream, FloorStreamConfig
from tests.exit_codes import written

RunCli = Callable[..., subprocess.CompletedProcess[str]]
STEPS = ("--steps", "8")


@pytest.fixture(scope="module")
def small_clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A CLIP with random weights, saved as transformers saves the real one."""
    from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

    folder = tmp_path_factory.mktemp("clip")
    letters = [chr(code) for code in range(97, 123)]
    words = [*letters, *(f"{letter}</w>" for letter in letters)]
    vocabulary = {word: index for index, word in enumerate([*words, "<|startoftext|>",
                                                            "<|endoftext|>"])}  # fmt: skip
    (folder / "vocab.json").write_text(json.dumps(vocabulary))
    (folder / "merges.txt").write_text("#version: 0.2\n")
    CLIPTokenizer(str(folder / "vocab.json"), str(folder / "merges.txt")).save_pretrained(folder)
    config = CLIPTextConfig(
        vocab_size=len(vocabulary), hidden_size=32, intermediate_size=64, num_hidden_layers=2,
        num_attention_heads=2, max_position_embeddings=77,
    )  # fmt: skip
    CLIPTextModel(config).save_pretrained(folder)
    return folder


def test_clip_is_read_through_transformers(small_clip: Path) -> None:
    encoder = TransformersEncoder(small_clip)
    short, long = encoder.encode(["a flat", "two bedrooms and a kitchen"])
    assert encoder.channels == 32
    assert short.shape[1] == long.shape[1] == 32
    assert len(short) < len(long)


def test_a_network_keeps_the_text_model_that_it_was_trained_with(
    small_clip: Path, tmp_path: Path
) -> None:
    encoder = TransformersEncoder(small_clip)
    network = replace(
        FLOOR, channels=(32, 32), attention=(False, True), feature_channels=16,
        word_channels=encoder.channels + PROGRAMME_CHANNELS,
    )  # fmt: skip
    config = FloorStreamConfig(text_chance=1.0)
    stream = FloorStream(config, [], network, 2, partial(TransformersEncoder, small_clip))
    assert next(iter(stream))["words"].shape == (2, WORDS, network.word_channels)

    encoder.save(tmp_path / ENCODER_FOLDER)
    save_checkpoint(tmp_path, LayoutNetwork(network), {})
    words = condition_words(Wish(), encoder_of(tmp_path).encode(["two rooms"])[0], 32)
    model, sheet = LayoutModel.load(tmp_path, "cpu"), blank_sheet(sheet_frame(0.12))
    (labels,) = model.sample_labels([sheet], words[None], seeds=[0], steps=1)
    assert labels.shape == sheet.rgb.shape[:2]
    with pytest.raises(CheckpointError, match="another text model"):
        model.sample_labels([sheet], condition_words(Wish())[None], seeds=[0], steps=1)


def test_floors_go_to_workers_after_texts_were_read_here() -> None:
    """Those that are held out are drawn first: no session of the encoder can be sent."""
    config = FloorStreamConfig(text_chance=1.0, silent_chance=0.0)
    stream = FloorStream(config, [], FLOOR, 1)
    (here,) = stream.held_out(1)
    (there,) = pickle.loads(pickle.dumps(stream)).held_out(1)
    assert here.words is not None
    assert np.array_equal(here.words, there.words)


def test_a_folder_without_a_text_model_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ChordError, match="no text model"):
        TransformersEncoder(tmp_path)


def test_minilm_gives_what_transformers_gives() -> None:
    """For every word of fifty texts, whether they come alone or with longer ones."""
    from transformers import BertConfig, BertModel

    folder = checkpoint_folder(MINILM_CHECKPOINT)
    model = BertModel(BertConfig.from_json_file(str(folder / "config.json"))).eval()
    weights = read_weights(folder / WEIGHTS_FILE, "")
    tensors = {name: torch.from_numpy(value).float() for name, value in weights.items()}
    lacking, unknown = model.load_state_dict(tensors, strict=False)
    assert {name.partition(".")[0] for name in lacking} <= {"pooler"}
    assert unknown == []
    tokenizer = Tokenizer.from_file(str(folder / TOKENIZER_FILE))
    dice = [np.random.default_rng(seed) for seed in range(46)]
    texts = [describe(random_plan(rng), rng).text for rng in dice]
    texts += ["", "a", "Zwei Zimmer, Küche & Bad: 70 m²", "three bedrooms " * MOST_WORDS]
    ours = MiniLM()
    for text, together in zip(texts, ours.encode(texts), strict=True):
        tokenizer.enable_truncation(MOST_WORDS)
        tokenizer.no_padding()
        ids = torch.tensor([tokenizer.encode(text).ids])
        with torch.inference_mode():
            wanted = model(ids, torch.ones_like(ids)).last_hidden_state[0].numpy()
        (alone,) = ours.encode([text])
        np.testing.assert_allclose(together, wanted, atol=1e-4)
        np.testing.assert_allclose(alone, wanted, atol=1e-4)
    assert len(wanted) == MOST_WORDS


def test_text_becomes_a_plan(run_cli: RunCli, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    text = "a two-bedroom flat with a living room, a kitchen and a bathroom, about 70 m²"
    done = run_cli("plan", "from-text", text, "-o", out, "--json", *STEPS)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["understood"].startswith("2 bedrooms, 1 living room, 1 kitchen, 1 bathroom")
    plan = read_plan(out)
    assert len(plan.rooms) == told["rooms"] > 0
    again = tmp_path / "again.json"
    run_cli("plan", "from-text", text, "-o", again, *STEPS, fresh=True)
    assert again.read_bytes() == out.read_bytes()


def test_an_open_plan_gets_rooms_and_keeps_its_walls(run_cli: RunCli, tmp_path: Path) -> None:
    shell = open_shell(random_plan(np.random.default_rng(1)))
    drawn, out = tmp_path / "open.png", tmp_path / "plan.json"
    write_raster(draw_plan(shell, shade=False), drawn)
    done = run_cli("plan", "from-outline", drawn, "-o", out, "--json", *STEPS)
    assert done.returncode == 0, done.stderr
    plan = read_plan(out)
    assert len(plan.rooms) == json.loads(done.stdout)["rooms"] > 1
    windows = [o for o in shell.openings if o.kind == "window"]
    outer = [o for o in plan.openings if o.kind == "window" and len(o.room_ids) < 2]
    assert len(outer) == len(windows)


def outline_by_hand(kind: str) -> np.ndarray:
    """Outer walls of 9 x 6 m or so at 1 cm a pixel, with three windows and a door, as people draw
    them: filled, as two lines, or as one line."""
    rgb = np.full((800, 1100, 3), 255, np.uint8)
    corners = [[100, 100], [1000, 100], [1000, 450], [650, 450], [650, 700], [100, 700]]
    thick = {"filled": 16, "two lines": 20, "one line": 6}[kind]
    cv2.polylines(rgb, [np.array(corners)], True, (0, 0, 0), thick)
    if kind == "two lines":
        cv2.polylines(rgb, [np.array(corners)], True, (255, 255, 255), thick - 5)
    half = thick // 2
    for x0, y0, x1, y1 in ((300, 100, 450, 100), (1000, 200, 1000, 350), (100, 300, 100, 450)):
        across = (0, half) if y0 == y1 else (half, 0)
        box = (x0 - across[0], y0 - across[1]), (x1 + across[0], y1 + across[1])
        cv2.rectangle(rgb, *box, (255, 255, 255), -1)
        cv2.rectangle(rgb, *box, (0, 0, 0), 2)
    cv2.rectangle(rgb, (400, 700 - half - 2), (490, 700 + half + 2), (255, 255, 255), -1)
    cv2.line(rgb, (400, 700), (400, 610), (0, 0, 0), 2)
    cv2.ellipse(rgb, (400, 700), (90, 90), 0, -90, 0, (0, 0, 0), 2)
    return rgb


@pytest.mark.parametrize("kind", ["filled", "two lines", "one line"])
def test_outlines_drawn_by_hand_are_one_floor_of_a_home(kind: str, tmp_path: Path) -> None:
    """The reader parted these floors by uses, and took a home for a room: 15 m2 for 45."""
    file = tmp_path / "open.png"
    cv2.imwrite(str(file), outline_by_hand(kind))
    shell = shell_of(read_plan_file(file, is_open=True), str(file))
    assert len(shell.rooms) == 1
    assert 0.6 < room_polygon(shell.rooms[0]).area / 45.0 < 1.6


def test_parts_of_a_floor_are_one_shell() -> None:
    """As in a file whose open plan is parted already; rooms with a wall between are not."""
    parts = [Room(f"r{at}", "living", frozen_array([[at, 0], [at + 4, 0], [at + 4, 5], [at, 5]]))
             for at in (0, 4, 8.24)]  # fmt: skip
    door = Opening("d", "door", Box((6.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("r4",))
    shell = shell_of(Plan(tuple(parts[:2]), (door,)), "x")
    assert room_polygon(shell.rooms[0]).area == pytest.approx(40.0)
    assert shell.openings[0].room_ids == (shell.rooms[0].id,)
    with pytest.raises(PlanError, match="has 2 closed rooms"):
        shell_of(Plan(tuple(parts), (door,)), "x")


BAD_TEXTS = {
    "empty": ("", "is empty"),
    "endless": ("a bedroom " * 1000, "10000 characters"),
    "impossible": ("0 rooms, 500 bedrooms in 20 m²", "500 bedrooms and 20 m²"),
    "unknown": ("квартира с двумя спальнями", "names no rooms"),
}


@pytest.mark.parametrize("name", BAD_TEXTS)
def test_bad_texts_are_told(run_cli: RunCli, tmp_path: Path, name: str) -> None:
    text, told = BAD_TEXTS[name]
    out = tmp_path / "plan.png"
    done = run_cli("plan", "from-text", text, "-o", out)
    assert done.returncode == 2
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
    assert not out.exists()


def open_drawing(gap: bool, island: bool) -> np.ndarray:
    """Four walls drawn 5 cm a pixel; a gap as wide as a room, or a closed box in the middle."""
    rgb = np.full((256, 256, 3), 255, np.uint8)
    cv2.rectangle(rgb, (30, 40), (220, 200), (0, 0, 0), 5)
    if gap:
        rgb[35:46, 60:190] = 255
    if island:
        cv2.rectangle(rgb, (100, 90), (150, 140), (0, 0, 0), 5)
    return rgb


@pytest.mark.parametrize(("gap", "island"), [(True, False), (False, True)])
def test_outlines_that_are_none_are_told(
    run_cli: RunCli, tmp_path: Path, gap: bool, island: bool
) -> None:
    drawn, out = tmp_path / "open.png", tmp_path / "plan.json"
    cv2.imwrite(str(drawn), open_drawing(gap, island))
    done = run_cli("plan", "from-outline", drawn, "-o", out, "--scale", "0.05")
    assert done.returncode == 2, done.stdout
    assert done.stderr.count("\n") == 1
    assert not out.exists()


def test_generate_takes_exactly_one_source(run_cli: RunCli, tmp_path: Path) -> None:
    out = tmp_path / "house.usda"
    assert run_cli("generate", "-o", out).returncode == 2
    plan = tmp_path / "plan.json"
    write_plan(random_plan(np.random.default_rng(0)), plan)
    assert run_cli("generate", plan, "--text", "two bedrooms", "-o", out).returncode == 2
    assert not out.exists()


def test_a_text_becomes_a_furnished_house(run_cli: RunCli, tmp_path: Path) -> None:
    out = tmp_path / "house.usda"
    text = "one-bedroom flat with a kitchen and a bathroom, 45 m²"
    done = run_cli("generate", "--text", text, "-o", out, "--json", "--no-tabletop", *STEPS)
    told = written(done)
    assert told["planned"]["understood"].endswith("45 m²")
    assert told["rooms"] == told["planned"]["rooms"]
    assert told["furniture"] > 0
    assert out.exists()
