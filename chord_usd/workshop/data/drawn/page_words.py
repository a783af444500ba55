"""What is written on crowded pages: names in many languages, sizes, titles; and its letters."""

from __future__ import annotations

from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from shapely.geometry import Polygon

from chord_usd.base.scene.types import FloatArray, RoomKind

_NAMES: dict[str, dict[RoomKind, str]] = {
    "en": {
        "living": "Living Room|Reception Room|Lounge|Sitting Room|Great Room|Family Room|Living",
        "dining": "Dining Room|Dining|Breakfast|Kitchen / Dining Room|Dining Area",
        "bedroom": "Bedroom|Bedroom 1|Bedroom 2|Master Bedroom|Primary|Bed 3|Principal Bedroom|Br",
        "kitchen": "Kitchen|Kitchen / Breakfast|Kit|Kitchenette|Kitchen/Diner",
        "bathroom": "Bathroom|Bath|WC|En Suite|Shower Room|Ensuite|W.C.|Wet Room|Powder",
        "balcony": "Balcony|Terrace|Patio|Deck|Porch|Loggia|Lanai",
        "corridor": "Hall|Landing|Entrance|Entry|Foyer|Hallway|Lobby|Corridor",
        "study": "Study|Office|Den|Bonus Room|Studio|Library|Media",
        "store": "Store|C|Cupboard|Closet|W.I.C.|Utility|Laundry|Pantry|St.|Linen|Mud|Garage",
    },
    "de": {
        "living": "Wohnzimmer|Wohnen|Wohnen/Essen|Stube", "dining": "Esszimmer|Essen|Diele",
        "bedroom": "Schlafzimmer|Schlafen|Zimmer 1|Kind 2|Eltern|Gast", "kitchen": "Küche|Kochen",
        "bathroom": "Bad|WC|Du/WC|Gäste-WC|Dusche", "balcony": "Balkon|Terrasse|Loggia",
        "corridor": "Flur|Diele|Windfang|Gang|Vorraum", "study": "Büro|Arbeiten|Arbeitszimmer",
        "store": "Abst.|Abstellraum|HWR|Ankleide|Technik|Keller",
    },
    "fr": {
        "living": "Séjour|Salon|Pièce de vie", "dining": "Salle à manger|S.à.M.|Repas",
        "bedroom": "Chambre|Chambre 1|Chambre 2|Ch. parents", "kitchen": "Cuisine|Coin cuisine",
        "bathroom": "SdB|Salle de bain|WC|SdE|Salle d'eau", "balcony": "Balcon|Terrasse|Loggia",
        "corridor": "Entrée|Dégagement|Couloir|Dgt", "study": "Bureau",
        "store": "Cellier|Rangement|Placard|Dressing|Buanderie",
    },
    "es": {
        "living": "Salón|Sala|Estar|Salón-comedor", "dining": "Comedor",
        "bedroom": "Dormitorio|Dormitorio 1|Dorm. 2|Habitación|Recámara", "kitchen": "Cocina",
        "bathroom": "Baño|Baño 2|Aseo", "balcony": "Terraza|Balcón|Patio",
        "corridor": "Pasillo|Distribuidor|Recibidor|Hall", "study": "Estudio|Despacho",
        "store": "Trastero|Lavadero|Vestidor|Bodega",
    },
    "pt": {
        "living": "Sala|Sala de estar|Living|Estar", "dining": "Sala de jantar|Jantar",
        "bedroom": "Quarto|Quarto 1|Suíte|Dormitório", "kitchen": "Cozinha",
        "bathroom": "Banheiro|Banho|W.C.|Lavabo|I.S.", "balcony": "Varanda|Sacada|Terraço",
        "corridor": "Corredor|Circulação|Hall", "study": "Escritório",
        "store": "Despensa|Área de serviço|Closet|Lavanderia",
    },
    "sv": {
        "living": "VARDAGSRUM|Allrum", "dining": "MATPLATS|Matrum", "bedroom": "SOVRUM|SOVRUM 1",
        "kitchen": "KÖK|Kök", "bathroom": "BADRUM|BAD|WC/D|WC", "balcony": "BALKONG|Uteplats",
        "corridor": "HALL|ENTRÉ|Passage", "study": "ARBETSRUM", "store": "FÖRRÅD|KLK|KLÄDV.|Tvätt",
    },
    "fi": {
        "living": "OH|Olohuone|TUPAKEITTIÖ", "dining": "RUOK.|Ruokailu", "bedroom": "MH|MH1|ALK",
        "kitchen": "K|Keittiö|KT", "bathroom": "KH|PH|WC|Kylpyhuone", "balcony": "PARVEKE|Terassi",
        "corridor": "ET|Eteinen|AULA|TK", "study": "TYÖH.|Työhuone", "store": "VAR|VH|KHH|SAUNA",
    },
    "it": {
        "living": "Soggiorno|Salotto|Zona giorno", "dining": "Pranzo|Sala da pranzo",
        "bedroom": "Camera|Camera 1|Letto|Cameretta", "kitchen": "Cucina|Angolo cottura",
        "bathroom": "Bagno|WC|Bagno 2", "balcony": "Balcone|Terrazzo|Loggia",
        "corridor": "Ingresso|Disimpegno|Corridoio", "study": "Studio",
        "store": "Ripostiglio|Rip.|Cabina|Lavanderia",
    },
    "nl": {
        "living": "Woonkamer|Living|Zitkamer", "dining": "Eetkamer|Eethoek",
        "bedroom": "Slaapkamer|Slaapkamer 1|Slk 2", "kitchen": "Keuken|Open keuken",
        "bathroom": "Badkamer|Toilet|WC|Douche", "balcony": "Balkon|Terras|Dakterras",
        "corridor": "Hal|Gang|Overloop|Entree", "study": "Werkkamer|Studeerkamer|Kantoor",
        "store": "Berging|Kast|CV|Wasruimte|Bijkeuken",
    },
    "pl": {
        "living": "Salon|Pokój dzienny", "dining": "Jadalnia", "bedroom": "Sypialnia|Pokój|Pokój 2",
        "kitchen": "Kuchnia|Aneks", "bathroom": "Łazienka|WC|Toaleta", "balcony": "Balkon|Taras",
        "corridor": "Korytarz|Przedpokój|Hol|Wiatrołap", "study": "Gabinet",
        "store": "Garderoba|Spiżarnia|Schowek|Pralnia|Garaż",
    },
    "da": {
        "living": "Stue|Opholdsstue|Alrum", "dining": "Spisestue", "bedroom": "Værelse|Soveværelse",
        "kitchen": "Køkken|Køkken/alrum", "bathroom": "Bad|WC|Toilet", "balcony": "Altan|Terrasse",
        "corridor": "Entré|Gang|Hall", "study": "Kontor", "store": "Depot|Bryggers|Skab",
    },
    "ru": {
        "living": "Гостиная|Зал|Общая комната", "dining": "Столовая", "bedroom": "Спальня|Детская",
        "kitchen": "Кухня|Кухня-гостиная", "bathroom": "Санузел|Ванная|С/у", "balcony": "Балкон",
        "corridor": "Прихожая|Холл|Коридор", "study": "Кабинет", "store": "Гардероб|Кладовая",
    },
    "ja": {
        "living": "リビング|LDK|居間|LD", "dining": "ダイニング|食堂|DK",
        "bedroom": "洋室|和室|寝室|洋室(1)", "kitchen": "キッチン|台所|K",
        "bathroom": "浴室|洗面|トイレ|洗面室|UB", "balcony": "バルコニー|ベランダ",
        "corridor": "廊下|玄関|ホール|玄", "study": "書斎",
        "store": "収納|納戸|物入|WIC|押入|CL",
    },
    "ko": {
        "living": "거실", "dining": "식당", "bedroom": "침실|침실1|안방",
        "kitchen": "주방|주방/식당",
        "bathroom": "욕실|욕실1|화장실", "balcony": "발코니", "corridor": "현관|복도",
        "study": "서재", "store": "드레스룸|다용도실|창고",
    },
    "zh": {
        "living": "客厅|起居室", "dining": "餐厅", "bedroom": "卧室|主卧|次卧", "kitchen": "厨房",
        "bathroom": "卫生间|卫|主卫", "balcony": "阳台", "corridor": "走廊|玄关|过道",
        "study": "书房", "store": "储藏室|衣帽间",
    },
    "he": {
        "living": "סלון|חדר מגורים", "dining": "פינת אוכל", "bedroom": "חדר שינה|חדר הורים",
        "kitchen": "מטבח", "bathroom": "חדר רחצה|שירותים|מקלחת", "balcony": "מרפסת",
        "corridor": "כניסה|מסדרון|מבואה", "study": "חדר עבודה", "store": "מחסן|ממ״ד|ארון",
    },
}  # fmt: skip

_TITLES = (
    "Ground Floor", "First Floor", "Second Floor", "Fourth Floor", "FLOOR PLAN", "Floor 1",
    "2nd Floor", "Erdgeschoss", "1. Obergeschoss", "RDC", "Étage", "Planta baja",
    "PAVIMENTO TÉRREO", "Plan 1", "1. Stock", "Piano terra", "Begane grond", "Entrance", "GARDEN",
    "Approximate Gross Internal Area 74.2 sq m / 799 sq ft", "Wohnfläche 84,6 m²", "Unit 4B",
    "Total area: approx. 96.4 sq. metres", "For illustration only. Not to scale.", "Flat 12",
    "TOTAL: 1250 sq. ft", "SIZES AND DIMENSIONS ARE APPROXIMATE", "Scale 1:100", "1:50", "M 1:100",
    "Whilst every attempt has been made to ensure accuracy, all measurements are approximate",
    "Ca. 78 m²", "A-101", "3 Bed / 2 Bath", "House Type B", "Produced by www.example.com",
    "© 2019 All rights reserved", "Plan not to scale",
)  # fmt: skip


def room_name(language: str, kind: RoomKind, rng: np.random.Generator) -> str:
    """One of the names of a kind of room; empty for rooms of no known kind."""
    names = _NAMES[language].get(kind, "").split("|")
    return names[int(rng.integers(len(names)))]


def title(rng: np.random.Generator) -> str:
    """A line that stands somewhere on a page."""
    return _TITLES[int(rng.integers(len(_TITLES)))]


SIZE_STYLES = 9


def room_size(area: Polygon, style: int) -> list[str]:
    """A room's size, on a line or two, in one of SIZE_STYLES ways."""
    left, low, right, high = area.bounds
    wide, tall, m2 = right - left, high - low, area.area
    feet = f"{_feet(wide)} x {_feet(tall)}"
    metres = f"{wide:.2f}m x {tall:.2f}m"
    ways = (
        [f"{m2:.1f} m²"], [f"{wide:.2f} x {tall:.2f} m"], [feet], [feet, f"({metres})"],
        [metres, feet], [f"{m2:.0f} m2"], [f"{100 * wide:.0f} x {100 * tall:.0f}"],
        [f"{m2:.2f} qm".replace(".", ",")], [f"{m2 / 1.62:.1f}"],
    )  # fmt: skip
    return ways[style]


def _feet(length_m: float) -> str:
    feet, inches = divmod(round(length_m * 39.37), 12)
    return f"{feet}'{inches}\""


# Letters -----------------------------------------------------------------------------------------

_DRAWN_PX = 40
"""Height at which fonts are drawn that take long to load; smaller letters are made from it."""

_HERSHEY = ("plain", "duplex")
"""OpenCV's strokes, as plotters write."""


@lru_cache(maxsize=512)
def ink_of(text: str, height_px: int, font: int) -> FloatArray:
    """(h, w) in [0, 1]: a line of text; height_px: of its letters' box, about. font: any number."""
    if not _is_latin(text):
        return _shrunk(_typeset(text, _font_for(text), _DRAWN_PX), height_px / _DRAWN_PX)
    faces = _latin_faces()
    index = font % (len(faces) + len(_HERSHEY))
    if index >= len(faces) and text.isascii():
        return _plotted(text, height_px, index - len(faces))
    path = faces[index % len(faces)]
    if path.endswith(".woff2"):
        return _shrunk(_typeset(text, path, _DRAWN_PX), height_px / _DRAWN_PX)
    return _typeset(text, path, height_px)


def _is_latin(text: str) -> bool:
    return all(ord(letter) < 0x500 for letter in text)


def _typeset(text: str, path: str, height_px: int) -> FloatArray:
    face = _face(path, height_px)
    left, top, right, bottom = (round(v) for v in face.getbbox(text))
    patch = Image.new("L", (max(1, right - left + 2), max(1, bottom - top + 2)), 0)
    ImageDraw.Draw(patch).text((1 - left, 1 - top), text, fill=255, font=face)
    return np.asarray(patch, np.float64) / 255


def _shrunk(ink: FloatArray, share: float) -> FloatArray:
    size = max(1, round(ink.shape[1] * share)), max(1, round(ink.shape[0] * share))
    return np.asarray(cv2.resize(ink, size, interpolation=cv2.INTER_AREA), np.float64)


def _plotted(text: str, height_px: int, weight: int) -> FloatArray:
    face = (cv2.FONT_HERSHEY_SIMPLEX, cv2.FONT_HERSHEY_DUPLEX)[weight]
    scale = height_px / 30.0
    (wide, tall), under = cv2.getTextSize(text, face, scale, 1)
    patch = np.zeros((tall + under + 2, wide + 2), np.uint8)
    cv2.putText(patch, text, (1, tall), face, scale, (255.0,), 1, cv2.LINE_AA)
    return patch / 255


@cache
def _face(path: str, height_px: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(path, height_px)


@cache
def _latin_faces() -> tuple[str, ...]:
    """Fonts that matplotlib carries, and one of Blender's where it is there."""
    import matplotlib

    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    names = ("DejaVuSans", "DejaVuSans", "DejaVuSans-Bold", "DejaVuSansMono", "DejaVuSerif",
             "STIXGeneral", "STIXGeneralBol", "DejaVuSans-Oblique")  # fmt: skip
    faces = [str(folder / f"{name}.ttf") for name in names]
    inter = _blender_fonts() / "Inter.woff2"
    return (*faces, *[str(inter)] * 3) if inter.is_file() else tuple(faces)


def _font_for(text: str) -> str:
    """A font with the letters of a language that is not written in Latin or Cyrillic ones."""
    name = "Noto Sans CJK Regular.woff2"
    if any(0x590 <= ord(letter) < 0x600 for letter in text):
        name = "NotoSansHebrew-Regular.woff2"
    path = _blender_fonts() / name
    return str(path) if path.is_file() else _latin_faces()[0]


@cache
def _blender_fonts() -> Path:
    """Where Blender's wheel keeps its fonts; a folder that is not there without it."""
    spec = find_spec("bpy")
    places = list(spec.submodule_search_locations or []) if spec else []
    for place in places:
        for folder in sorted(Path(place).glob("*/datafiles/fonts")):
            return folder
    return Path("no fonts")
