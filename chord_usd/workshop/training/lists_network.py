"""The list network: a small transformer that writes lists of things, one vocabulary or another.

It sees what lies around as segments and the facts about the whole, then writes categories and
elements in order (vocabulary.py). Places are coded with one grid for segments and elements, so
the tables of places start alike, from waves: to stand at a wall is to repeat its number.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.line.lists.vocabulary import NO_SEGMENT, NOTHING, Vocabulary
from chord_usd.workshop.training.transformer import Block

CHANNELS = 128
LAYERS = 4
HEADS = 4
BARRED = -1e4
"""What is added to the logit of a value that cannot stand there."""
LEAST_CHANCE = 0.06
"""Values less likely than this share of the likeliest one are not drawn."""


_ENDS = ("x", "y", "x", "y")
"""Of a segment, in vocabulary.SEGMENT_FIELDS."""


class ListNetwork(nn.Module):
    """Autoregressive over the positions of a sequence, and over the slots of each position."""

    allowed: Tensor

    def __init__(
        self,
        vocabulary: Vocabulary,
        channels: int = CHANNELS,
        layers: int = LAYERS,
        heads: int = HEADS,
    ) -> None:
        super().__init__()
        self.slots, self.layers = len(vocabulary.slots), layers
        self.heads, self.head_width = heads, channels // heads
        self.spans = [vocabulary.span(slot) for slot in range(self.slots)]
        size = vocabulary.size
        self.segment_kind = nn.Embedding(vocabulary.segments, channels)
        self.segment_place = nn.ModuleList(
            nn.Embedding(vocabulary.places(name)[1], channels) for name in _ENDS
        )
        self.facts = nn.ModuleList(nn.Embedding(count, channels) for count in vocabulary.facts)
        self.flags = nn.Linear(vocabulary.flags, channels)
        self.before = nn.ModuleList(nn.Embedding(size, channels) for _ in range(self.slots))
        self.own = nn.ModuleList(nn.Embedding(size, channels) for _ in range(self.slots - 1))
        self.role = nn.Embedding(vocabulary.roles, channels)
        self.left = nn.Embedding(vocabulary.most + 2, channels)
        self.order = nn.Embedding(2 * vocabulary.most + 2, channels)
        self.blocks = nn.ModuleList(Block(channels, heads) for _ in range(layers))
        self.hidden = nn.ModuleList(_Slot(channels) for _ in range(self.slots))
        self.norm = nn.LayerNorm(channels)
        self.head = nn.Linear(channels, size)
        self.register_buffer("allowed", torch.from_numpy(vocabulary.allowed()), persistent=False)
        for module in self.modules():
            if isinstance(module, nn.Embedding):
                nn.init.normal_(module.weight, std=0.1)
        self._start_from_waves(vocabulary, channels)

    @torch.no_grad()
    def _start_from_waves(self, vocabulary: Vocabulary, channels: int) -> None:
        """Near places look alike, and the same place alike in segments, elements and answers."""
        generator = torch.Generator().manual_seed(0)
        for name in ("x", "y"):
            first, count = vocabulary.places(name)
            span = slice(first, first + count)
            waves = _waves(count, channels) * 0.15
            self.head.weight[span] = waves @ _turn(channels, generator) * 0.3
            ends = [table for table, axis in zip(self.segment_place, _ENDS, strict=True)
                    if axis == name]  # fmt: skip
            slots = [slot for slot, other in enumerate(vocabulary.slots) if other == name]
            for nth, slot in enumerate(slots):
                turned = waves @ _turn(channels, generator)
                _weight(self.before[slot])[span] = turned
                if slot < self.slots - 1:
                    _weight(self.own[slot])[span] = turned
                if nth < len(ends):
                    _weight(ends[nth])[:] = turned

    def around(self, segments: Tensor, facts: Tensor, flags: Tensor) -> tuple[Tensor, Tensor]:
        """(B, 1 + S, channels) what lies around, and (B, 1 + S) which of it is there."""
        state: Tensor = self.flags(flags)
        for index, table in enumerate(self.facts):
            state = state + table(facts[:, index])
        lines: Tensor = self.segment_kind(segments[..., 0])
        for index, table in enumerate(self.segment_place):
            lines = lines + table(segments[..., 1 + index])
        there = functional.pad(segments[..., 0] != NO_SEGMENT, (1, 0), value=True)
        return torch.cat([state[:, None], lines], dim=1), there

    def states(
        self,
        segments: Tensor,
        facts: Tensor,
        flags: Tensor,
        roles: Tensor,
        left: Tensor,
        values: Tensor,
    ) -> Tensor:
        """(B, L, channels) what is known at each position before its own values."""
        around, there = self.around(segments, facts, flags)
        before = functional.pad(values[:, :-1], (0, 0, 1, 0))
        at = torch.arange(roles.shape[1], device=roles.device)
        state = torch.cat([around, self.inputs(roles, left, before, at)], dim=1)
        there = functional.pad(there, (0, roles.shape[1]), value=True)
        mask = _seen(state.shape[1], around.shape[1], there)
        for block in self.blocks:
            state = block(state, mask)
        out: Tensor = self.norm(state[:, around.shape[1] :])
        return out

    def inputs(self, roles: Tensor, left: Tensor, before: Tensor, at: Tensor) -> Tensor:
        """(B, L, channels) of positions. before: (B, L, slots) values of those one earlier; at:
        (L,) their places in the sequence."""
        inputs: Tensor = self.role(roles) + self.left(left) + self.order(at)
        for slot, table in enumerate(self.before):
            inputs = inputs + table(before[..., slot])
        return inputs

    def logits(self, state: Tensor, roles: Tensor, slot: int) -> Tensor:
        """(..., n) of the values in the span of one slot, from a state that knows those before."""
        first, end = self.spans[slot]
        inner = self.hidden[slot](state)
        logits = functional.linear(inner, self.head.weight[first:end], self.head.bias[first:end])
        if slot:
            return logits
        return torch.where(self.allowed[roles, slot, first:end], logits, BARRED)

    def forward(
        self,
        segments: Tensor,
        facts: Tensor,
        flags: Tensor,
        roles: Tensor,
        left: Tensor,
        values: Tensor,
    ) -> Tensor:
        """(B, L) log chance of each position's values, all before them given.

        segments: (B, S, SEGMENT_FIELDS); facts: (B, F); flags: (B, K); roles, left: (B, L);
        values: (B, L, slots).
        """
        state = self.states(segments, facts, flags, roles, left, values)
        total = torch.zeros_like(state[..., 0])
        held = values[..., 0] != NOTHING
        total = total.masked_scatter(held, self._slot_chances(state[held], roles[held],
                                                              values[held], 0))  # fmt: skip
        # Elements alone have further slots.
        held = values[..., -1] != NOTHING
        state, roles, values = state[held], roles[held], values[held]
        others = torch.zeros_like(state[..., 0])
        for slot in range(1, self.slots):
            state = state + self.own[slot - 1](values[..., slot - 1])
            others = others + self._slot_chances(state, roles, values, slot)
        return total + torch.zeros_like(total).masked_scatter(held, others)

    def _slot_chances(self, state: Tensor, roles: Tensor, values: Tensor, slot: int) -> Tensor:
        chances = self.logits(state, roles, slot).log_softmax(dim=-1)
        index = values[..., slot, None] - self.spans[slot][0]
        chosen: Tensor = chances.gather(-1, index)[..., 0]
        return chosen


class Drawing(nn.Module):
    """The same network for running: draws the values of the last position.

    What lies around and earlier positions are read once: each run gives what the next has to know.
    """

    def __init__(self, network: ListNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(
        self,
        segments: Tensor,
        facts: Tensor,
        flags: Tensor,
        roles: Tensor,
        left: Tensor,
        values: Tensor,
        noise: Tensor,
        at: Tensor,
        new: Tensor,
        there: Tensor,
        *known: Tensor,
    ) -> tuple[Tensor, ...]:
        """(B, slots) values, (B, slots) their log chances, and there and known of the next run.

        roles, left: (B, L) of the positions that are new; values: (B, 1 + L, slots) of the position
        before them, NOTHING before the first, and of them; at: (L,) their places in the sequence.
        noise: (B, slots, size), added to the logits: Gumbel noise times the temperature, BARRED for
        what may not be drawn. What the last position of values holds already is kept. Of a position
        that holds a category, only the first slot means anything.
        new: numbers of what is not known yet among the facts, the segments (B, S, SEGMENT_FIELDS)
        and the positions, in this order; S may be 0 once they are known. there: (B, P), known: of
        each layer keys and values, (B, heads, P, channels / heads) each, from the last run; P is 0
        in the first.
        """
        network = self.network
        around, present = network.around(segments, facts, flags)
        positions = network.inputs(roles, left, values[:, :-1], at)
        present = functional.pad(present, (0, roles.shape[1]), value=True)
        there = torch.cat([there, present[:, new]], dim=1)
        state = torch.cat([around, positions], dim=1)[:, new]
        # In the first run new holds all that lies around, in later ones nothing of it.
        count = state.shape[1]
        mask = _seen(there.shape[1], count - roles.shape[1], there)[:, :, -count:]
        now: list[Tensor] = []
        for layer, block in enumerate(network.blocks):
            assert isinstance(block, Block)
            state, *kept = block.continued(state, mask, known[2 * layer : 2 * layer + 2])
            now += kept
        state = network.norm(state[:, -1])
        drawn, chances = [], []
        for slot in range(network.slots):
            first, end = network.spans[slot]
            logits = network.logits(state, roles[:, -1], slot)
            slot_noise = noise[:, slot, first:end]
            possible = torch.where(slot_noise < BARRED / 2, BARRED, logits)
            likely = possible > possible.amax(dim=-1, keepdim=True) + math.log(LEAST_CHANCE)
            picked = torch.where(likely, possible + slot_noise, 4 * BARRED).argmax(dim=-1) + first
            given = values[:, -1, slot]
            picked = torch.where(given == NOTHING, picked, given)
            drawn.append(picked)
            chances.append(logits.log_softmax(dim=-1).gather(-1, picked[:, None] - first)[:, 0])
            if slot < network.slots - 1:
                state = state + network.own[slot](picked)
        return torch.stack(drawn, dim=1), torch.stack(chances, dim=1), there, *now


class _Slot(nn.Module):
    """From what is known to what one slot holds."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(channels)
        self.widen = nn.Linear(channels, 2 * channels)
        self.narrow = nn.Linear(2 * channels, channels)

    def forward(self, state: Tensor) -> Tensor:
        inner: Tensor = self.narrow(functional.gelu(self.widen(self.norm(state))))
        return state + inner


def _weight(table: nn.Module) -> Tensor:
    assert isinstance(table, nn.Embedding)
    return table.weight


def _turn(channels: int, generator: torch.Generator) -> Tensor:
    """(channels, channels) a random rotation."""
    turn: Tensor = torch.linalg.qr(torch.randn(channels, channels, generator=generator))[0]
    return turn


def _waves(count: int, channels: int) -> Tensor:
    """(count, channels) sines and cosines of a place, wavelengths from four places to all."""
    place = torch.arange(count, dtype=torch.float32)[:, None]
    steps = torch.linspace(0.0, 1.0, channels // 2)[None]
    turns = place * 2.0 * math.pi / (4.0 * (count / 2.0) ** steps)
    return torch.cat([turns.sin(), turns.cos()], dim=1)


def _seen(length: int, around: int, there: Tensor) -> Tensor:
    """(B, 1, L, L) mask of attention: positions see the surroundings and earlier positions.

    there: (B, L) what is there of both.
    """
    place = torch.arange(length, device=there.device)
    seen = (place[None] <= place[:, None]) | (place[None] < around)
    both = seen[None] & there[:, None]
    return torch.where(both, 0.0, BARRED)[:, None]
