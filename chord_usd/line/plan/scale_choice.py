"""Which of several witnesses to believe about a drawing's scale, and how well they agree."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.base.terms import with_step
from chord_usd.line.plan.paper_scale import usual_scale
from chord_usd.line.plan.placement import CHECK_SCALE
from chord_usd.line.plan.printed import Estimate

SCALE = "scale"
"""Key of Plan.extra: what Scale.report says."""

USUAL_DOOR_M = 0.8
"""Between the jambs, inside a home."""

_SAME = math.log(1.06)
"""Printed measures within this of one another say the same."""

_BELIEVABLE = math.log(1.9)
"""Walls are drawn so much thicker or thinner than usual."""

_WORTH_WARNING = math.log(1.6)
"""Witnesses farther apart than this are worth a warning."""

_APART = math.log(1.25)
"""Doors and rooms that are blended and differ by more contradict each other."""

_TORN = math.log(1.2)
"""Areas of floors that are torn say scales that differ by less."""

_CHANCE = 2 * _SAME / 4.0
"""How likely a misread measure says by chance what others do: it may be e times off, or more."""
_LEAST_NATS = 2.0
"""By so much measures that say the same must be likelier read than misread."""
_FEW = 0.5
_OUTLIER_SHARE, _OUTLIER_SPREAD = 0.15, 0.6
"""How often doors, rooms or walls are unusual, and how far their logarithms are off, then."""

_TRUST = {
    "room sizes": 3.0, "dimension lines": 2.0, "dimension chains": 2.5, "scale bar": 4.0,
    "room areas": 1.5, "floor area": 1.5, "stated scale": 4.0,
}  # fmt: skip
"""Weights in the mean. Areas are rounded, and count wardrobes in some countries only."""

_LEAST_HEARD = {"dimension chains": 3}
"""Measures of a witness that is heard beside another: a pair of numbers is rarely a chain."""

_CONFIDENCE = {"given": 1.0, "file": 1.0, "paper": 0.7, "doors": 0.6, "rooms": 0.5, "walls": 0.4}

NO_MEASURE = "the plan shows no measure"
"""Begins what is said of a plan whose doors say how large it is."""

_SPREAD = {"doors": 0.2, "walls": 0.45}
"""Standard deviation of the logarithm of what they say."""


@dataclass(frozen=True)
class Scale:
    """Metres per pixel of a drawing, and why."""

    m_per_px: float
    witness: str
    """Given, file, paper, doors, rooms, walls, or a printed measure: see printed.Estimate."""
    count: int = 1
    """How many measures speak for it."""
    agreement: float = 1.0
    """Share of that witness's measures that do; of blended witnesses, of their weight."""
    others: dict[str, float] = field(default_factory=dict)
    """Metres per pixel by every witness heard."""
    disagreement: str = ""
    """Which printed measures were not believed, and why."""

    @property
    def confidence(self) -> float:
        """From 0 to 1."""
        if self.witness in _CONFIDENCE:
            return _CONFIDENCE[self.witness]
        return min(0.98, 0.6 + 0.12 * self.count) * (0.5 + 0.5 * self.agreement)

    @property
    def is_printed(self) -> bool:
        """Whether measures that are printed say it."""
        return self.witness in _TRUST

    def _tolerance(self, name: str) -> float:
        """How far a witness may differ. Walls are drawn thick and thin; doors know better."""
        if name != "walls":
            return _WORTH_WARNING
        return math.inf if "doors" in self.others else _BELIEVABLE

    def report(self, per_picture_px: float = 1.0) -> dict[str, Any]:
        """For JSON. per_picture_px: pixels that were read, per pixel of the user's picture."""
        return {
            "mPerPx": round(self.m_per_px * per_picture_px, 6),
            "witness": self.witness,
            "measures": self.count,
            "agreement": round(self.agreement, 2),
            "confidence": round(self.confidence, 2),
            "says": {k: round(v * per_picture_px, 6) for k, v in sorted(self.others.items())},
        }

    def warnings(self) -> list[str]:
        """What a user should know of the scale."""
        if self.disagreement:
            return [f"{self.disagreement}; the scale is taken from {self.witness}: {CHECK_SCALE}"]
        if self.witness == "doors" and "rooms" in self.others:
            apart = abs(math.log(self.others["rooms"] / self.others["doors"]))
            if apart > _APART:
                return [
                    "the scale lies between what doors and the usual sizes of rooms say, which"
                    f" differ {math.exp(apart):.2f} times: {CHECK_SCALE}"
                ]
        rest = {name: math.log(v / self.m_per_px) for name, v in self.others.items()}
        differing = [
            f"{name} say {math.exp(ratio):.2f} times that"
            for name, ratio in rest.items()
            if abs(ratio) > self._tolerance(name)
        ]
        if differing and self.witness not in ("given", "file"):
            return [
                f"the scale is taken from {self.witness}, but {', '.join(differing)}: {CHECK_SCALE}"
            ]
        if self.witness in ("rooms", "walls"):
            guess = "the usual sizes of rooms" if self.witness == "rooms" else "the walls"
            reason = "no printed measure and no door gives the scale; it is a guess from"
            return [f"{reason} {guess}: {CHECK_SCALE}"]
        if self.witness == "doors":
            off = f"{_SPREAD['doors']:.0%}"
            doubt = f"{NO_MEASURE}: its scale, by doors, may be {off} off"
            return [with_step(doubt, " (<m_per_px> sets it)")]
        return []


def per_unit(report: Mapping[str, Any], units_per_px: float) -> dict[str, Any]:
    """Scale.report of a picture, for the units of the file that the picture was drawn from."""
    says = {name: round(value / units_per_px, 6) for name, value in report["says"].items()}
    return {**report, "mPerPx": round(report["mPerPx"] / units_per_px, 6), "says": says}


def choose_scale(
    printed: Sequence[Estimate],
    doors: float | None,
    walls: float,
    given: float | None = None,
    rooms: tuple[float, float] | None = None,
    paper: float | None = None,
) -> Scale:
    """The scale by the best witness: the one given, printed measures, or what doors, usual sizes of
    rooms (scene.room_areas.scale_by_rooms) and walls say together.

    All in metres per pixel. paper: of the sheet, whose usual scale is taken where it is near what
    the others say. Printed measures count where they agree with one another, or, alone,
    where the others find them believable.
    """
    unprinted = {"walls": (walls, _SPREAD["walls"])}
    if doors:
        unprinted["doors"] = doors, _SPREAD["doors"]
    if rooms:
        unprinted["rooms"] = rooms
    others = {name: value for name, (value, _) in unprinted.items()}
    for name in _TRUST:
        # The likeliest reading of a measure comes first.
        likeliest = {
            e.text: e.m_per_px for e in reversed(printed) if e.witness == name and e.is_sure
        }
        scales = list(likeliest.values())
        if len(scales) >= _LEAST_HEARD.get(name, 1):
            others[name] = float(np.median(scales))
    if given:
        return Scale(given, "given", others=others)
    rough = _together(list(unprinted.values()))
    best, is_believed = _likeliest(printed, list(unprinted.values()))
    if best is not None and is_believed:
        return replace(best, others=others)
    reason = ""
    if best is not None and best.agreement < _FEW:
        reason = f"only {best.agreement:.0%} of the printed {best.witness} agree"
    elif best is not None:
        reason = f"the printed {best.witness} are not believed"
    on_paper = paper and usual_scale(rough, paper)
    if on_paper:
        return Scale(on_paper, "paper", others=others, disagreement=reason)
    witness = next(name for name in ("doors", "rooms", "walls") if name in unprinted)
    agreement = _agreement(list(unprinted.values()), rough)
    return Scale(rough, witness, agreement=agreement, others=others, disagreement=reason)


def _together(estimates: Sequence[tuple[float, float]]) -> float:
    """The mean of what witnesses say, each as heavy as it is precise."""
    logs = np.log([value for value, _ in estimates])
    spreads = np.array([spread for _, spread in estimates])
    return float(np.exp(np.average(logs, weights=spreads**-2.0)))


def _agreement(estimates: Sequence[tuple[float, float]], blend: float) -> float:
    """How much of the weight of blended witnesses is near to what they say together."""
    logs = np.log([value for value, _ in estimates])
    spreads = np.array([spread for _, spread in estimates])
    weights = spreads**-2.0
    return float(weights[np.abs(logs - math.log(blend)) <= _APART].sum() / weights.sum())


def _likeliest(
    printed: Sequence[Estimate], unprinted: Sequence[tuple[float, float]]
) -> tuple[Scale | None, bool]:
    """The scale that most likely explains what is printed beside what doors, rooms and walls say,
    and whether the measures for it are likelier read than misread. None without any measure."""
    if not printed:
        return None, False
    logs = np.log([e.m_per_px for e in printed])
    weights = np.array([_TRUST[e.witness] * (1.0 if e.is_sure else 0.5) for e in printed])
    near = np.abs(logs[:, None] - logs[None, :]) < _SAME
    nats = np.array([_nats_read(printed, is_near) for is_near in near])
    total = nats + [_nats_unprinted(unprinted, log) for log in logs]
    # Of those as likely, the middle of the measures.
    best = int(np.lexsort((-(near @ weights), -np.round(total, 6)))[0])
    aside = max(_nats_unprinted(unprinted, math.log(value)) for value, _ in unprinted)
    is_believed = bool(nats[best] >= _LEAST_NATS and total[best] >= aside)
    middle = _middle_of(printed, best, logs)
    return middle or _cluster(printed, near[best], logs, weights), is_believed


def _middle_of(printed: Sequence[Estimate], best: int, logs: FloatArray) -> Scale | None:
    """The middle of areas of which each says another scale, but not a far one: floors that are torn
    make one too large and the next too small. None where another measure says what the best does.
    """
    area = printed[best]
    differ = np.abs(logs - logs[best])
    alike = {e.text for e, off in zip(printed, differ, strict=True) if off < _SAME}
    beside = {
        e.text: log
        for e, log, off in zip(printed, logs, differ, strict=True)
        if e.witness == area.witness and e.choices == 1 and off < _TORN
    }
    if area.witness != "room areas" or alike != {area.text} or len(beside) < 2:
        return None
    apart = math.exp(max(beside.values()) - min(beside.values()))
    said = {e.text for e in printed if e.witness == area.witness}
    center = math.exp(float(np.mean(list(beside.values()))))
    reason = f"the printed {area.witness} say scales that differ {apart:.2f} times"
    return Scale(center, area.witness, 1, 1 / len(said), disagreement=reason)


def _nats_read(printed: Sequence[Estimate], is_in: BoolArray) -> float:
    """By how much likelier measures that say the same are read than misread: of each witness, k of
    n agree, which by chance happens with _CHANCE each."""
    total = 0.0
    for witness in {e.witness for e in printed}:
        said = {e.text for e in printed if e.witness == witness}
        agree = {
            e.text: e
            for e, belongs in zip(printed, is_in, strict=True)
            if belongs and e.witness == witness
        }
        if not agree:
            continue
        share = len(agree) / len(said)
        missing = len(said) - len(agree)
        nats = sum(math.log(share / (_CHANCE * e.choices)) for e in agree.values())
        nats += missing * math.log(1 - share) if missing else 0.0
        sure = (1 + sum(e.is_sure for e in agree.values()) / len(agree)) / 2
        total += sure * max(nats, 0.0)
    return total


def _nats_unprinted(unprinted: Sequence[tuple[float, float]], log: float) -> float:
    """How likely doors, rooms and walls are at a scale: mostly usual, and now and then unusual."""
    total = 0.0
    for value, spread in unprinted:
        off = math.log(value) - log
        usual = (1 - _OUTLIER_SHARE) / spread * math.exp(-0.5 * (off / spread) ** 2)
        outlying = _OUTLIER_SHARE / _OUTLIER_SPREAD * math.exp(-0.5 * (off / _OUTLIER_SPREAD) ** 2)
        total += math.log(usual + outlying + 1e-12)
    return total


def _cluster(
    printed: Sequence[Estimate], is_in: BoolArray, logs: FloatArray, weights: FloatArray
) -> Scale:
    """The scale of measures that say the same, by the witness that says most of it."""
    center = float(np.exp(np.average(logs[is_in], weights=weights[is_in])))
    names = [printed[i].witness for i in np.flatnonzero(is_in)]
    witness = max(set(names), key=lambda n: (names.count(n) * _TRUST[n], n))
    said = {e.text for e in printed if e.witness == witness}
    agreeing = {(printed[i].witness, printed[i].text) for i in np.flatnonzero(is_in)}
    own_words = sum(name == witness for name, _ in agreeing)
    return Scale(center, witness, len(agreeing), own_words / len(said))
