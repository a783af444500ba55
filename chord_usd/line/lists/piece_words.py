"""What people call pieces of furniture, in the languages of room_names. Blanks are "_"."""

from __future__ import annotations

import math
from typing import NamedTuple

from chord_usd.base.scene.types import RoomKind

_WORDS = {
    "bed": "bed bett lit cama sang vuode sanky 床 ベッド",
    "bed_background": "bed_background bed_panel headboard",
    "bedside_table": "bedside_table bedside_cabinet nightstand night_stand night_table nachttisch"
    " nachtschrank table_de_chevet table_de_nuit mesita_de_noche mesilla_de_noche"
    " mesa_de_cabeceira criado_mudo nattduksbord sangbord yopoyta 床头柜 床頭櫃 ナイトテーブル",
    "sofa": "sofa couch settee canape soffa sohva 沙发 沙發 ソファ ソファー",
    "sofa_background": "sofa_background sofa_panel",
    "single_sofa": "single_sofa armchair arm_chair easy_chair wing_chair club_chair sessel"
    " fauteuil sillon butaca poltrona fatolj nojatuoli 单人沙发 單人沙發 アームチェア",
    "leisure_sofa": "leisure_sofa lounge_chair recliner rocking_chair beanbag bean_bag"
    " schaukelstuhl chaise_longue gungstol keinutuoli",
    "tv_cabinet": "tv_cabinet tv_stand tv_unit tv_bench tv_table tv television media_unit"
    " media_console fernseher fernsehschrank tv_schrank meuble_tv televiseur televisor"
    " televisao mueble_de_tv tv_bank tv_taso 电视 電視 电视柜 電視櫃 テレビ テレビ台",
    "coffee_table": "coffee_table low_table tea_table couchtisch table_basse mesa_de_centro"
    " soffbord sohvapoyta 茶几 コーヒーテーブル ローテーブル",
    "side_coffee_table": "side_coffee_table side_table end_table beistelltisch mesa_auxiliar"
    " mesa_lateral sidobord apupoyta サイドテーブル",
    "dining_table": "dining_table dinner_table kitchen_table esstisch table_a_manger"
    " mesa_de_comedor mesa_de_jantar matbord ruokapoyta 餐桌 食卓 ダイニングテーブル",
    "chair": "chair seat stool dining_chair kitchen_chair desk_chair office_chair stuhl hocker"
    " chaise tabouret silla cadeira stol tuoli 椅子 チェア",
    "table": "table desk work_desk work_table writing_desk computer_desk dressing_table tisch"
    " schreibtisch bureau escritorio mesa escrivaninha skrivbord bord poyta tyopoyta"
    " kirjoituspoyta 书桌 書桌 桌子 机 デスク テーブル",
    "cabinet": "cabinet wardrobe closet bookcase book_case bookshelf book_shelf shelf shelving"
    " shelf_unit chest_of_drawers chest dresser drawer cupboard armoire storage_cabinet schrank"
    " kleiderschrank regal bucherregal kommode commode etagere bibliotheque armario estanteria"
    " comoda guarda_roupa roupeiro estante garderob bokhylla byra vaatekaappi kaappi hylly"
    " kirjahylly lipasto 衣柜 衣櫃 书架 書架 柜子 櫃子 本棚 タンス クローゼット",
    "dining_cabinet": "dining_cabinet sideboard buffet china_cabinet vitrine wine_cabinet"
    " anrichte vaisselier aparador",
    "shoe_cabinet": "shoe_cabinet shoe_rack shoe_shelf shoe_storage schuhschrank schuhregal"
    " meuble_a_chaussures zapatero sapateira skoskap skohylla kenkakaappi 鞋柜 鞋櫃 下駄箱",
    "sink_cabinet": "sink_cabinet sink_unit kitchen_sink sink spule evier fregadero pia diskho"
    " tiskiallas 水槽 シンク 流し台",
    "cooker_cabinet": "cooker_cabinet cooker stove oven hob cooktop range herd cuisiniere fogon"
    " estufa fogao spis hella liesi 灶台 炉灶 コンロ",
    "refrigerator": "refrigerator fridge fridge_freezer kuhlschrank frigo refrigerateur nevera"
    " frigorifico geladeira refrigerador kylskap jaakaappi 冰箱 冷蔵庫",
    "electrical_floor_cabinet": "electrical_floor_cabinet electrical_cabinet appliance_cabinet",
    "double_door_floor_cabinet": "double_door_floor_cabinet floor_cabinet base_cabinet"
    " kitchen_cabinet kitchen_unit kitchen_counter worktop",
    "single_door_floor_cabinet": "single_door_floor_cabinet narrow_floor_cabinet",
    "toilet": "toilet wc loo toilette inodoro vaso_sanitario sanita toalett toalettstol"
    " vessanpytty 马桶 馬桶 便器 トイレ",
    "washbasin": "washbasin wash_basin basin hand_basin bathroom_sink vanity vanity_unit"
    " washstand waschbecken lavabo lavatorio handfat tvattstall pesuallas 洗手盆 洗脸盆 洗面台",
    "bathtub": "bathtub bath_tub tub bath badewanne baignoire banera banheira badkar kylpyamme"
    " 浴缸 浴槽 バスタブ",
    "shower": "shower shower_cubicle shower_cabin shower_enclosure dusche douche ducha chuveiro"
    " dusch duschkabin suihku 淋浴 シャワー",
    "washing_machine": "washing_machine washer waschmaschine machine_a_laver lave_linge lavadora"
    " maquina_de_lavar tvattmaskin pesukone 洗衣机 洗衣機 洗濯機",
    "washing_set": "washing_set laundry_set washer_dryer",
}

ANY_M = (0.0, math.inf)

_SIZED = (
    ("bed", (0.0, 1.3), "single_bed twin_bed einzelbett lit_simple cama_individual"
     " cama_de_solteiro enkelsang 单人床 單人床 シングルベッド"),
    ("bed", (1.3, math.inf), "double_bed doppelbett lit_double cama_doble cama_de_matrimonio"
     " cama_de_casal dubbelsang parisanky 双人床 雙人床 ダブルベッド"),
    ("bed", (1.45, 1.75), "queen_bed queen_size_bed queen_sized_bed"),
    ("bed", (1.75, math.inf), "king_bed king_size_bed king_sized_bed"),
    ("sofa", (0.0, 1.9), "loveseat love_seat two_seater two_seater_sofa 2_seater 2_seater_sofa"
     " zweisitzer canape_deux_places"),
    ("sofa", (1.9, math.inf), "three_seater three_seater_sofa 3_seater 3_seater_sofa dreisitzer"
     " canape_trois_places"),
)  # fmt: skip
"""Words that say how long a piece is: metres, along its back."""

_LOUNGE = dict.fromkeys(("armchair", "arm chair", "easy chair"), "leisure_sofa")

HERE: dict[RoomKind, dict[str, str]] = {
    "bedroom": _LOUNGE,
    "study": _LOUNGE,
    "balcony": _LOUNGE,
    "bathroom": {"sink": "washbasin"},
    "kitchen": {"table": "dining_table", "basin": "sink_cabinet"},
    "dining": {"table": "dining_table"},
}
"""Words that mean another category in some rooms."""


class Named(NamedTuple):
    """What a word stands for."""

    word: str
    """As the tables have it, with blanks."""
    category: str
    length_m: tuple[float, float] = ANY_M


WORDS: dict[str, Named] = {
    word.replace("_", ""): Named(word.replace("_", " "), category, length_m)
    for category, length_m, words in (
        *((category, ANY_M, words) for category, words in _WORDS.items()),
        *_SIZED,
    )
    for word in words.split()
}
"""By the word without blanks."""

_PLURALS = ("s", "es", "x", "n", "en", "e", "er", "ar", "r", "a", "ta")


def named(words: list[str]) -> Named | None:
    """What these words together name, singular or plural; None for what is not known."""
    joined = "".join(words)
    stems = [joined, *(joined.removesuffix(end) for end in _PLURALS if joined.endswith(end))]
    stems += [joined[:-3] + "f"] if joined.endswith("ves") else []
    # "Chests of drawers", "tables de chevet": several, said in the first word.
    stems += ["".join([words[0].removesuffix("s"), *words[1:]])] if len(words) > 1 else []
    stems += [stem.removesuffix("s") for stem in stems[-1:]]
    return next((WORDS[stem] for stem in stems if stem in WORDS), None)
