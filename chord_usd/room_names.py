"""What a room is, from what people call it, in nine languages and in draughtsmen's short forms."""

from __future__ import annotations

import re
import unicodedata

from chord_usd.types import RoomKind

_KIND_WORDS: dict[RoomKind, str] = {
    # English
    "living": "living livingroom lounge parlour parlor sittingroom familyroom livingdining ldk"
    " family theatre sitting greatroom reception"
    # German, French, Spanish, Portuguese, Swedish, Finnish
    " wohnzimmer wohnen wohnkueche wohnkuche stube sejour salon sala estar saladeestar"
    " vardagsrum allrum storstuga olohuone oh tupakeittio tupa",
    "dining": "dining diningroom breakfastroom dinette breakfast nook"
    " esszimmer essen essplatz manger salleamanger comedor jantar saladejantar"
    " matplats matsal matrum ruokailu ruokailutila ruokasali rt",
    "bedroom": "bedroom masterbedroom secondbedroom guestroom kidsroom childrensroom childroom"
    " childrenroom nursery elderlyroom masterroom secondroom japaneseroom tatamiroom"
    " bed suite mastersuite br mbr"
    " schlafzimmer schlafen kinderzimmer kind eltern gaestezimmer gastezimmer zimmer chambre"
    " dormitorio habitacion recamara alcoba cuarto quarto suite"
    " sovrum barnrum gastrum makuuhuone mh lastenhuone vierashuone alkovi alk",
    "kitchen": "kitchen kitchenette pantrykitchen cookingarea kit"
    " kueche kuche kochen kochnische cuisine kitchinette cocina cozinha kok koksdel pentry"
    " keittio keittokomero kk k",
    "bathroom": "bathroom bath toilet wc restroom washroom washingroom lavatory powderroom ensuite"
    " masterbathroom secondbathroom showerroom shower powder ens"
    " bad badezimmer dusche gaestewc gastewc duschbad bain salledebain salledebains sdb eau"
    " salledeau toilettes douche bano aseo banheiro banho lavabo badrum dusch toalett bastu"
    " kylpyhuone kh kph pesuhuone psh ph sauna suihku ub",
    "balcony": "balcony terrace loggia veranda verandah patio deck porch alfresco cabana"
    " balkon terrasse balcon balcao terraza terraco varanda sacada balkong terrass uteplats altan"
    " parveke terassi kuisti lasitettu",
    "corridor": "corridor hall hallway entrance entry entryway foyer vestibule aisle passage"
    " passageway lobby stairs stairwell landing"
    " flur diele gang eingang windfang treppenhaus treppe couloir entree degagement palier"
    " pasillo vestibulo recibidor entrada corredor circulacao korridor kapprum trapphus"
    " entre eteinen et kaytava aula tuulikaappi tk",
    "study": "study studyroom office homeoffice workroom library den"
    " arbeitszimmer buero buro arbeiten bureau estudio despacho oficina escritorio arbetsrum"
    " kontor tyohuone th kirjasto",
    "store": "store storage storeroom storageroom closet cloakroom wardrobe walkincloset pantry"
    " utility utilityroom laundry laundryroom equipmentroom boxroom garage cellar robe wir wic clo"
    " cl abstellraum abst abstellkammer hauswirtschaftsraum hwr keller ankleide garderobe"
    " speisekammer speis vorrat technik cellier rangement placard dressing buanderie debarras"
    " almacen trastero armario lavadero despensa arrumos lavanderia servico"
    " forrad klk kladkammare kladvard tvatt tvattstuga skafferi garderob"
    " varasto var vaatehuone vh kodinhoitohuone khh komero",
    "unknown": "unknown undefined other room",
}
_KIND_OF_WORD = {word: kind for kind, words in _KIND_WORDS.items() for word in words.split()}

_HAN_AND_KANA: dict[RoomKind, str] = {
    "living": "客厅 客廳 起居 居间 居間 リビング 大厅 大廳 会客",
    "dining": "餐厅 餐廳 饭厅 飯廳 食堂 ダイニング",
    "bedroom": "卧室 臥室 卧房 臥房 主卧 主臥 次卧 次臥 客卧 儿童房 兒童房 洋室 和室 寝室 子供部屋"
    " 主寝室 ベッドルーム",
    "kitchen": "厨房 廚房 台所 キッチン 厨",
    "bathroom": "卫生间 衛生間 卫 厕所 廁所 洗手间 洗手間 浴室 主卫 客卫 淋浴 洗面 脱衣 トイレ 便所"
    " バス ユニットバス 浴",
    "balcony": "阳台 陽台 露台 バルコニー ベランダ テラス",
    "corridor": "走廊 走道 过道 過道 玄关 玄關 玄関 门厅 門廳 廊下 ホール 階段 楼梯 樓梯",
    "study": "书房 書房 书斋 書斎 工作间 ワークスペース",
    "store": "储藏 儲藏 储物 儲物 衣帽间 衣帽間 杂物 雜物 押入 物入 収納 納戸 クローゼット 洗衣",
}
_LONGEST_FIRST = sorted(
    ((word, kind) for kind, words in _HAN_AND_KANA.items() for word in words.split()),
    key=lambda row: -len(row[0]),
)

_FLATTENED = str.maketrans({"ß": "ss", "ø": "o", "æ": "ae", "œ": "oe", "ð": "d", "ł": "l"})

_SHORTEST_PART = 5
"""A shorter word inside a longer one is chance: "den" in "Garden"."""


def room_kind(name: str) -> RoomKind:
    """The kind that a room's name speaks of ("Master Bedroom 2" -> "bedroom"), else "unknown".

    Names may be English, German, French, Spanish, Portuguese, Swedish, Finnish, Chinese or
    Japanese. The longest known word decides where several are joined to one.
    """
    folded = unicodedata.normalize("NFKC", name).casefold()
    for word, kind in _LONGEST_FIRST:
        if word in folded:
            return kind
    # Japanese sheets: LDK, DK and K, with the area behind them.
    if match := re.match(r"[^a-z]*(s?ldk|ld|dk)(?![a-z])", folded):
        return "living" if "l" in match[1] else "kitchen"
    words = re.findall(r"[a-z]+", _without_accents(folded))
    joined = "".join(words)
    for candidate in (joined, *reversed(words)):
        if candidate in _KIND_OF_WORD:
            return _KIND_OF_WORD[candidate]
    known = (word for word in _KIND_OF_WORD if len(word) >= _SHORTEST_PART and word in joined)
    return _KIND_OF_WORD.get(max(known, key=len, default=""), "unknown")


def kind_of_word(word: str, english: bool, inflected: bool = True) -> RoomKind | None:
    """The kind that one word of a sentence names, in Latin letters; singular or plural.

    Stricter than room_kind: short forms that only stand on drawings are words of a sentence, too.
    english: whether the sentence is; a German "Bad" is none in it. inflected: whether a known word
    with an ending that is not a plural will do.
    """
    plain = _without_accents(unicodedata.normalize("NFKC", word).casefold())
    others = _OTHER_WORDS | (_OTHER_IN_ENGLISH if english else _OTHER_BUT_IN_ENGLISH)
    if len(plain) < _SHORTEST_WORD or plain in others:
        return None
    stems = [plain, *(plain.removesuffix(end) for end in _PLURALS if plain.endswith(end))]
    stems += [plain[:-3] + "y"] if plain.endswith("ies") else []
    for stem in stems:
        if stem in _KIND_OF_WORD and stem not in others:
            return _KIND_OF_WORD[stem]
    known_words = (word for word in _KIND_OF_WORD if inflected and word not in others)
    longer = (known for known in known_words if len(known) > 5 and plain.startswith(known))
    best = max((known for known in longer if len(plain) - len(known) <= 4), key=len, default=None)
    return _KIND_OF_WORD[best] if best else None


_SHORTEST_WORD = 3
_PLURALS = ("s", "es", "n", "en", "r", "er", "t", "ta")
_NOT_IN_SENTENCES = (
    "room rooms other unknown undefined family master suite var ens office second hwr kit essen"
    " kind eltern estar manger service servico kochen schlafen arbeiten wohnen zimmer oma aula"
    " sitting oh tk th kk kh mh ub rt vh alk khh klk psh kph ph eau guest clo robe home entree"
    " entre technik theatre great"
)
_OTHER_WORDS = frozenset(_NOT_IN_SENTENCES.split())
"""Words that name a room on a drawing, and mean other things, or none alone, in a sentence."""

_OTHER_IN_ENGLISH = frozenset(["bad", "cuarto", "quarto", "dormitorio", "kind"])
_OTHER_BUT_IN_ENGLISH = frozenset(["den", "hall", "closet"])


def kinds_in_han(text: str) -> list[tuple[int, int, RoomKind]]:
    """Room names in Chinese or Japanese: from where, to where, and what they name."""
    found: list[tuple[int, int, RoomKind]] = []
    place = 0
    while place < len(text):
        match = next(((w, k) for w, k in _LONGEST_FIRST if text.startswith(w, place)), None)
        if match:
            found.append((place, place + len(match[0]), match[1]))
        place += len(match[0]) if match else 1
    return found


def _without_accents(text: str) -> str:
    """Latin letters only: "Küche" -> "kuche"."""
    parts = unicodedata.normalize("NFD", text.translate(_FLATTENED))
    return "".join(letter for letter in parts if not unicodedata.combining(letter))
