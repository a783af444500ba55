"""What somebody does with a sentence: orders a change, states what is so, or asks. English.

Only orders change a house. The head of a clause decides, as far as its first verb: an imperative
has no subject before it; wishes and duties ("I want", "the hall needs", "it should") order, too;
other verbs after a subject state something; an auxiliary before its subject asks. A clause without
a verb does what the clause before it does, and alone it orders: "no rug in the hall".
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Literal

from chord_usd.line.lists.edit_words import WISHES, Token

Act = Literal["order", "statement", "question"]

_BE = frozenset(("is", "are", "am", "was", "were", "isnt", "arent", "wasnt", "werent"))
_HAVE = frozenset(("have", "has", "had", "havent", "hasnt"))
_DO = frozenset(("do", "does", "did", "doesnt", "didnt"))
_DUTIES = frozenset((
    "should", "shall", "must", "ought to", "has to", "have to", "needs to", "need to", "is to",
    "are to",
))  # fmt: skip
_CHANCES = frozenset(("can", "could", "may", "might", "will", "would"))
_ASKING = frozenset((
    "what", "where", "which", "who", "whose", "why", "how", "when", "whether",
))  # fmt: skip
_REQUESTS = frozenset(("could you", "can you", "would you", "will you"))
_SPEAKERS = frozenset(("i", "we"))
_OTHERS = frozenset(("you", "he", "she", "they", "somebody", "someone", "everybody", "nobody"))
_STATES = frozenset((
    "stand", "stands", "hang", "face", "faces", "look at", "look out of", "look out", "look to",
    "look towards", "look toward", "point at", "point to", "point towards",
))  # fmt: skip
"""Verbs that say how a piece is, where the piece is their subject."""

_ENDS = frozenset(".!?;\n")
_PAST: dict[Literal["undo", "redo"], str] = {
    "undo": r"(undo|revert|go back|take (that|it) back|put (it|that|everything) back|never ?mind"
    r"|undo (that|this|it|the last (change|one|edit|step)|my last change)"
    r"|revert (that|this|it|the last change)|(put|change|turn) it back( the way it was)?)",
    "redo": r"(redo|redo (that|this|it)|do (that|it) again)",
}


def past_asked(sentence: str) -> Literal["", "undo", "redo"]:
    """Whether a sentence asks for the history of a house, and not for something new."""
    said = re.sub(r"[^\w ]|\b(please|can you|could you|now|ok|okay|just)\b", "", sentence.lower())
    said = " ".join(said.split())
    return next((verb for verb, words in _PAST.items() if re.fullmatch(words, said)), "")


def acts_of(tokens: Sequence[Token]) -> list[Act]:
    """What each part of a sentence does: of the parts that its "and" tokens separate."""
    acts: list[Act] = []
    before: Act = "order"
    for parts, end in _sentences(tokens):
        asks = end == "?" and not any(_requests(part) for part in parts)
        for part in parts:
            before = "question" if asks else _act(part) or before
            acts.append(before)
    return acts


def separates(token: Token, part: Sequence[Token]) -> bool:
    """Whether a token ends a part; "and" between two anchors of "between" does not."""
    if token.kind != "and":
        return False
    at = next((n for n, token in enumerate(part) if token.value == "between"), None)
    anchors = () if at is None else [token for token in part[at:] if token.kind in _PLACES]
    return not (len(anchors) == 1 and token.said in ("and", "&", "+"))


_PLACES = ("thing", "feature", "room")


def _sentences(tokens: Sequence[Token]) -> Iterator[tuple[list[list[Token]], str]]:
    """Parts of each sentence, and the mark at its end."""
    parts: list[list[Token]] = [[]]
    for token in tokens:
        if not separates(token, parts[-1]):
            parts[-1].append(token)
            continue
        if token.said in _ENDS:
            yield parts, token.said
            parts = []
        parts.append([token] if token.said == "so that" else [])
    yield parts, ""


def _requests(part: Sequence[Token]) -> bool:
    """Whether a part is a request in the form of a question."""
    said = [token.said for token in part]
    if "please" in said or "kindly" in said:
        return True
    polite = any(token in _REQUESTS and said[at + 1 : at + 2] != ["like"]
                 for at, token in enumerate(said))  # fmt: skip
    pairs = pairwise(said)
    return polite or any(a in ("can", "could", "may") and b in _SPEAKERS for a, b in pairs)


def _act(part: Sequence[Token]) -> Act | None:
    """What the head of a part says; None where it has no verb, or is a purpose ("so that")."""
    if part and part[0].said == "so that":
        return None
    if _requests(part):
        return "order"
    head = _Head()
    for at, token in enumerate(part):
        following = part[at + 1] if at + 1 < len(part) else Token("", "", "")
        act = head.act_at(token, following)
        if act:
            return act
        head.take(token)
    return None


class _Head:
    """What was said before the verb."""

    def __init__(self) -> None:
        self.is_first = True
        """Whether nothing but politeness was said."""
        self.subject: Literal["", "speaker", "other", "piece", "there"] = ""
        self._is_governed = False

    def take(self, token: Token) -> None:
        """Note a token that is no verb."""
        if token.kind in ("prep", "relation", "with"):
            self._is_governed = True
        elif token.kind in (*_PLACES, "it"):
            self.subject = self.subject if self._is_governed else "piece"
            self._is_governed = False
        elif token.said in _SPEAKERS:
            self.subject = "speaker"
        elif token.said in _OTHERS:
            self.subject = "other"
        elif token.kind == "there":
            self.subject = "there"
        self.is_first = self.is_first and token.kind == "" and not self.subject

    def act_at(self, token: Token, following: Token) -> Act | None:
        """What the clause does if this token is its verb; None where it is none."""
        said = token.said
        if self.is_first and (said in _ASKING or said in _BE or said in ("has", "had")):
            return "question"
        if said in _BE or (said == "like" and self.subject in ("speaker", "other")):
            return "statement"
        if said in _HAVE:
            inverted = following.said in _SPEAKERS | _OTHERS or following.kind == "it"
            if self.is_first:
                return "question" if inverted else "order"
            return "statement" if self.subject else None
        if said in _DO:
            if not self.is_first:
                return "statement"
            return None if following.kind == "verb" else "question"
        if said in _DUTIES:
            return "question" if self.is_first else "order"
        if said in _CHANCES:
            return "question" if self.is_first else (
                "order" if self.subject == "other" else "statement"
            )  # fmt: skip
        return self._of_verb(token, following) if token.kind in ("verb", "particle") else None

    def _of_verb(self, token: Token, following: Token) -> Act | None:
        if token.value == "dislike":
            return "statement"
        if token.said in WISHES:
            needless = token.said in ("need", "needs") and following.kind == "no"
            return "statement" if needless else "order"
        if token.kind == "particle":
            return None
        if self.subject in ("speaker", "other"):
            return "statement"
        if self.subject and token.said in _STATES:
            return "statement"
        return "order"
