"""Room kinds from names, as they are printed on plans, and from what is printed beside them."""

from __future__ import annotations

import pytest

from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.room_words import ROOM_KINDS, WORDS
from chord_usd.base.scene.types import RoomKind

NAMES: dict[RoomKind, str] = {
    "living": "Lounge|Living Room 2|Wohnzimmer|Séjour|Salón|Sala de Estar|VARDAGSRUM|Olohuone|OH"
    "|客厅|リビング|LDK 12.5帖|LDK14.0|LD 26m2|OH 27.5"
    "|salle de séjour|Reception Room|RECEPTION|Drawing Room"
    "|Bonus Room|Bonus|Family Room|Family|Great Rm|Studio|Sitting Room|Sun Room"
    "|Living / Kitchen / Dining|Kitchen/Living|Estar/Jantar/|Salon z aneksem kuchennym"
    "|Pokój dzienny|Woonkamer|Soggiorno|Stue|Stue/kjøkken|TV-stue|Гостиная|Кухня-гостиная"
    "|거실|거실/주방|סלון|リビングダイニング|Wohn-/Esszimmer|Wohnen/Essen/Kochen"
    "|LIVINGROOM|L0UNGE|Receptlon Room|Llving Room|Open plan living|Media Room|Play Room"
    "|Game Room|Conservatory|Snug|客餐厅|居間|Living Rm 12'0\" x 14'6\""
    "|Open-Plan Kitchen/Living/Dining Room|Køkken-alrum|LIVING DINING|Wohnküche"
    "|Wohnbereich"
    "|Obývací pokoj|Obyvacka|Dnevna soba|Dnevni boravak|Nappali|Oturma Odası|Phòng khách",
    "dining": "Dining|Esszimmer|Salle à manger|Comedor|Sala de jantar|MATPLATS|Ruokailutila|餐厅"
    "|Dining Area|Breakfast Room|Breakfast Nook|Eetkamer|Sala da pranzo|Jadalnia"
    "|Spisestue|Столовая|식당|פינת אוכל|Dinning Room|ダイニング|Formal Dining"
    "|Jídelna|Jedilnica|Étkező|Yemek odası",
    "bedroom": "Master Bedroom 2|bed 3|Schlafzimmer|Chambre 1|Dormitorio|Quarto|SOVRUM 1|Makuuhuone"
    "|MH2|主卧|洋室 6帖|和室|Primary Bedroom|Primary|Primary Suite|Principal Bedroom"
    "|Owner's Suite|Guest|Guest Room|Kids Room|BEDR00M 2|Bedrom|Bed room|BEDROOM I"
    "|MASTERBEDROOM|Elternschlafzimmer|Kinderzimmer 1|Gästezimmer|Zimmer 3|Slaapkamer 1"
    "|Ouderslaapkamer|Camera da letto|Camera matrimoniale|Cameretta|Camera 2|Sypialnia"
    "|Pokój 2|Pokój dziecięcy|Soveværelse|Værelse 2|Soverom 3|Hovedsoverom|Sov 2|Спальня"
    "|Детская|Комната 2|침실1|안방|작은방|חדר שינה|子供部屋|次卧|儿童房|Suíte 1"
    "|Bedroom 1 with ensuite|Chambre parentale|Dormitório 2|Double Bedroom|Bdrm #2|BR 2"
    "|Nursery|Schlafen|Maids Room"
    "|Ložnice|Spálňa|Spalnica|Spavaća soba 2|Hálószoba|Yatak Odası|Dormitor 1|Phòng ngủ 2",
    "kitchen": "Kitchen|Küche|Cuisine|Cocina|Cozinha|KÖK|Keittiö|厨房|台所|DK|Kitchen / Dining Room"
    "|Kitchen Diner|Kitchen/Breakfast Room|Kitchen Dining Room|KITCHENDINER|K1tchen"
    "|Kitchn|Keuken|Woonkeuken 2|Cucina|Angolo cottura|Kuchnia|Aneks kuchenny"
    "|Kuchnia z jadalnią|Køkken|Køkken/bryggers|Kjøkken|Кухня|주방|주방/식당|מטבח"
    "|キッチン|Gourmet Kitchen|Eat-in Kitchen|Cozinha/ Serviço|Kochen / Essen|Kit."
    "|Kitchenette"
    "|Kuchyně|Kuchyna|Kuhinja|Konyha|Mutfak|Bucătărie|Bếp",
    "bathroom": "Bathroom|Bad|Salle de bain|Salle d'eau|Baño|Casa de banho|Banheiro"
    "|BADRUM|Kylpyhuone|KH|卫生间|浴室|En-suite"
    "|Ensuite Shower Room|Master Bath|Primary Bath|Bath 2|Family Bathroom"
    "|Shower Room|Utility / WC|BASHEIRO|BANIEIRO|PESUH.|Badkamer"
    "|Douche|Bagno|Bagno 2|Antibagno|Łazienka|Lazienka|WC/Bad|Badeværelse"
    "|Toilet/bad|Dusj|Ванная|Санузел|С/У|욕실|화장실|חדר רחצה|주방욕실"
    "|主卧卫生间|Elternbad|Duschbad|Master En Suite|Bedroom 1 Ensuite"
    "|Jack & Jill Bath|Sauna|Bathrm|Baderom"
    "|Koupelna|Kúpeľňa|Kopalnica|Kupaonica|Fürdő|Banyo|Baie",
    "washroom": "洗面所|Utility Room|Laundry|Bijkeuken|Lavanderia|Bryggers|Vaskerom|다용도실"
    "|Hauswirtschaftsraum|Laundry/Mech|Buanderie",
    "wc": "WC|Gäste-WC|トイレ|W.C.|w/c|Half Bath|Powder Room|Pwdr|Toilet|Toaleta|Туалет"
    "|שירותים|公卫"
    "|Záchod|Tuvalet",
    "balcony": "Balcony|Terrasse|Balcon|Balcón|Varanda|BALKONG|Parveke|阳台|バルコニー|Patio|Deck"
    "|Covered Porch|Roof Terrace|Dachterrasse|Balkon|Dakterras|Balcone|Terrazzo|Taras"
    "|Altan|Overdækket terrasse|Балкон|Лоджия|발코니|베란다|מרפסת|北阳台|Bedroom Balcony"
    "|Loggia"
    "|Lodžia|Lođa|Erkély|Ban công",
    "corridor": "Hall|Landing|Flur|Couloir|Entrée|Pasillo|Corredor|ENTRÉ|Eteinen|ET|走廊|玄関"
    "|First Floor Landing|Entrance Hall|Mud Room|Mud|Foyer|Stairs|Gang|Hal|Overloop"
    "|Ingresso|Disimpegno|Corridoio|Przedpokój|Wiatrołap|Korytarz|Fordelingsgang|Vindfang"
    "|Entre/gang|Прихожая|Коридор|Холл|현관|복도|כניסה|מסדרון|廊下|过道|Vorzimmer"
    "|Stairwell|Circulation|Inner Hallway|Entry Hall|廊下玄"
    "|Chodba|Předsíň|Hodnik|Predsoblje|Előszoba|Koridor",
    "study": "Study|Home Office|Büro|Bureau|Despacho|Escritório|Arbetsrum|Työhuone|书房|Den|Office"
    "|Library|Werkkamer|Studeerkamer|Ufficio|Gabinet|Kontor|Кабинет|서재|חדר עבודה|書斎"
    "|Hjemmekontor|Study Area|Arbeiten",
    "store": "Closet|Abstellraum|Cellier|Trastero|Despensa|KLK|Förråd|Vaatehuone|储藏室|押入"
    "|Dressing Room|Dressing|Walk-in Closet|W.I.C.|WIC|Pantry Cupboard|Cupboard"
    "|Garage|Double Garage|A/C Cupboard|Linen|Hall Closet"
    "|Master Closet|Primary Closet|Boiler Room|Berging|Inloopkast|Meterkast"
    "|Ripostiglio|Cabina armadio|Garderoba|Spiżarnia|Pom. gospodarcze"
    "|Kotłownia|Bod|Walk-in|Гардеробная|Кладовая|드레스룸|창고"
    "|מחסן|חדר ארונות|シューズクローク|クローゼット|衣帽间|主卧衣帽间|Storage 1"
    "|Store Room|Abst.|STORAG|Placard"
    "|Šatník|Komora|Gardrób|Kiler",
    "unknown": "Garden|BH=700|LD:930|LD: 930|LD 930|DK=900|OH 2400|ET.2100|KH+850|MH=2.40 m"
    "|13 m²|SIZES ARE APPROXIMATE|First Floor|Ground Floor Plan|Third Floor"
    "|12 Church Street, London|Bath Road|Hall Lane 7|Badstraße 5|Kitchenaid"
    "|Kitchen Warehouse Ltd|Pinterest|Decorei.org"
    "|Plantas de Kitnet: Descubra Qual a Melhor Opção|Planta de Apartamento"
    "|Images may be subject to copyright|4 bedrooms|3 Bedrooms 2 Bathrooms"
    "|The kitchen is fitted with a range of units and integrated appliances"
    "|APPROXIMATE GROSS INTERNAL FLOOR AREA 714 SQ.FT|xqzvw|Lorem ipsum|STARKINGS|WATSON"
    "|CUBICASA|Up|DN|N|E|Fridge|Dishwasher|W|Window|Door|PORTA|DUTO|+108.382|264a-77b"
    "|Room 1|Room|Part 2|Void|Lift|Elevator|Classroom|Ballroom|Kirchen|Kindness"
    "|Master Plan|Holder|Looking|Deposit|Zen garden|www.bathstore.com|Tel 020 7946 0000"
    "|Scale 1:100|North|Discover|Search|Saved|Share|Visit >|東京都港区南青山|方位|平面図"
    "|建築面積|도면|Планировка|План этажа|תכנית|Foxtons|Savills|RE/MAX|Engel & Völkers"
    "|Rightmove|Zoopla|Terrace Properties|Hall & Partners Estate Agents|Bathgate|Bedford"
    "|Hallmark|Livingston|Washington Avenue|Studley|Kitchener|Denver|Landingham"
    "|For illustration purposes only. Not to scale.|All measurements are approximate"
    "|Produced by|Copyright 2023|Property of|Unit 4B|Type C|Block 7|House|Apartment 12"
    "|Shaft|Column|Fireplace|Sink|Sofa|TV|BALLS|Stone|Ratio|Hill|Tower|Flower|Closed"
    "|Diving|Shelter|Corrida|Barker|out of ideas|部屋|Office of the Registrar General",
}


@pytest.mark.parametrize("kind", NAMES)
def test_names_tell_kinds_and_other_words_none(kind: RoomKind) -> None:
    read = {name: room_kind(name) for name in NAMES[kind].split("|")}
    assert read == dict.fromkeys(read, kind)


def test_spelling_case_and_numbers_change_nothing() -> None:
    for text, word in WORDS.exact.items():
        if word.is_room and word.where != "alone" and word.text.isascii() and "_" not in word.text:
            said = {room_kind(s) for s in (text, text.upper(), text.title() + " 2", f"({text})")}
            assert said == {word.means}, text


@pytest.mark.parametrize("kind", sorted(ROOM_KINDS))
def test_letters_that_ocr_confuses_cost_no_long_word_its_kind(kind: str) -> None:
    words = [t for t, w in WORDS.exact.items() if w.means == kind and w.where in ("word", "label")]
    long = [word for word in words if len(word) >= 8]
    assert {room_kind(word.replace("o", "0").replace("l", "1")) for word in long} == {kind}
    lost = [room_kind(word[:2] + word[3:]) for word in long]
    assert lost.count(kind) > 0.95 * len(lost)
