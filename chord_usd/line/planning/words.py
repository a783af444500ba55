"""Inputs of a network that plans floors: words of a text, and the programme behind them.

The paper conditions on one CLIP embedding of the text (supplementary, "Text-conditioned floor
planning"), which says little about numbers. Ours attends to each word's embedding and, beside
them, to a row for every kind of room with its count and a row for the area: numbers as numbers.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.wish import WISHED_KINDS, Wish

Words = npt.NDArray[np.float32]
"""(WORDS, channels): the channels of a word of the text, then PROGRAMME_CHANNELS."""

TEXT_CHANNELS = 384
"""Of a word's embedding by MiniLM, the text model that comes with the program."""

PROGRAMME_CHANNELS = 64

PROGRAMME_ROWS = len(WISHED_KINDS) + 2
TEXT_ROWS = 49
WORDS = PROGRAMME_ROWS + TEXT_ROWS

MOST_COUNTED = 12
"""Larger numbers of rooms of a kind look the same."""

_FREQUENCIES = 2.0 ** np.arange(10)
_COUNT_AT = PROGRAMME_ROWS
_AREA_AT = _COUNT_AT + MOST_COUNTED + 3


def condition_words(
    wish: Wish, text: npt.NDArray[np.float32] | None = None, text_channels: int = TEXT_CHANNELS
) -> Words:
    """The rows that stand for a wish and the text that it was read from.

    text: (N, text_channels) embeddings of the text's words, None where there is no text; what is
    beyond TEXT_ROWS is not seen.
    """
    words = np.zeros((WORDS, text_channels + PROGRAMME_CHANNELS), np.float32)
    words[:PROGRAMME_ROWS, text_channels:] = _programme(wish)
    if text is not None:
        seen = text[:TEXT_ROWS]
        words[PROGRAMME_ROWS : PROGRAMME_ROWS + len(seen), :text_channels] = seen
    return words


def _programme(wish: Wish) -> npt.NDArray[np.float32]:
    """(PROGRAMME_ROWS, PROGRAMME_CHANNELS): which row it is, then what it says; 0 says nothing."""
    rows = np.zeros((PROGRAMME_ROWS, PROGRAMME_CHANNELS), np.float32)
    rows[:, :PROGRAMME_ROWS] = np.eye(PROGRAMME_ROWS)
    for row, kind in zip(rows, WISHED_KINDS, strict=False):
        if kind in wish.counts:
            count = min(wish.counts[kind], MOST_COUNTED)
            row[_COUNT_AT + count] = 1.0
            row[_COUNT_AT + MOST_COUNTED + 1 : _AREA_AT] = 1.0, count / 4.0
    area, features = rows[-2], rows[-1]
    if wish.area_m2 is not None:
        phase = np.log(max(wish.area_m2, 1.0) / 100.0) / 4.0 * _FREQUENCIES
        area[_AREA_AT] = 1.0
        area[_AREA_AT + 1 : _AREA_AT + 21] = np.concatenate([np.sin(phase), np.cos(phase)])
        area[_AREA_AT + 21 : _AREA_AT + 23] = wish.area_m2 / 100.0, phase[0]
    features[_COUNT_AT] = float(wish.open_kitchen)
    return rows
