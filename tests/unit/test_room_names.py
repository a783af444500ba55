"""Room kinds from names, as they are printed on plans."""

from __future__ import annotations

import pytest

from chord_usd.room_names import room_kind
from chord_usd.types import RoomKind

NAMES: dict[RoomKind, str] = {
    "living": "Lounge|Living Room 2|Wohnzimmer|Séjour|Salón|Sala de Estar|VARDAGSRUM|Olohuone|OH"
    "|客厅|リビング|LDK 12.5帖|salle de séjour",
    "dining": "Dining|Esszimmer|Salle à manger|Comedor|Sala de jantar|MATPLATS|Ruokailutila|餐厅",
    "bedroom": "Master Bedroom 2|bed 3|Schlafzimmer|Chambre 1|Dormitorio|Quarto|SOVRUM 1"
    "|Makuuhuone|MH2|主卧|洋室 6帖|和室",
    "kitchen": "Kitchen|Küche|Cuisine|Cocina|Cozinha|KÖK|Keittiö|厨房|台所|DK",
    "bathroom": "Bathroom|WC|Gäste-WC|Bad|Salle de bain|Salle d'eau|Baño|Casa de banho|Banheiro"
    "|BADRUM|Kylpyhuone|KH|卫生间|浴室|洗面所|トイレ",
    "balcony": "Balcony|Terrasse|Balcon|Balcón|Varanda|BALKONG|Parveke|阳台|バルコニー",
    "corridor": "Hall|Landing|Flur|Couloir|Entrée|Pasillo|Corredor|ENTRÉ|Eteinen|ET|走廊|玄関",
    "study": "Study|Home Office|Büro|Bureau|Despacho|Escritório|Arbetsrum|Työhuone|书房",
    "store": "Closet|Abstellraum|Cellier|Trastero|Despensa|KLK|Förråd|Vaatehuone|储藏室|押入",
    "unknown": "|Garden|BH=700|13 m²|SIZES ARE APPROXIMATE",
}


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, names in NAMES.items() for name in names.split("|")]
)
def test_names_tell_kinds(kind: RoomKind, name: str) -> None:
    assert room_kind(name) == kind
