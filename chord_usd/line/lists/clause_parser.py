"""Tokens -> clauses, each with one verb and what goes with it.

Every word has to have a part in its clause: what has none makes the whole sentence not understood.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from chord_usd.line.lists.clauses import Clause, Noun, not_understood
from chord_usd.line.lists.coat_words import coat
from chord_usd.line.lists.edit_words import (
    ONE,
    WISHES,
    Thing,
    Token,
)
from chord_usd.line.lists.speech_acts import Act, separates

_PARTED = {
    "out": ("take", "get", "bring", "carry", "move", "put"),
    "away": ("take", "get", "bring", "carry", "move", "put", "give", "send"),
    "down": ("take", "get", "bring"),
}
"""Verbs that mean to remove together with a word that may stand after their object."""
_OF_NOUNS = {
    "no": "is_denied", "every": "is_every", "only": "is_only", "the": "is_definite",
    "other": "is_other", "size": "size", "form": "form",
}  # fmt: skip
"""What words before a noun say of it."""
_EXCHANGES = ("replace", "swap", "change")


def clauses_in(read: Iterable[Token], acts: Iterable[Act]) -> Iterator[Clause]:
    """Clauses between commas and "and"; a verb after a verb with its object begins one, too."""
    parser, act_of_part = _Parser(), iter(acts)
    act, part = next(act_of_part), list[Token]()
    for token in read:
        if separates(token, part):
            yield from parser.ended(act)
            act, part = next(act_of_part), []
            continue
        part.append(token)
        if token.kind == "and":
            parser.goes_on()
            continue
        if token.kind == "verb" and parser.is_full(token):
            yield from parser.ended(act)
        parser.take(token)
    yield from parser.ended(act)


def joined(clauses: list[Clause]) -> list[Clause]:
    """Clauses, with both halves of a swap in one."""
    parsed: list[Clause] = []
    for clause in clauses:
        before = parsed[-1] if parsed else Clause()
        is_end = clause.verb == "swap" and before.verb in ("", "weak") and before.nouns
        is_half = before.verb == "swap" and len(before.nouns) == 1 and not clause.verb
        if is_end or is_half:
            _take_over(before, clause)
        else:
            parsed.append(clause)
    return parsed


def _take_over(before: Clause, clause: Clause) -> None:
    before.verb, before.verb_said = "swap", "swap"
    before.said += ["and", *clause.said]
    before.nouns += clause.nouns
    before.rooms += clause.rooms
    before.is_there = before.is_there or clause.is_there


class _Parser:
    """One clause while its words are read."""

    def __init__(self) -> None:
        self._begin()

    def _begin(self) -> None:
        self.clause = Clause()
        self.next = Noun(Thing("", ()), "")
        self.prep = self.pending = ""
        self.number: float | None = None
        self.is_meant = False
        """Whether more than politeness was said."""

    def is_full(self, token: Token) -> bool:
        """Whether a verb belongs to the next clause."""
        verb = self.clause.verb
        return bool(verb and verb != "weak" and token.value != "weak" and not self.clause.is_bare
                    and not self._is_wished
                    and token.said not in ("up", "face", "get"))  # fmt: skip

    @property
    def _is_wished(self) -> bool:
        """Whether what is wished is about to be said: "I want the sofa to"."""
        return self.clause.verb_said in WISHES and self.prep == "to"

    def goes_on(self) -> None:
        """Read the next noun as one more anchor."""
        self.pending = "between"

    def ended(self, act: Act) -> Iterator[Clause]:
        clause = self.clause
        clause.act = act
        clause.coat = self.next.coat or clause.coat
        if clause.coat and clause.verb in _EXCHANGES:
            self.pending = ""  # "replace the carpet with oak"
        if self.number is not None:
            clause.number = self.number
        if self.pending in ("around",) and clause.verb == "turn":
            clause.degrees, self.pending = 180.0, ""
        if self.pending == "for" or (self.pending and not clause.is_bare):
            clause.relation = clause.relation or self.pending
        leaves = any(prep == "from" for prep, _ in clause.rooms)
        stays = clause.relation or clause.way or any(prep == "to" for prep, _ in clause.rooms)
        if leaves and not stays and clause.verb_said in _PARTED["out"]:
            clause.verb = "remove"  # "take the sofa out of the living room"
        if self.is_meant:
            yield clause
        self._begin()

    def take(self, token: Token) -> None:
        clause = self.clause
        clause.said.append(token.said)
        self.is_meant = self.is_meant or token.kind != ""
        if token.kind in _OF_NOUNS:
            setattr(self.next, _OF_NOUNS[token.kind], token.value or True)
        else:
            getattr(self, f"on_{token.kind}", lambda _: None)(token)

    def on_verb(self, token: Token) -> None:
        if not self.clause.verb or self.clause.verb == "weak" or self._is_wished:
            self.clause.verb, self.clause.verb_said = token.value, token.said
            self.prep = ""
        elif token.value == "face" and self.clause.verb in ("turn", "flip", "move"):
            self.clause.verb, self.prep = "face", ""  # "turn the chair to face the window"
        elif token.value != "weak" and self.clause.verb != token.value:
            raise not_understood(
                self.clause.words, f"'{self.clause.verb_said}' and '{token.said}' at once",
                "one thing to do between two commas",
            )  # fmt: skip

    def on_particle(self, token: Token) -> None:
        clause = self.clause
        if clause.verb in ("", "weak") or clause.verb_said in _PARTED[token.said]:
            clause.verb, clause.verb_said = "remove", f"{clause.verb_said} {token.said}".strip()
        elif clause.verb != "remove":
            raise not_understood(clause.words, f"'{token.said}' after '{clause.verb_said}'")

    def on_thing(self, token: Token) -> None:
        assert token.thing is not None
        is_floor = "floor" in self.clause.surfaces or not (self.clause.nouns or self.next.count)
        if token.said == "carpet" and is_floor and self.clause.verb in ("change", "put", "weak"):
            self.on_feature(Token("feature", "floor", token.said))
            self.clause.coat = coat(["carpeting"])
            return
        self._own(token.thing, token.said)

    def on_one(self, token: Token) -> None:
        self._own(ONE, token.said)

    def _own(self, thing: Thing, said: str) -> None:
        token = self.next
        token.thing, token.said = thing, said
        token.count = token.count if self.number is None else self.number
        self.number, self.next = None, Noun(Thing("", ()), "")
        self._noun(token)

    def _noun(self, noun: Noun | str) -> None:
        clause = self.clause
        is_for = self.pending == "for" or (self.prep == "to" and clause.verb == "change")
        if is_for and clause.verb in _EXCHANGES and isinstance(noun, Noun):
            clause.swapped_for = len(clause.nouns)
            self.pending = self.prep = ""
        if noun in ("wall", "floor") and not (self.pending or self.prep in ("to", "in", "from")):
            clause.surfaces.append(noun)
            self.prep = ""
            return
        if self.pending or (isinstance(noun, str) and self.prep in ("to", "of", "in", "from")):
            if clause.anchors and self.pending != "between":
                raise not_understood(clause.words, "two places at once")
            clause.relation = self._relation()
            if noun == "window" and clause.relation == "under":
                clause.relation = "by"  # as low as the sill, wherever it stands by a window
            clause.anchors.append(noun)
            self.pending = self.prep = ""
        elif isinstance(noun, str):
            if clause.verb != "face":
                raise not_understood(clause.words, f"{noun}s stay as they are")
            clause.anchors.append(noun)
        elif self.prep == "to" or (clause.verb == "face" and (clause.nouns or clause.is_it)):
            clause.relation, self.prep = clause.relation or "by", ""
            clause.anchors.append(noun)
        elif self.prep == "of" and clause.nouns:
            self.prep = ""  # "a vase of flowers"
        elif self.prep == "in" and not self.clause.coat:
            raise not_understood(
                clause.words, f"nothing can be put in or on '{noun.said}'", "a room, or 'next to'"
            )
        else:
            clause.nouns.append(noun)
            if self.prep == "of":
                self.prep = ""

    def _relation(self) -> str:
        return {"for": "by", "around": "by", "": "by"}.get(self.pending, self.pending)

    def on_feature(self, token: Token) -> None:
        if self.next.coat and self.clause.verb in (*_EXCHANGES, "paint", "add", "put", "weak", ""):
            self.pending = self.prep = ""  # "replace it with oak floors"
        self.clause.coat = self.next.coat or self.clause.coat
        self.next = Noun(Thing("", ()), "")
        self._noun(token.value)

    def on_room(self, token: Token) -> None:
        if self.pending:
            if self.pending not in ("for", "nearer to"):
                raise not_understood(
                    self.clause.words, f"'{self.pending}' a room", "a piece, a window or a door"
                )
            self.prep, self.pending = "to", ""
        self.clause.rooms.append((self.prep, token.value))
        self.next.is_definite = False
        self.prep = ""
        if self.next.is_every:
            self.clause.rooms[-1] = ("", f"every {token.value}")
            self.next.is_every = False

    def on_relation(self, token: Token) -> None:
        is_for = token.said == "by" and self.clause.verb in _EXCHANGES
        if token.said == "by" and self.clause.scale:
            return  # by 20 %
        self.pending = "for" if is_for else token.said if token.said in ("for", "around") else (
            token.value
        )  # fmt: skip

    def on_prep(self, token: Token) -> None:
        if token.said == "into" and self.clause.verb == "turn":
            raise not_understood(self.clause.words, "nothing turns into something else")
        self.prep = token.value
        self.clause.coat = self.clause.coat or self.next.coat  # "brown leather on the sofa"
        self.next.coat = None

    def on_number(self, token: Token) -> None:
        is_one = self.next.count or self.next.coat or self.next.is_other or self.next.size
        if token.said == "one" and (is_one or (self.clause.scale and self.pending == "for")):
            self._own(ONE, token.said)
            return
        self.number = float(token.value)

    def on_coat(self, token: Token) -> None:
        if self.clause.coat or self.next.coat:
            if self.prep != "to":
                raise not_understood(self.clause.words, "two colours at once", "one colour")
            self.clause.coat = None  # "from white to green"
        self.next.coat = token.coat
        self.prep = "" if self.prep == "in" else self.prep  # "in white"

    def on_scale(self, token: Token) -> None:
        self.clause.scale = int(token.value)

    def on_percent(self, token: Token) -> None:
        if self.number is None:
            raise not_understood(self.clause.words, "how many percent?")
        self.clause.percent, self.number, self.pending = self.number, None, ""

    def on_extent(self, token: Token) -> None:
        self.clause.extent_m, self.clause.distance_m = self.clause.distance_m, None

    def on_unit(self, token: Token) -> None:
        if self.number is None:
            raise not_understood(self.clause.words, f"how many {token.said}?")
        self.clause.distance_m, self.number = self.number * float(token.value), None
        self.next = Noun(Thing("", ()), "")

    def on_degrees(self, token: Token) -> None:
        if self.number is None:
            raise not_understood(self.clause.words, f"how many {token.said}?")
        self.clause.degrees, self.number = self.number, None
        if self.pending == "by":
            self.pending = ""

    def on_angle(self, token: Token) -> None:
        self.clause.degrees, self.number = float(token.value), None

    def on_sense(self, token: Token) -> None:
        self.clause.sense = int(token.value)

    def on_way(self, token: Token) -> None:
        self.clause.way = token.value
        self.pending = self.prep = ""

    def on_style(self, token: Token) -> None:
        if self.clause.style and self.clause.style != token.value:
            raise not_understood(self.clause.words, "two styles at once", "one style for a room")
        self.clause.style = token.value

    def on_styled(self, token: Token) -> None:
        self.prep = ""

    def on_more(self, token: Token) -> None:
        if self.clause.nouns and self.number is None:
            self.clause.nouns[-1].is_more = True
        else:
            self.next.is_more = True

    def on_less(self, token: Token) -> None:
        if self.clause.nouns:
            self.clause.nouns[-1].is_less = True
        else:
            self.next.is_less = True

    def on_a(self, token: Token) -> None:
        self.next.count = 1.0

    def on_it(self, token: Token) -> None:
        self.clause.is_it = True

    def on_there(self, token: Token) -> None:
        self.clause.is_there = True
        self.prep = ""

    def on_with(self, token: Token) -> None:
        if self.clause.verb in _EXCHANGES:
            self.pending = "for"
        elif self.clause.verb == "remove":
            raise not_understood(self.clause.words, "'with' after what is removed")
