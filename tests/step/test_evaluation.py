"""Evaluations of the layout model: exact where the answer is known, and sound on a tiny model."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics import score_scene
from chord_usd.base.metrics.scores import Score
from chord_usd.base.raster import canvas
from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.types import Provenance
from chord_usd.line.layout.checkpoint import Checkpoint
from chord_usd.line.layout.config import PRESETS
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.outlier import NoiseError
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.workshop.evaluation import (
    diversity,
    layout_report,
    layouts,
    ood,
    ood_worst,
    realism,
    report,
    speed,
)
from chord_usd.workshop.evaluation.cases import Case, folder_cases, procedural_cases
from chord_usd.workshop.evaluation.collisions import collide, displace
from chord_usd.workshop.evaluation.report import framed

TINY = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, True), feature_channels=16,
    default_steps=2,
)  # fmt: skip


@pytest.fixture(scope="module")
def network_model():
    """A model that was never trained: its pictures are noise."""
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    return LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))


class Drawer:
    """A model that paints what the furnisher would, another choice for each seed."""

    device = "cpu"
    config = TINY
    checkpoint = Checkpoint(None, TINY, "hash", {})  # type: ignore[arg-type]

    def __init__(self, cases):
        self._cases = {canvas.draw_plan(case.plan).rgb.tobytes(): case for case in cases}

    def sample(self, image, *, seed=0, **options):
        return self.sample_batch([image], seeds=[seed], **options)[0]

    def sample_batch(self, images, *, seeds, steps=None, sampler=None, drafts=()):
        return [self._draw(image, seed) for image, seed in zip(images, seeds, strict=True)]

    def _draw(self, image, seed):
        scene = self._cases[image.rgb.tobytes()].truth(seed)
        made = Provenance(checkpoint_hash="hash", seed=seed)
        return replace(canvas.layout_image(image, scene.items), provenance=made)


@pytest.fixture(scope="module")
def model(cases):
    return Drawer(cases)


@pytest.fixture(scope="module")
def cases():
    return procedural_cases("test", 2).cases


class TestCases:
    def test_test_and_training_houses_are_others_and_named(self, cases):
        train = procedural_cases("train", 2)
        assert not {case.id for case in cases} & {case.id for case in train.cases}
        assert procedural_cases("test", 2).split != train.split
        assert procedural_cases("test", 1, start=1).cases[0].id == cases[1].id

    def test_broken_files_are_skipped_counted_and_listed(self, furnished_house, tmp_path):
        write_scene(furnished_house, tmp_path / "good.json")
        (tmp_path / "broken.json").write_text('{"rooms": [')
        (tmp_path / "empty.json").write_text("{}")
        found = folder_cases(tmp_path, "all")
        assert [case.id for case in found.cases] == ["good"]
        assert len(found.skipped) == 2
        assert found.warnings[0] == "2 files skipped:"
        assert any("broken.json" in line for line in found.warnings)

    def test_a_folder_of_broken_files_is_an_error(self, tmp_path):
        (tmp_path / "broken.json").write_text("no")
        with pytest.raises(SceneError, match=r"holds no house.*1 of them broken"):
            folder_cases(tmp_path, "all")


class TestSpoiling:
    @pytest.fixture
    def house(self):
        return Case("house", procedural_cases("test", 1).cases[0].plan).truth()

    def test_every_moved_piece_overlaps_inside_its_room(self, house):
        spoilt = collide(house, np.random.default_rng(0), per_room=2)
        assert spoilt.moved
        overlapping = {
            name
            for pair in score_scene(spoilt.scene).overlap.overlapping
            if not pair.natural
            for name in (pair.a, pair.b)
        }
        assert set(spoilt.moved) <= overlapping
        rooms = {room.id: room_polygon(room).buffer(1e-6) for room in house.rooms}
        before = {item.id: item for item in house.items}
        for item in spoilt.scene.items:
            if item.id in spoilt.moved:
                assert rooms[item.room_id].covers(footprint_polygon(item.box))
                assert item.box.size_m == before[item.id].box.size_m
            else:
                assert item == before[item.id]

    def test_the_control_touches_nothing(self, house):
        moved = displace(house, np.random.default_rng(0))
        assert moved.moved
        assert score_scene(moved.scene).overlap.por <= score_scene(house).overlap.por


class TestDistances:
    def test_the_frechet_distance_is_that_of_its_definition(self):
        from scipy.linalg import sqrtm

        rng = np.random.default_rng(0)
        a, b = rng.normal(size=(80, 4)), rng.normal(0.5, 2.0, size=(60, 4))
        covariances = np.cov(a.T), np.cov(b.T)
        expected = ((a.mean(0) - b.mean(0)) ** 2).sum() + np.trace(
            sum(covariances) - 2 * sqrtm(covariances[0] @ covariances[1]).real
        )
        assert realism.frechet_distance(a, b) == pytest.approx(expected)

    def test_distances_vanish_between_equals_and_grow_with_the_shift(self):
        rng = np.random.default_rng(0)
        a, b = rng.normal(size=(200, 8)), rng.normal(size=(200, 8))
        assert realism.frechet_distance(a, a) == pytest.approx(0.0, abs=1e-9)
        for distance in (realism.frechet_distance, realism.kernel_distance):
            values = [distance(a, b + shift) for shift in (0.0, 0.5, 1.0)]
            assert values[0] < values[1] < values[2]
        assert abs(realism.kernel_distance(a, b)) < 0.1

    def test_a_room_is_cut_out_with_its_walls_only(self, cases):
        (one,) = layouts.drawn(cases[:1], layouts.Sampling())
        cut = realism.room_picture(one, one.case.plan.rooms[0])
        assert cut.shape[0] == cut.shape[1] <= 256
        assert (cut == 0).all(axis=2).any(), "walls"


class MeanColour:
    """An encoder by which a picture is its mean colour."""

    name = "MeanColour"

    def features(self, pictures):
        return np.array([rgb.mean(axis=(0, 1)) for rgb in pictures]).reshape(-1, 3)


class TestRealismByPart:
    def by_part(self, generated, cases):
        real = list(layouts.drawn(cases, layouts.Sampling())) * 5
        return realism.realism_by_part(
            generated * 5, real, real[::-1], MeanColour(), layouts.Sampling()
        )

    def test_ragged_pictures_are_farther_off_than_what_is_read_from_them(self, furnished, cases):
        def ragged(one):
            rgb = one.image.rgb.copy()
            rgb[::3] = 200
            return replace(one, image=replace(one.image, rgb=rgb))

        clean, torn = (
            self.by_part(part, cases) for part in (furnished, [ragged(one) for one in furnished])
        )
        assert torn["house"].fid > clean["house"].fid
        assert torn["house, as read"].fid == pytest.approx(clean["house, as read"].fid)
        assert torn["house, as read"].fid_floor == torn["house"].fid_floor
        assert {"bedroom", "bedroom, as read"} <= set(torn)

    def test_what_no_model_painted_has_one_row(self, cases):
        found = self.by_part(list(layouts.drawn(cases, layouts.Sampling(seed=1))), cases)
        assert "house" in found
        assert not any("as read" in part for part in found)


@pytest.fixture(scope="module")
def furnished(model, cases):
    return list(layouts.sampled(model, cases, layouts.Sampling(seed=1)))


class TestLayouts:
    def test_every_case_gets_its_layout_in_order(self, furnished, cases):
        assert [one.case.id for one in furnished] == [case.id for case in cases]
        assert [one.image.provenance.seed for one in furnished] == [1, 2]

    def test_memory_that_ends_is_told_and_changes_nothing(self, model, cases, monkeypatch):
        usual = list(layouts.sampled(model, cases, layouts.Sampling(seed=1)))
        sample_batch = model.sample_batch

        def small(images, **options):
            if len(images) > 1:
                raise torch.OutOfMemoryError("CUDA out of memory")
            return sample_batch(images, **options)

        monkeypatch.setattr(model, "sample_batch", small)
        told = []
        found = list(layouts.sampled(model, cases, layouts.Sampling(seed=1), warn=told.append))
        assert told == ["out of memory: went on with a batch of 4", *told[1:]]
        for one, other in zip(found, usual, strict=True):
            assert (one.image.rgb == other.image.rgb).mean() > 0.99

    def test_the_furnisher_is_perfect_and_its_table_complete(self, cases):
        sampling = layouts.Sampling()
        drawn = list(layouts.drawn(cases, sampling))
        scores = layouts.score_layouts(drawn, "furnisher", sampling)
        assert scores.rows["house"]["por"].value == 0.0
        text = layout_report.as_markdown(scores)
        assert scores.split in text
        for name in scores.rows["house"]:
            assert f"| {name} |" in text
        assert "| CHOrD on its own data | house | 0.0125 | 0.0007 |" in text
        json.dumps(layout_report.as_data(scores))
        assert layout_report.plot(scores).startswith(b"\x89PNG")

    def test_a_missed_target_says_by_how_much(self, cases):
        sampling = layouts.Sampling()
        scores = layouts.score_layouts(list(layouts.drawn(cases, sampling)), "x", sampling)
        scores.rows["house"]["por"] = Score(0.007, 2, "scenes")
        assert layout_report.missed(scores)["house/por"] == pytest.approx(0.002)

    def test_plans_are_read_back_from_the_pictures(self, furnished):
        scores = layouts.score_layouts(furnished, "hash", layouts.Sampling(steps=2))
        assert scores.rows["house"]["plan_walls_f1"].value > 0.99
        assert scores.rows["house"]["plan_doors_f1"].count > 0


@pytest.fixture(scope="module")
def ood_scores(network_model, cases):
    return ood.measure_ood(NoiseError(network_model), cases[:1], draws=2)


class TestOod:
    def test_the_papers_range_is_that_of_ddpm(self):
        low, high = ood.paper_noise_to_signal()
        assert low == pytest.approx(59, abs=2)
        assert high == pytest.approx(157, abs=1)

    def test_the_report_holds_what_was_measured(self, ood_scores):
        assert ood_scores.houses == 1
        assert ood_scores.moved > 0
        assert ood_scores.piou_colliding > ood_scores.piou_clean
        assert 0.0 <= ood_scores.item_auc <= 1.0
        assert [gap.draws for gap in ood_scores.ranges.values()] == [2, 2]
        assert len(ood_scores.curve) == ood.LEVELS
        assert "+32.22%" in ood.as_markdown(ood_scores)
        json.dumps(ood.as_data(ood_scores))
        assert ood.plot(ood_scores).startswith(b"\x89PNG")

    def test_a_gap_is_a_share_of_the_clean_error(self):
        gap = ood.Gap(2.0, 3.0, 2.5, (1.0, 2.0), 10)
        assert (gap.of_colliding, gap.of_displaced) == (0.5, 0.25)

    def test_bare_houses_cannot_collide(self, network_model, furnished_house):
        bare = replace(furnished_house, items=())
        with pytest.raises(SceneError, match="no piece"):
            ood.measure_ood(NoiseError(network_model), [Case("bare", bare.plan, bare)], draws=1)

    def test_the_worst_are_those_with_the_highest_piou(self, network_model):
        clean, *others = procedural_cases("test", 4).cases
        errors = NoiseError(network_model)
        each = [
            ood_worst.measure_worst(errors, [clean, own], 1, draws=1).piou_colliding
            for own in others
        ]
        scores = ood_worst.measure_worst(errors, [clean, *others], 1, draws=1)
        assert (scores.houses, scores.out_of) == (1, 3)
        assert scores.piou_colliding == max(each) > scores.piou_clean
        assert "+32.22%" in ood_worst.as_markdown(scores)
        json.dumps(ood_worst.as_data(scores))


@pytest.fixture(scope="module")
def speed_scores(model, cases):
    return speed.measure_speed(model, cases[:1], layouts.Sampling(), (1, 3), ("ddim", "dpm"))


class TestSpeed:
    def test_every_sampler_runs_at_every_number_of_steps(self, speed_scores):
        runs = [(run.sampler, run.steps) for run in speed_scores.runs]
        assert runs == [("ddim", 1), ("ddim", 3), ("dpm", 1), ("dpm", 3)]
        assert all(run.seconds > 0 and run.cpu_seconds > 0 for run in speed_scores.runs)
        assert [run.same_pixels for run in speed_scores.runs if run.steps == 3] == [1.0, 1.0]
        assert "| ddim | 3 |" in speed.as_markdown(speed_scores)
        assert speed.plot(speed_scores).startswith(b"\x89PNG")

    def test_the_fewest_steps_are_those_that_lose_nothing(self, speed_scores):
        def run(steps, por):
            good = {name: Score(0.0, 100, "") for name in speed.SCORES}
            return replace(
                speed_scores.runs[0], steps=steps, cpu_seconds=steps,
                scores={**good, "por": Score(por, 100, "")},
            )  # fmt: skip

        runs = (run(5, 0.02), run(10, 0.0102), run(50, 0.01))
        assert speed.fewest_steps(replace(speed_scores, runs=runs)) == ("ddim", 10)


class TestDiversity:
    def test_layouts_of_one_seed_are_one_and_of_others_differ(self, furnished_house):
        items = furnished_house.items
        assert diversity.item_iou(items, items) == pytest.approx(1.0)
        assert diversity.item_iou(items, ()) == 0.0
        assert diversity.item_iou((), ()) == 1.0
        room = list(furnished_house.items_of(items[0].room_id))
        assert diversity.arrangements([room, room, room]) == 1
        assert diversity.arrangements([room, [], room[:1]]) >= 2

    def test_a_sheet_has_a_row_per_plan(self, model, cases):
        scores, sheet = diversity.measure_diversity(
            model, cases[:1], layouts.Sampling(steps=1), seeds=2
        )
        assert scores.seeds == 2
        assert len(scores.plans) == 1
        assert 0.0 <= scores.item_iou <= 1.0
        assert sheet.shape == (516, 2 * 516, 3)
        assert "| mean |" in diversity.as_markdown(scores)

    def test_rasters_of_large_houses_go_on_one_sheet_with_small_ones(self):
        rows = [
            [SimpleNamespace(image=SimpleNamespace(rgb=np.zeros((side, side, 3), np.uint8)))]
            for side in (256, 320)
        ]
        picture = diversity.sheet(rows, enlarge=1)
        small, large = (framed(row[0].image.rgb).shape for row in rows)
        assert picture.shape == (small[0] + large[0], large[1], 3)
        assert (picture[: small[0], small[1] :] == 255).all()


def test_a_report_is_three_files(tmp_path):
    text = report.markdown_table(["a", "b"], [["1", "2"]])
    paths = report.write_report(tmp_path / "x" / "scores.md", text, {"a": 1}, {"": b"png"})
    assert sorted(path.name for path in paths) == ["scores.json", "scores.md", "scores.png"]
    assert json.loads((tmp_path / "x" / "scores.json").read_text()) == {"a": 1}
