"""The words of a sentence that changes a house, and what each of them does in it. English."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from chord_usd.base.scene.intents import Coat
from chord_usd.base.scene.numbers_said import plain_text
from chord_usd.base.scene.palette import CATEGORIES, DRESSING_CATEGORIES, having
from chord_usd.line.lists.coat_words import coat
from chord_usd.line.lists.vocabulary import ANY_M, WORDS, named

LONGEST = 6
"""Words in a phrase."""

_SHORTEST_MISSPELT, _SHORTEST_CONFUSED = 5, 7
"""In letters: in shorter words nothing, or no letter that was replaced, is mended."""


class Thing(NamedTuple):
    """What a noun stands for."""

    word: str
    categories: tuple[str, ...]
    """Of a new piece the first, of pieces that are there any."""
    length_m: tuple[float, float] = ANY_M


class Token(NamedTuple):
    """A word, or several that are one, and what it is for."""

    kind: str
    """Of _TABLE, or "thing", "room", "number", "coat" and "unknown"."""
    value: str
    said: str
    thing: Thing | None = None
    coat: Coat | None = None


ONE = Thing("one", ())
"""What "a larger one" stands for: a piece of the kind that was spoken of."""


WISHES = frozenset((
    "need", "needs", "want", "wants", "would like", "id like", "wed like", "would love", "id love",
    "wed love", "there should be", "there must be", "there shall be",
))  # fmt: skip
"""Verbs that order by saying what somebody wishes."""

_CONTRACTIONS = (
    (r"\b(there|that|here|what|where|who|how)['’]?s\b", r"\1 is"),
    (r"\b(it|he|she)['’]s\b", r"\1 is"),
    (r"\b(i|we|you|they)['’]?ve\b", r"\1 have"),
    (r"\b(we|you|they)['’]re\b", r"\1 are"),
    (r"\bso (it|they)\b", r"so that \1"),
)

_NUMBERS = (
    "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
    "twelve",
)  # fmt: skip

_TABLE: tuple[tuple[str, str, str], ...] = (
    ("verb", "add", "add|install|insert|provide|include|buy|get|need|needs|give|want|would like|id"
     " like|wed like|would love|id love|wed love|there should be|there must be|there shall be"
     "|bring in|furnish with|equip with|wants"),
    ("verb", "paint", "paint|repaint|recolour|recolor|dye|reupholster|refinish|retile"),
    ("verb", "change", "change|convert|try|update|use|switch to"),
    ("verb", "put", "put|place|stand|set|lay|hang|position|arrange|put up|set up|stands|be placed"),
    ("verb", "remove", "remove|delete|get rid of|throw out|throw away|throw|take away|take out|take"
     " down|take off|discard|drop|eliminate|ditch|scrap|dispose of|do away with|clear|clear out"
     "|empty|strip|kick out|chuck out|leave out|erase|put away|should go"
     "|must go|has to go|have to go"),
    ("verb", "dislike", "dislike|hate|do not like|dont like|cannot stand|cant stand|tired of|im"
     " tired of|am tired of"),
    ("particle", "", "out|away|down"),
    ("verb", "move", "move|shift|translate|push|pull|slide|bring|carry|relocate|drag|nudge|shove"
     "|transfer|take|be moved|send"),
    ("verb", "turn", "turn|rotate|spin|yaw|swivel|pivot|be turned|be rotated"),
    ("verb", "flip", "flip|reverse|turn around|turn round|flip around"),
    ("verb", "face", "face|facing|faces|look at|look out of|look out|look to|look towards|look"
     " toward|point at|point to|point towards|orient|orient to|orient towards|turned to|turned"
     " towards|be turned to|be turned towards"),
    ("verb", "swap", "swap|interchange|change places|trade places|swap places|switch places"
     "|switch"),
    ("verb", "replace", "replace|exchange|substitute|trade|swap out"),
    ("verb", "bigger", "enlarge|widen|lengthen|extend|scale up"),
    ("verb", "smaller", "shrink|shorten|scale down|reduce"),
    ("verb", "style", "restyle|redo|redecorate|do up"),
    ("verb", "lock", "lock|pin|pin down|freeze|keep|fix|do not touch|dont touch|do not move|dont"
     " move|stay|stays|stay put|stays put|stay where it is|stays where it is|stay where they are"
     "|remains where it is|must not move|may not move|leave alone|anchor|secure"),
    ("verb", "unlock", "unlock|unpin|unfreeze|release"),
    ("verb", "weak", "make|have|let|should|shall|must|could|can|ought to|may|turn into|has to"
     "|have to|needs to|need to|is to|are to"),
    ("relation", "by", "next to|beside|near|near to|near of|close to|by|by the side of|alongside"
     "|adjacent to|at|around|against|right by|right next to|up to|for|to the side of"),
    ("relation", "away from", "away from|far from|further from|farther from|further away from|clear"
     " of|off"),
    ("relation", "nearer to", "nearer to|nearer|closer to|closer|more near to|towards|toward|in the"
     " direction of"),
    ("relation", "between", "between|in between"),
    ("relation", "under", "under|underneath|beneath|below"),
    ("relation", "above", "above|over"),
    ("relation", "before", "in front of|right in front of|before|opposite|across from"),
    ("relation", "behind", "behind|in back of|at the back of"),
    ("relation", "left of", "left of|to the left of|on the left of|on the left side of"),
    ("relation", "right of", "right of|to the right of|on the right of|on the right side of"),
    ("way", "north", "north|northwards"),
    ("way", "east", "east|eastwards"),
    ("way", "south", "south|southwards"),
    ("way", "west", "west|westwards"),
    ("way", "left", "left|leftwards"),
    ("way", "right", "right|rightwards"),
    ("way", "forwards", "forward|forwards"),
    ("way", "backwards", "backward|backwards"),
    ("sense", "-1", "clockwise|cw"),
    ("sense", "1", "counterclockwise|anticlockwise|counter clockwise|anti clockwise|ccw"),
    ("angle", "90", "quarter turn|quarter of a turn"),
    ("angle", "180", "half turn|half a turn|the other way round|back to front"),
    ("unit", "1", "m|metre|metres|meter|meters"),
    ("unit", "0.01", "cm|centimetre|centimetres|centimeter|centimeters"),
    ("unit", "0.001", "mm|millimetres|millimeters"),
    ("unit", "0.3048", "ft|foot|feet"),
    ("degrees", "", "degrees|degree|deg|°"),
    ("feature", "window", "window|windows"),
    ("feature", "door", "door|doors|doorway"),
    ("feature", "wall", "wall|walls"),
    ("feature", "floor", "floor|floors|flooring"),
    ("feature", "north wall", "north wall|northern wall|top wall"),
    ("feature", "east wall", "east wall|eastern wall|right wall|right hand wall|wall on the right"),
    ("feature", "south wall", "south wall|southern wall|bottom wall"),
    ("feature", "west wall", "west wall|western wall|left wall|left hand wall|wall on the left"),
    ("feature", "opposite wall", "opposite wall|other wall|wall opposite|far wall"
     "|back wall|rear wall"),
    ("feature", "corner", "corner|corners"),
    ("feature", "middle", "middle|center|centre|middle of the room|center of the room"
     "|centre of the room"),
    ("style", "modern", "modern|contemporary"),
    ("style", "scandinavian", "scandinavian|scandi|nordic"),
    ("style", "classic", "classic|classical|traditional"),
    ("style", "industrial", "industrial|loft"),
    ("style", "japanese", "japanese"),
    ("styled", "", "style|look|styled"),
    ("size", "small", "small|little|tiny|compact"),
    ("size", "large", "large|big|huge"),
    ("form", "round", "round|circular"),
    ("scale", "1", "bigger|larger|longer|wider|in a bigger size"),
    ("scale", "-1", "smaller|shorter|narrower|more compact"),
    ("percent", "", "%|percent|per cent"),
    ("extent", "", "wide|long|in width|in length"),
    ("other", "", "different|alternative"),
    ("one", "", "something|something else"),
    ("number", "0", "zero"),
    ("number", "2", "both|both of|a pair of|a couple of"),
    ("number", "0.5", "half|half a"),
    *(("number", str(n), word) for n, word in enumerate(_NUMBERS, 1)),
    ("no", "", "no|without|not any|none of"),
    ("every", "", "all|all of|every|each|any"),
    ("more", "", "more|another|extra|additional|one more"),
    ("less", "", "less|fewer"),
    ("only", "", "only|just|no more than"),
    ("the", "", "the|this|that|these|those|my|our|his|her|their|its|all the|all of the"),
    ("a", "", "a|an"),
    ("it", "", "it|them"),
    ("there", "", "there|in there|in it"),
    ("prep", "in", "in|inside|within|on"),
    ("prep", "to", "to|into|onto"),
    ("prep", "from", "from|out of"),
    ("prep", "of", "of"),
    ("with", "", "with|plus"),
    ("and", "", "and|as well as|then|also|but|so that|&|+|,|;|.|!|?|:|\n"),
    ("room", "every room", "the whole house|whole house|whole flat|whole apartment|whole home|the"
     " house|the flat|the apartment|my house|my flat|my apartment|my home|everywhere|all rooms"
     "|everything|entire house|entire home"),
    ("cannot", "", "knock down|tear down|build|demolish|not|never|dont|no need|upside down|ceiling"
     "|nice|nicer|cosy|cozy|cosier|cozier|warmer|brighter|better|luxurious|inviting"
     "|if|unless|maybe|or|except|half of|leave"),
    ("", "", "keep the layout|keep this layout|keep the same layout|keep layout|keep the furniture"
     " where it is|keep everything where it is|without moving anything"),
    ("", "", "please|kindly|would|you|i|we|like|be|is|are|some|me|us|too|again|now|piece of|pieces"
     " of|hello|hi|thanks|instead|where it is|where they are|could you|can you|would you|will you"
     "|colour|color|colours|colors|finish|material|ok|okay|well|hey|actually|existing|current|whole|entire"
     "|bit|little bit|slightly|side|about|completely|directly|exactly|fully|simply|upholstery|cover"
     "|do|so|lets|let us|i want to"
     "|we want to|i would like to|we would like to|id like to|wed like to|i need to|we need to"
     "|i want you to|we want you to|i would like you to|id like you to|i need you to"),
)  # fmt: skip
"""What a phrase is for, of which sort, and the phrases."""

_ALSO = {
    "table": ("table dining_table coffee_table side_coffee_table", ""),
    "desk": ("table", "study_desk|office_desk"),
    "cabinet": ("cabinet", "storage|storage_unit"),
    "rug": ("rug mat", "rug|carpet|area_rug"),
    "mat": ("mat rug", "mat|doormat|bath_mat"),
    "floor_lamp": ("floor_lamp table_lamp", "lamp|light|reading_lamp|lighting"),
    "floor_plant": ("floor_plant big_plant small_plant", "plant|house_plant|pot_plant"
                    "|potted_plant|indoor_plant|greenery"),
    "picture": ("picture", "painting|poster|print|artwork|wall_art|art"),
    "vase": ("vase", "flower|bouquet"),
    "book_row": ("book_row", "book"),
    "cushion": ("cushion", "pillow|throw_pillow"),
    "throw": ("throw", "blanket|throw_blanket"),
    "pendant_lamp": ("pendant_lamp", "pendant|pendant_light|chandelier|hanging_lamp"),
    "ceiling_lamp": ("ceiling_lamp", "ceiling_light"),
    "wall_lamp": ("wall_lamp", "sconce|wall_light"),
    "cooker_hood": ("cooker_hood", "range_hood|extractor_hood"),
    "bin": ("bin", "dustbin|wastebasket|trash_can|waste_bin|rubbish_bin"),
    "curtain": ("curtain curtain_rail", "drape"),
    "mirror": ("mirror", "looking_glass"),
    "side_coffee_table": ("side_coffee_table", "little_table|small_table|small_side_table"
                          "|occasional_table|little_side_table"),
    "tv": ("tv_cabinet television", "telly|television"),
    "tv_cabinet": ("tv_cabinet", "telly_stand|television_stand|television_cabinet|tv_board"
                   "|telly_cabinet|tv_set"),
    "shoe_cabinet": ("shoe_cabinet", "shoe_cupboard"),
    "leisure_sofa": ("leisure_sofa single_sofa", "recliner|lounger"),
}  # fmt: skip
"""What more things are called, by category; and what other categories count as them."""

SEATED_AT = {
    "dining chair": "dining_table", "kitchen chair": "dining_table", "desk chair": "table",
    "office chair": "table",
}  # fmt: skip
"""Words for chairs that say at which kind of table they stand."""


@cache
def _phrases() -> dict[str, tuple[str, str]]:
    return {text: (kind, value) for kind, value, row in _TABLE for text in row.split("|")}


def is_unit(words: Sequence[str]) -> bool:
    """Whether a number before these words measures something."""
    return _phrases().get(" ".join(words), ("", ""))[0] in ("unit", "degrees", "percent")


@cache
def _things() -> dict[str, Thing]:
    things = {word: Thing(entry.word, _counted(entry.category), entry.length_m)
             for word, entry in WORDS.items() if word.isascii()}  # fmt: skip
    for row in DRESSING_CATEGORIES:
        things[row.label.lower().replace(" ", "")] = Thing(row.label.lower(), (row.name,))
    for category, (counted, words) in _ALSO.items():
        for word in (category, *words.split("|")):
            thing_of_word = Thing(word.replace("_", " "), tuple(counted.split()))
            things[word.replace("_", "")] = thing_of_word
    return things


def known_things() -> list[str]:
    """One word or more for each kind of piece, in English."""
    labels = [row.label.lower() for row in (*CATEGORIES.values(), *DRESSING_CATEGORIES)]
    phrases = (
        known.word
        for known in _things().values()
        if " " in known.word and known.categories[0] in CATEGORIES
    )
    return list(dict.fromkeys([*labels, *phrases]))


def _counted(category: str) -> tuple[str, ...]:
    seats = having("easy_chair")
    return (category, *sorted(seats - {category})) if category in seats else (category,)


def thing(words: Sequence[str]) -> Thing | None:
    """What these words together name, singular or plural."""
    joined, things = "".join(words), _things()
    stems = [joined, *(joined.removesuffix(end) for end in ("s", "es") if joined.endswith(end))]
    stems += [f"{joined[:-3]}f", f"{joined[:-3]}y"] if joined.endswith(("ves", "ies")) else []
    match = next((things[stem] for stem in stems if stem in things), None)
    if match is None and (other := named(list(words))):  # "chests of drawers"
        match = Thing(other.word, _counted(other.category), other.length_m)
    return match


@cache
def _spellings() -> frozenset[str]:
    """Single words that a misspelt one may be."""
    phrases = {word for text in _phrases() for word in text.split()}
    nouns = {word for known in _things().values() for word in known.word.split()}
    return frozenset(word for word in phrases | nouns if len(word) >= _SHORTEST_MISSPELT)


def mended(word: str, also: frozenset[str] = frozenset()) -> str | None:
    """The one known word that differs by a letter lost, added or replaced, or two that changed
    places; None where there is none, or several. also: further known words."""
    if len(word) < _SHORTEST_MISSPELT:
        return None
    near = {spelling for spelling in _spellings() | also if _is_slip(word, spelling)}
    return near.pop() if len(near) == 1 else None


def _is_slip(word: str, meant: str) -> bool:
    if abs(len(word) - len(meant)) > 1 or word[0] != meant[0] or word == meant:
        return False
    at = next((n for n, (a, b) in enumerate(zip(word, meant, strict=False)) if a != b), len(word))
    if len(word) > len(meant):
        return word[at + 1 :] == meant[at:]
    if len(word) < len(meant):
        return word[at:] == meant[at + 1 :]
    swapped = word[at + 1 : at + 2] + word[at : at + 1] + word[at + 2 :]
    if swapped == meant[at:]:
        return True
    return len(word) >= _SHORTEST_CONFUSED and word[at + 1 :] == meant[at + 1 :]


def words_of(sentence: str) -> list[str]:
    """Its words, numbers and signs, in lower case."""
    plain = plain_text(sentence)
    for short, whole in _CONTRACTIONS:
        plain = re.sub(short, whole, plain)
    plain = plain.replace("'", "").replace("’", "")
    plain = re.sub(r"(?<=[^\W\d])[-_/](?=[^\W\d])", " ", plain)
    return re.findall(r"[^\W\d_]+|\d+(?:[.,]\d+)?|[^\w\s]|\n", plain)


def tokens(words: Sequence[str], rooms: Mapping[int, tuple[int, str]]) -> Iterator[Token]:
    """The words as tokens, the longest phrases first; of equal length things before the rest.

    rooms: by where a room's name begins, how many words it takes, and what it is.
    """
    at = 0
    while at < len(words):
        taken, token = _token(words, at, rooms)
        yield token
        at += taken


def _cuts_a_thing(words: Sequence[str], at: int, taken: int) -> bool:
    """Whether a room's name ends in a word that a thing begins with: "all dining" of chairs."""
    return any(
        thing(words[start : at + taken + 1]) and not thing(words[start : at + taken])
        for start in range(at + 1, at + taken) if at + taken < len(words)
    )  # fmt: skip


def _token(
    words: Sequence[str], at: int, rooms: Mapping[int, tuple[int, str]]
) -> tuple[int, Token]:
    for taken in range(min(LONGEST, len(words) - at), 0, -1):
        part = words[at : at + taken]
        said = " ".join(part)
        is_place = at in rooms and rooms[at][0] == taken and not _cuts_a_thing(words, at, taken)
        before = words[at - 2 : at] if at and words[at - 1] == "the" else words[at - 1 : at]
        if is_place and before and before[0] in ("in", "into", "from"):
            match = None  # "in the toilet" is a room
        else:
            match = thing(part) if all(word.isalpha() for word in part) else None
        worn = None if match else coat(part)
        if match and said not in _phrases():
            return taken, Token("thing", match.word, said, match)
        if is_place:
            return taken, Token("room", rooms[at][1], said)
        if said in _phrases():
            return taken, Token(*_phrases()[said], said)
        if worn:
            return taken, Token("coat", worn.name, said, coat=worn)
    if words[at][0].isdigit():
        return 1, Token("number", words[at].replace(",", "."), words[at])
    return 1, Token("unknown", "", words[at])
