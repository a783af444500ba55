"""Options of a house: one table for the command line, Python, agents, the page and the panel.

Each field of Settings is a row. Its Option holds the range, the help and the word of the command
line; faces build arguments, schemas, form fields and documents from these rows.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypedDict, get_type_hints

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.articulation import FIXED, JOINTED
from chord_usd.base.scene.limits import M_PER_PX, PARTS, REDRAWS, SEEDS, STEPS, TEXTURE_PX
from chord_usd.base.scene.roof_forms import NO_ROOF, ROOF_FORMS, RoofForm
from chord_usd.base.scene.skies import SKIES
from chord_usd.base.scene.states import states_said
from chord_usd.base.scene.styles import MIXED, STYLES, style_named

DEVICES = ("auto", "cpu", "cuda")

SAMPLERS = ("ddim", "dpm", "ddpm")

FACES = ("page", "agent", "panel")
"""Faces that offer an option beside the command line and Python, which offer all."""


@dataclass(frozen=True)
class Option:
    """A row: how faces offer a field of Settings."""

    name: str
    """Field of Settings, and keyword of Python."""
    default: Any
    help: str
    label: str
    """Of a form field."""
    word: str
    """Option of the command line, without dashes; of a field that is True by default, the option
    that makes it False."""
    metavar: str | None = None
    limits: tuple[float, float] | None = None
    """Least and greatest number, both included: whole numbers where the least is an int."""
    choices: tuple[str, ...] = ()
    offered: tuple[str, ...] = ()
    """Choices of a form; other values are valid, too."""
    check: Callable[[str], str] | None = None
    """Returns a valid value. Raises ChordError."""
    decides_models: bool = False
    """Whether other networks or meshes are loaded for another value."""
    faces: tuple[str, ...] = ()
    """Members of FACES that offer it."""

    def refuse(self, value: object) -> None:
        """Raises ChordError for a value out of range."""
        if value == self.default and type(value) is type(self.default):
            return
        if self.limits:
            least, most = self.limits
            is_whole = isinstance(least, int)
            number = isinstance(value, int if is_whole else int | float)
            if isinstance(value, bool) or not (number and least <= value <= most):  # type: ignore[operator]
                kind = "a whole number from " if is_whole else ""
                unit = "" if is_whole else " metres per pixel"
                raise _refused(self.name, value, f"{kind}{least:g} to {most:g}{unit}")
        elif self.choices and value not in self.choices:
            raise _refused(self.name, value, f"one of {', '.join(self.choices)}")
        elif self.check and value:
            self.check(str(value))


def _refused(name: str, value: object, expected: str) -> ChordError:
    return ChordError(
        f"cannot be {repr(value)[:30]}", where=f"<{name}>", value=value, expected=expected
    )


def _row(default: Any, help: str, label: str = "", word: str = "", **more: Any) -> Any:
    """A field of Settings with its Option; __set_name__ of a dataclass field names the row."""
    return field(default=default, metadata={"help": help, "label": label, "word": word, **more})


def style_name(text: str) -> str:
    """The name of a style, or mixed. Raises ChordError with the names that exist."""
    if text != MIXED:
        style_named(text, 0)
    return text


@dataclass(frozen=True)
class Settings:
    """Options of a house; the fields are the table. Raises ChordError for a value out of range."""

    seed: int = _row(0, "same seed, same house (0)", "Seed", metavar="N", limits=SEEDS, faces=FACES)
    style: str = _row(
        MIXED, f"{', '.join(STYLES)} or {MIXED} ({MIXED}: one of them by the seed)", "Style",
        metavar="NAME", check=style_name, offered=(MIXED, *STYLES), faces=FACES,
    )  # fmt: skip
    """"" keeps the style that a scene or a stage notes, and samples one by seed without a note."""
    texture_px: int = _row(
        1024, "side of the textures of floors and walls; furniture has half of it (1024)",
        "Textures", "texture-size", metavar="PX", limits=TEXTURE_PX, decides_models=True,
    )  # fmt: skip
    articulation: str = _row(
        FIXED, "jointed: doors, drawers and lids of furniture open (fixed)", "Articulation",
        choices=(FIXED, JOINTED), faces=("panel",),
    )  # fmt: skip
    steps: int | None = _row(
        None, "sampler steps (the checkpoint's own)", "Steps", metavar="N", limits=STEPS,
        faces=("agent", "panel"),
    )  # fmt: skip
    sampler: str | None = _row(
        None, "ddim, dpm (DPM-Solver++) or ddpm, the paper's (the checkpoint's own)", "Sampler",
        choices=SAMPLERS, decides_models=True,
    )  # fmt: skip
    lists: bool = _row(
        True, "let the diffusion model alone decide what a room holds, as in the paper", "Lists",
        "no-list", decides_models=True,
    )  # fmt: skip
    arrange: bool = _row(
        True, "leave every piece where the models put it, also in others and before doors",
        "Arrange", "no-arrange", decides_models=True,
    )  # fmt: skip
    furniture: str = _row(
        "", 'required and excluded pieces: "Bedroom 1: double bed, desk; Bathroom: no bathtub"',
        "Wishes", metavar="WISHES", faces=FACES,
    )  # fmt: skip
    standard: str = _row(
        "", "published numbers to plan to: NKBA, DIN 18040-2, DIN 18040-2 R or M4(3); several with "
        "commas", "Standard", metavar="NAME",
    )  # fmt: skip
    state: str = _row(
        "", 'what stands open and which lamps are on: "doors: closed; bedroom 1 lamp: off"',
        "States", metavar="STATES", check=states_said, faces=FACES,
    )  # fmt: skip
    redraws: int = _row(
        2, "sample rooms with faults again, at most N times (2)", "Redraws", metavar="N",
        limits=REDRAWS,
    )  # fmt: skip
    m_per_px: float | None = _row(
        None, "metres per pixel of a plan picture, or per unit of a vector file", "Scale", "scale",
        metavar="M_PER_PX", limits=M_PER_PX, faces=("panel",),
    )  # fmt: skip
    part: int = _row(
        1, "which plan of a sheet, by floor area, or storey, by rooms with doors (1, the most)",
        "Plan or storey", metavar="N", limits=PARTS, faces=("panel",),
    )  # fmt: skip
    dwelling: int = _row(
        0, "only this dwelling of a plan that shows several (all)", "Dwelling", metavar="N",
        limits=(0, PARTS[1]), faces=("agent",),
    )  # fmt: skip
    homes_only: bool = _row(
        True, "furnish what is no home, too: offices, schools, shops", "Homes only", "anyway",
        faces=("agent",),
    )  # fmt: skip
    rooms: str = _row(
        "", 'kinds of rooms, by their numbers on the overlay or ids: "3: bedroom, 5: bathroom"; '
        'of several storeys, "1/3: bedroom"', "Rooms", metavar="KINDS", faces=("agent",),
    )  # fmt: skip
    drawn: bool = _row(
        True, "furnish an empty plan: nothing is kept of the furniture that the drawing shows",
        "As drawn", "ignore-drawn", faces=("agent",),
    )  # fmt: skip
    tabletop: bool = _row(
        True, "leave tables, desks and worktops bare", "Objects on tables", "no-tabletop",
        decides_models=True, faces=("panel",),
    )  # fmt: skip
    dressing: bool = _row(
        True, "leave walls, windows, ceilings, floors and shelves bare, as in the paper",
        "Dressing", "no-dressing", faces=("panel",),
    )  # fmt: skip
    sky: str = _row(
        "", "morning, noon, overcast, evening or night, or a HDRI file, .hdr or .exr (noon)",
        "Sky", metavar="NAME", offered=("", *(sky.name for sky in SKIES)), faces=FACES,
    )  # fmt: skip
    roof: RoofForm = _row(  # noqa: RUF009
        NO_ROOF, "form of a roof: choice of the house's variant set `roof`, left at none (none)",
        "Roof", choices=ROOF_FORMS, faces=("page", "panel"),
    )  # fmt: skip
    asset_folders: tuple[Path, ...] = _row(
        (), "a folder of further meshes; may be given several times", "Assets", "assets",
        metavar="DIR", decides_models=True, faces=("panel",),
    )  # fmt: skip
    device: str = _row(
        "auto", "where the networks run", "Device", choices=DEVICES, decides_models=True
    )

    def __post_init__(self) -> None:
        for option in OPTIONS.values():
            option.refuse(getattr(self, option.name))


class HouseOptions(TypedDict, total=False):
    """Fields of Settings as keywords of Python, for type checkers."""

    seed: int
    style: str
    texture_px: int
    articulation: str
    steps: int | None
    sampler: str | None
    lists: bool
    arrange: bool
    furniture: str
    standard: str
    state: str
    redraws: int
    m_per_px: float | None
    part: int
    dwelling: int
    homes_only: bool
    rooms: str
    drawn: bool
    tabletop: bool
    dressing: bool
    sky: str
    roof: RoofForm
    asset_folders: tuple[Path, ...]
    device: str


def _option(name: str, default: Any, row: Mapping[str, Any]) -> Option:
    word = row["word"] or name.replace("_", "-")
    return Option(name, default, **{**row, "word": word, "label": row["label"] or name})


OPTIONS: Mapping[str, Option] = {
    item.name: _option(item.name, item.default, item.metadata) for item in fields(Settings)
}
"""Rows by name, in the order of help pages."""


def described(names: Iterable[str] = OPTIONS) -> str:
    """Rows as the arguments of a docstring."""
    rows = (OPTIONS[name] for name in names)
    return "\n".join(
        f"    {row.name}: {'False: ' if row.default is True else ''}{row.help}." for row in rows
    )


def with_keywords(function: Callable[..., Any]) -> inspect.Signature:
    """The signature of a function with **options, each row as a keyword of its own."""
    signature = inspect.signature(function)
    known = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    kind = inspect.Parameter.KEYWORD_ONLY
    types = get_type_hints(HouseOptions)
    rows = [
        inspect.Parameter(o.name, kind, default=o.default, annotation=types[o.name])
        for o in OPTIONS.values()
    ]
    return signature.replace(parameters=[*known, *rows])


def offered_by(face: str) -> tuple[Option, ...]:
    """Rows that one of FACES offers."""
    return tuple(option for option in OPTIONS.values() if face in option.faces)


def form_field(option: Option) -> dict[str, Any]:
    """A row as JSON: name, label, help, default, kind (number, choice, text), range or choices."""
    kind = "number" if option.limits else "text"
    entry: dict[str, Any] = {"name": option.name, "label": option.label, "help": option.help}
    if choices := option.choices or option.offered:
        kind, entry["choices"] = "choice", list(choices)
    if option.limits:
        entry["least"], entry["most"] = option.limits
    default = list(option.default) if isinstance(option.default, tuple) else option.default
    return {**entry, "kind": "check" if isinstance(default, bool) else kind, "default": default}


def words_of(chosen: Mapping[str, object], unset: Collection[str] = ()) -> list[str]:
    """Words of a command line for values by name; none for a default, None and "".

    unset: rows without a default. A value follows an equals sign: it may begin with a dash.
    """
    words: list[str] = []
    for name, value in chosen.items():
        option = OPTIONS[name]
        is_default = value == option.default and name not in unset
        if value in (None, "") or is_default:
            continue
        if isinstance(option.default, bool):
            words.append(f"--{option.word}")
            continue
        values = value if isinstance(value, list | tuple) else [value]
        words += [f"--{option.word}={item}" for item in values]
    return words
