"""The layout model: schedules against diffusers' own, sampling, checkpoints."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch

import chord_usd.base.scene.settings as offered
from chord_usd.base.errors import CheckpointError, ChordError
from chord_usd.base.raster.canvas import paint_layout
from chord_usd.base.runtime.checksums import SUMS_FILE
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import PixelFrame, PlanImage
from chord_usd.line.layout.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from chord_usd.line.layout.config import PRESETS, LayoutConfig
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.draft import CLASS_COUNT
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.schedule import (
    SAMPLERS,
    DiffusersSampler,
    WrittenSampler,
    alphas_cumprod,
    sampling_scheduler,
    training_scheduler,
    walk_of,
)
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.workshop.training.layout_graph import write_layout_graph

TINY = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, True), feature_channels=16,
    default_steps=2,
)  # fmt: skip
TINY_PAPER = replace(
    PRESETS["paper"], patch_px=4, channels=(16, 32), attention=(False, False), default_steps=2
)


@pytest.fixture(params=[TINY, TINY_PAPER], ids=["codes", "rgb"])
def model(request):
    torch.manual_seed(0)
    network = LayoutNetwork(request.param).eval().requires_grad_(False)
    return LayoutModel(TorchDenoiser(Checkpoint(network, request.param, "hash", {})))


def _plan_image(width_px: int = 180) -> PlanImage:
    rgb = np.full((256, 256, 3), 255, np.uint8)
    rgb[30:220, 20 : 20 + width_px] = CATEGORIES["wall"].rgb
    rgb[36:214, 26 : 14 + width_px] = 255
    return PlanImage(rgb, PixelFrame(0.04, (0.0, 0.0)))


def test_same_seed_same_pixels_other_seed_other_pixels(model):
    one = model.sample(_plan_image(), seed=3)
    assert np.array_equal(one.rgb, model.sample(_plan_image(), seed=3).rgb)
    assert not np.array_equal(one.rgb, model.sample(_plan_image(), seed=4).rgb)
    assert one.provenance.seed == 3


def test_a_batch_gives_each_plan_what_it_would_get_alone():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    model = LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))
    batch = model.sample_batch([_plan_image(180), _plan_image(120)], seeds=[1, 2])
    alone = model.sample(_plan_image(120), seed=2)
    same = (batch[1].rgb == alone.rgb).all(axis=2).mean()
    assert same > 0.999  # sums are rounded in another order in a batch


def test_nothing_is_painted_outside_the_house():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    plan = _plan_image()
    layout = LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {}))).sample(plan, seed=0)
    floor = np.zeros((256, 256), bool)
    floor[36:214, 26:194] = True
    assert np.array_equal(layout.rgb[~floor], plan.rgb[~floor])
    assert not np.array_equal(layout.rgb[floor], plan.rgb[floor])


def test_resampling_a_region_leaves_every_other_pixel(model):
    plan = _plan_image()
    labels = np.zeros((256, 256), np.uint8)
    labels[40:80, 30:90], labels[150:200, 120:180] = 3, 5
    front = np.zeros(labels.shape, bool)
    front[70:80, 40:80] = True
    region = np.zeros(labels.shape, bool)
    region[36:120, 26:194] = True
    before = paint_layout(plan, labels, front)
    after = model.resample(plan, labels, front, region, seed=1)
    assert np.array_equal(after.rgb[~region], before[~region])
    assert not np.array_equal(after.rgb[region], before[region])
    again = model.resample(
        plan, np.where(region, 7, labels).astype(np.uint8), front, region, seed=1
    )
    assert np.array_equal(again.rgb[region], after.rgb[region]), (
        "the region's own labels are looked at"
    )


def _large_plan_image() -> PlanImage:
    """Eight rooms of 6 × 5 m in a row."""
    rgb = np.full((736, 736, 3), 255, np.uint8)
    for left in range(10, 710, 89):
        rgb[300:380, left : left + 93] = CATEGORIES["wall"].rgb
        rgb[304:376, left + 4 : left + 89] = 255
    return PlanImage(rgb, PixelFrame(0.07, (0.0, 0.0), 736))


def test_a_large_house_is_sampled_whole():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    model = LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))
    plan = _large_plan_image()
    layout = model.sample(plan, seed=0)
    assert layout.rgb.shape == plan.rgb.shape
    assert np.array_equal(layout.rgb, model.sample(plan, seed=0).rgb)
    painted = (layout.rgb != plan.rgb).any(axis=2)
    assert not painted[(plan.rgb == 0).all(axis=2)].any()
    assert not painted[:300].any()
    assert not painted[380:].any()
    assert all(painted[:, left + 4 : left + 89].any() for left in range(10, 710, 89))


def test_one_room_of_a_large_house_is_sampled_anew():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    model = LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))
    plan = _large_plan_image()
    labels = np.zeros(plan.rgb.shape[:2], np.uint8)
    labels[310:330, 20:60], labels[340:370, 120:150] = 3, 5
    region = np.zeros(labels.shape, bool)
    region[304:376, 103:188] = True
    before = paint_layout(plan, labels, labels > 4)
    looked = []
    estimate = model.estimate
    model.estimate = lambda state, times, plans, **how: (
        looked.append(state.shape) or estimate(state, times, plans, **how)
    )
    after = model.resample(plan, labels, labels > 4, region, seed=1)
    assert np.array_equal(after.rgb[~region], before[~region])
    assert not np.array_equal(after.rgb[region], before[region])
    views = [shape for shape in looked if shape[-1] <= 256]
    assert len(views) == TINY.default_steps, "more than the one view on the room was looked through"


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_every_sampler_takes_the_steps_it_is_given(model, sampler):
    one = model.sample(_plan_image(), seed=3, steps=4, sampler=sampler)
    assert one.provenance.configuration == {"steps": 4, "sampler": sampler}
    torch.manual_seed(1)
    assert np.array_equal(
        one.rgb, model.sample(_plan_image(), seed=3, steps=4, sampler=sampler).rgb
    )


def test_the_command_line_offers_the_samplers_there_are():
    assert set(offered.SAMPLERS) == set(SAMPLERS)


def test_the_graph_draws_what_the_network_does(tmp_path):
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    save_checkpoint(tmp_path, network, {})
    write_layout_graph(tmp_path, network)
    fast = LayoutModel.load(tmp_path, "cpu")
    slow = LayoutModel(TorchDenoiser(load_checkpoint(tmp_path), full=True))
    for width, steps in ((180, TINY.default_steps), (120, 3)):
        one, other = (m.sample(_plan_image(width), steps=steps) for m in (fast, slow))
        assert (one.rgb == other.rgb).all(axis=2).mean() > 0.999
        assert one.provenance == other.provenance


@pytest.mark.parametrize(
    ("sampler", "steps", "atol"),
    [("ddim", 1, 1e-5), ("ddim", 5, 1e-5), ("ddim", 20, 1e-5),
     ("ddpm", 1, 1e-2), ("ddpm", 5, 1e-2), ("ddpm", 7, 1e-2)],
)  # fmt: skip
def test_walks_are_those_of_diffusers(sampler, steps, atol, monkeypatch):
    """DDPM's weights come from products of rounded alphas in diffusers, hence its tolerance. Its
    DDIM walks past its own times where their number does not divide those of training."""
    config = PRESETS["default"]
    walk = walk_of(config, sampler, steps)
    assert all((step.spread > 0) == (sampler == "ddpm") for step in walk[:-1])
    silent = WrittenSampler(tuple(step._replace(spread=0.0) for step in walk), [0])
    monkeypatch.setattr(
        "diffusers.schedulers.scheduling_ddpm.randn_tensor",
        lambda shape, **_: torch.zeros(shape),
    )
    diffusers = DiffusersSampler(config, sampler, steps, [0])
    assert silent.times == diffusers.times
    rng = np.random.default_rng(0)
    state = rng.standard_normal((1, 3, 4, 4), np.float32)
    for index in range(steps):
        clean = rng.standard_normal(state.shape, np.float32)
        after = silent.step(clean, index, state)
        np.testing.assert_allclose(after, diffusers.step(clean, index, state), atol=atol)
        state = after


def test_noise_of_a_walk_is_that_of_ddpm():
    config = PRESETS["default"]
    scheduler = sampling_scheduler(config, "ddpm")
    scheduler.set_timesteps(5)
    for step in walk_of(config, "ddpm", 5)[:-1]:
        variance = float(scheduler._get_variance(step.time))
        assert step.spread == pytest.approx(variance**0.5, rel=5e-3)


def test_noise_of_a_walk_depends_on_the_seed_alone():
    walk = walk_of(PRESETS["default"], "ddpm", 5)
    zero = np.zeros((2, 3, 4, 4), np.float32)
    both = WrittenSampler(walk, [3, 4]).step(zero, 0, zero)
    alone = WrittenSampler(walk, [4]).step(zero[:1], 0, zero[:1])
    np.testing.assert_array_equal(both[1], alone[0])
    assert not np.allclose(both[0], both[1])


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_noise_levels_are_those_of_training(preset):
    config = PRESETS[preset]
    trained = training_scheduler(config).alphas_cumprod.double().numpy()
    np.testing.assert_allclose(alphas_cumprod(config), trained, rtol=1e-3)


def test_progress_counts_every_step(model):
    seen = []
    model.sample(_plan_image(), steps=3, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 3), (2, 3), (3, 3)]


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_the_sampler_walks_the_noise_levels_of_training(preset):
    config = PRESETS[preset]
    trained = training_scheduler(config).alphas_cumprod
    walked = sampling_scheduler(config).alphas_cumprod
    assert torch.equal(trained, walked)
    assert bool((trained[1:] < trained[:-1]).all())


def test_noise_to_signal_spans_what_the_configuration_says():
    config = PRESETS["default"]
    alphas = training_scheduler(config).alphas_cumprod.double()
    ratio = ((1 - alphas) / alphas).sqrt()
    assert ratio[0].item() == pytest.approx(config.noise_to_signal[0], rel=1e-3)
    assert ratio[-1].item() == pytest.approx(config.noise_to_signal[1], rel=1e-2)


def test_an_oracle_is_sampled_exactly():
    """With a network that always names the truth, the reverse process ends at the truth."""
    scheduler = sampling_scheduler(PRESETS["default"])
    scheduler.set_timesteps(8)
    truth = torch.sign(torch.randn(1, 17, 8, 8, generator=torch.Generator().manual_seed(0)))
    state = torch.randn(1, 17, 8, 8, generator=torch.Generator().manual_seed(1))
    for time in scheduler.timesteps:
        state = scheduler.step(truth, time, state).prev_sample
    assert torch.allclose(state, truth, atol=1e-5)


def test_encoding_is_undone_by_the_nearest_code_word():
    network = LayoutNetwork(TINY)
    labels = torch.arange(CLASS_COUNT).repeat(10)[: 16 * 16].reshape(1, 16, 16)
    state = network.encode(labels, labels > 3)
    nearest = torch.einsum("bchw,kc->bkhw", state[:, :-1], network.codes).argmax(dim=1)
    assert torch.equal(nearest, labels)
    assert torch.equal(state[:, -1] > 0, labels > 3)


def test_paper_preset_has_three_noise_and_three_plan_channels_in_and_three_out():
    network = LayoutNetwork(TINY_PAPER)
    fold = TINY_PAPER.patch_px**2
    assert network.embed_state.in_channels == 3 * fold
    assert network.embed_plan.in_channels == 3 * fold
    assert network.head.out_channels == 3 * fold
    assert PRESETS["paper"].patch_px == 1
    assert PRESETS["paper"].training_steps == 1000


class TestCheckpoints:
    def test_round_trip(self, tmp_path):
        network = LayoutNetwork(TINY).half().float()
        save_checkpoint(tmp_path, network, {"steps": 7})
        loaded = load_checkpoint(tmp_path)
        assert loaded.config == TINY
        assert loaded.training == {"steps": 7}
        for name, tensor in network.state_dict().items():
            assert torch.equal(loaded.network.state_dict()[name], tensor)
        assert not list(tmp_path.glob("*.part"))

    def test_missing_folder_says_what_to_do(self, tmp_path):
        with pytest.raises(CheckpointError, match=r"no checkpoint here.*Try: installing"):
            load_checkpoint(tmp_path / "nowhere")

    @pytest.mark.parametrize("keep", [0, 100, 5000])
    def test_truncated_weights(self, tmp_path, keep):
        save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
        weights = tmp_path / "weights.safetensors"
        weights.write_bytes(weights.read_bytes()[:keep])
        with pytest.raises(CheckpointError, match="damaged"):
            load_checkpoint(tmp_path)

    def test_weights_of_another_network(self, tmp_path):
        save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
        description = json.loads((tmp_path / "config.json").read_text())
        description["network"]["channels"] = [32, 32]
        (tmp_path / "config.json").write_text(json.dumps(description))
        (tmp_path / SUMS_FILE).unlink()
        with pytest.raises(CheckpointError, match="another version"):
            load_checkpoint(tmp_path)

    def test_unknown_configuration_key_suggests_the_near_one(self):
        values = {**TINY.to_dict(), "patch_pix": 4}
        with pytest.raises(CheckpointError, match=r"'patch_pix'.*'patch_px'"):
            LayoutConfig.from_dict(values)

    @pytest.mark.parametrize(
        "network",
        [[], "default", {"channels": "wide"}, {"channels": [7, 9]}, {"width": 3}],
        ids=str,
    )
    def test_a_configuration_of_no_network_is_named(self, tmp_path, network):
        save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
        description = json.loads((tmp_path / "config.json").read_text())
        description["network"] = network
        (tmp_path / "config.json").write_text(json.dumps(description))
        with pytest.raises(CheckpointError, match=r"config\.json.*Try:"):
            load_checkpoint(tmp_path)

    def test_everybody_may_read_the_weights(self, tmp_path):
        save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
        modes = {path.stat().st_mode & 0o777 for path in tmp_path.iterdir()}
        assert len(modes) == 1, "as readable as the configuration beside them"

    def test_another_format(self, tmp_path):
        save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
        path = tmp_path / "config.json"
        path.write_text(path.read_text().replace('"format": 1', '"format": 99'))
        with pytest.raises(CheckpointError, match="format 99"):
            load_checkpoint(tmp_path)


@pytest.mark.skipif(torch.cuda.is_available(), reason="this machine has CUDA")
def test_cuda_asked_for_and_absent(tmp_path):
    save_checkpoint(tmp_path, LayoutNetwork(TINY), {})
    with pytest.raises(ChordError, match="no CUDA device"):
        LayoutModel.load(tmp_path, "cuda")


class TestMemory:
    def test_a_batch_is_halved_until_it_fits(self):
        told, sizes = [], []

        def work(jobs):
            sizes.append(len(jobs))
            if len(jobs) > 2:
                raise torch.OutOfMemoryError("CUDA out of memory")
            return [2 * job for job in jobs]

        assert list(in_batches(work, range(7), 8, told.append)) == [0, 2, 4, 6, 8, 10, 12]
        assert sizes == [7, 4, 2, 2, 2, 1]
        assert told == [f"out of memory: went on with a batch of {size}" for size in (4, 2)]

    def test_one_job_too_large_is_an_error_with_a_next_step(self):
        def work(jobs):
            raise RuntimeError("DefaultCPUAllocator: can't allocate memory: you tried 1 EB")

        with pytest.raises(ChordError, match=r"out of memory.*Try:"):
            list(in_batches(work, [1], 1))

    def test_other_errors_pass(self):
        def work(jobs):
            raise RuntimeError("shapes differ")

        with pytest.raises(RuntimeError, match="shapes differ"):
            list(in_batches(work, [1], 1))
