"""What is asked for in a room after an edit: what was asked before, and what the edit asks for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.intents import Intent
from chord_usd.base.scene.palette import category
from chord_usd.line.lists.vocabulary import Named
from chord_usd.line.lists.wishes import Wishes, read_pieces


def kept_requests(
    before: str, intents: Iterable[Intent], then: Sequence[str], now: Sequence[str]
) -> str:
    """The requests of a room, in words; "" for none.

    before: those that it had. intents: what was done in it. then, now: categories of its furniture
    before and after. Nothing stays that the edit went against. A piece that is added is asked for
    beside those of its kind that stood there, so that a room furnished again has as many.
    """
    kept = read_pieces(before).without_lost(then, now) if before else Wishes()
    wanted, excluded, has = list(kept.wanted), list(kept.excluded), Counter(now)
    for intent in intents:
        if intent.new is None or not (asked := _asked(intent.new.word)):
            continue
        if intent.action == "remove":  # "no desk in here"
            wanted = [piece for piece in wanted if piece.category != asked.category]
            excluded += [asked] if asked.category not in {p.category for p in excluded} else []
        elif intent.action == "add" or asked.category not in then:
            excluded = [piece for piece in excluded if piece.category != asked.category]
            asks = sum(piece.category == asked.category for piece in wanted) + intent.count
            usual = _asked(category(asked.category).label.lower()) or asked
            wanted += [asked] * intent.count + [usual] * (has[asked.category] - asks)
    return Wishes(tuple(wanted), tuple(excluded)).in_words()


def _asked(word: str) -> Named | None:
    """The piece of furniture that a word names; None where requests know none."""
    with suppress(ChordError):
        return next(iter(read_pieces(word).wanted), None)
    return None
