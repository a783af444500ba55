"""Numbers as people say them, in the languages of room_names."""

from __future__ import annotations

import unicodedata

NUMBERS = {
    word: number
    for number, words in enumerate((
        "zero no without none kein keine keinen ohne sans aucun aucune sin ningun ninguna sem"
        " nenhum nenhuma ingen inget inga utan ilman zonder",
        "one a an single ein eine einen einer eins une un una um uma ett yksi",
        "two zwei deux dos dois duas tva kaksi kahden double", "three drei trois tres tre kolme",
        "four vier quatre cuatro quatro fyra nelja", "five funf cinq cinco fem viisi",
        "six sechs seis sex kuusi", "seven sieben sept siete sete sju seitseman",
        "eight acht huit ocho oito atta kahdeksan", "nine neun neuf nueve nove nio yhdeksan",
        "ten zehn dix diez dez tio kymmenen", "eleven", "twelve",
    ))
    for word in words.split()
} | {"twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "seventy": 70,
     "eighty": 80, "ninety": 90, "hundred": 100}  # fmt: skip

HAN_NUMBERS = {digit: number for number, digit in enumerate("〇一二三四五六七八九十")} | {
    "两": 2, "兩": 2, "无": 0, "無": 0,
}  # fmt: skip


def plain_text(text: str) -> str:
    """Lower case without accents, compatibility forms resolved: "70 m²" -> "70 m2"."""
    folded = unicodedata.normalize("NFKC", text).casefold()
    parts = unicodedata.normalize("NFD", folded.replace("ß", "ss"))
    latin = "".join(c for c in parts if not ("\u0300" <= c <= "\u036f"))
    return unicodedata.normalize("NFC", latin)
