"""looks: the families of wall and floor looks."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands.common import (
    Outcome,
    Parser,
    UsageError,
    Verbs,
    add_group,
    add_output,
    add_verb,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.base.scene.look_families import Family, Parameter
    from chord_usd.library.looks.look_wood import Maps

_DRAWS = 12
"""Looks on the sheet of a family."""


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "looks", "the looks of walls and floors")
    add_verb(group, "list", run_list, "list the families of looks, their parameters and ranges")
    show = add_verb(group, "show", run_show, "show one family with parameters as given")
    show.add_argument("family", metavar="FAMILY", help="as chord-usd looks list prints it")
    _add_set(show)
    show.add_argument("--picture", type=output_file, metavar="PNG", help="also draw 2.4 m of it")
    sheet = add_verb(group, "sheet", run_sheet, "draw looks beside each other, 2.4 m of each")
    sheet.add_argument(
        "family", nargs="?", metavar="FAMILY", help="several draws of one family (all families)"
    )
    _add_set(sheet)
    add_options(sheet, unset=("style",), style="materials of a home of this style and seed")
    add_options(sheet, "seed")
    add_output(sheet, "the sheet, PNG", suffixes=(".png",))


def _add_set(parser: Parser) -> None:
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", dest="settings",
        help="a parameter, such as width_m=0.2; may be given several times",
    )  # fmt: skip


def run_list(options: argparse.Namespace) -> Outcome:
    """Runs looks list."""
    from chord_usd.base.scene.look_families import load_families

    families = load_families().values()
    lines = []
    for family in families:
        lines.append(f"{family.name:<12} {family.surface:<6} {family.label}")
        lines += [f"    {p.name:<14} {p.expected()}" for p in family.parameters.values()]
    return Outcome("\n".join(lines), {"families": [_described(family) for family in families]})


def run_show(options: argparse.Namespace) -> Outcome:
    """Runs looks show."""
    from chord_usd.base.scene.look_families import family_named
    from chord_usd.library.looks.look_drawing import draw_look
    from chord_usd.library.looks.look_library import look_name
    from chord_usd.library.looks.look_sheet import draw_looks

    family = family_named(options.family)
    settings = family.settings(_settings(options.settings), "--set")
    name = look_name(family, settings)
    if options.picture:
        with deliver() as delivery, stopwatch(options).step("draw"):
            target = delivery.place(options.picture)
            draw_looks([(name, family.label, draw_look(family, settings))]).save(target, "PNG")
    lines = [f"{name}: {family.label}, {family.surface}"]
    for parameter in family.parameters.values():
        about = f"{parameter.about}; {parameter.expected()}"
        lines.append(f"    {parameter.name:<14} {settings[parameter.name]!s:<10} {about}")
    return Outcome("\n".join(lines), {**_described(family), "look": name, "settings": settings})


def run_sheet(options: argparse.Namespace) -> Outcome:
    """Runs looks sheet."""
    from chord_usd.library.looks.look_sheet import draw_looks

    if options.style and (options.family or options.settings):
        raise UsageError("a style chooses families itself", where="--style", expected="no FAMILY")
    with deliver() as delivery, stopwatch(options).step("draw") as progress:
        target = delivery.place(options.output)
        wanted = _of_style(options) if options.style else _of_families(options)
        cells = []
        for done, (title, family, settings) in enumerate(wanted):
            progress(done, len(wanted))
            values = " ".join(str(value) for value in settings.values())
            cells.append((title, values, _maps(family, settings)))
        draw_looks(cells).save(target, "PNG")
        progress(len(wanted), len(wanted))
    data = {"sheet": str(options.output), "looks": len(cells)}
    return Outcome(f"{options.output}: {counted(len(cells), 'look')}", data)


Cell = tuple[str, "Family", dict[str, Any]]


def _maps(family: Family, settings: dict[str, Any]) -> Maps:
    from chord_usd.library.looks.look_drawing import draw_look

    return draw_look(family, settings)


def _of_families(options: argparse.Namespace) -> list[Cell]:
    """One look of each family, or several draws of one."""
    import numpy as np

    from chord_usd.base.scene.look_families import family_named, load_families

    given = _settings(options.settings)
    if options.family is None:
        if given:
            raise UsageError("are those of one family", where="--set", expected="FAMILY")
        return [(family.name, family, {}) for family in load_families().values()]
    family = family_named(options.family)
    family.settings(given, "--set")
    rng = np.random.default_rng(options.seed)
    drawn = []
    for number in range(_DRAWS):
        free = {n: _drawn(p, rng) for n, p in family.parameters.items() if n not in given}
        drawn.append((f"{family.name} {number}", family, {**free, **given}))
    return drawn


def _drawn(parameter: Parameter, rng: Any) -> Any:
    if parameter.range:
        return float(rng.uniform(*parameter.range))
    return str(rng.choice(parameter.choices)) if parameter.choices else parameter.default


def _of_style(options: argparse.Namespace) -> list[Cell]:
    """Every material that rooms of a home may have, each once."""
    import numpy as np

    from chord_usd.base.scene.look_families import family_named
    from chord_usd.base.scene.style_rooms import Part, looks_for
    from chord_usd.base.scene.styles import style_named
    from chord_usd.base.scene.types import Room, RoomKind

    style = style_named(options.style, options.seed)
    kinds: Sequence[RoomKind] = (
        "living", "bedroom", "corridor", "kitchen", "bathroom", "balcony",
    )  # fmt: skip
    parts: Sequence[Part] = ("floor", "wall")
    cells: dict[str, Cell] = {}
    for part in parts:
        for kind in kinds:
            room = Room(kind, kind, np.zeros((4, 2)))
            for look in looks_for(style, options.seed, part, room, 3):
                family = family_named(look.family)
                title = f"{style.name} {kind} {part}: {family.name}"
                cells.setdefault(str(look), (title, family, dict(look.settings)))
    return list(cells.values())


def _settings(words: Sequence[str]) -> dict[str, str]:
    """Parameters as NAME=VALUE. Raises UsageError."""
    for word in words:
        if "=" not in word:
            raise UsageError(
                f"is {word[:40]!r}", where="--set", expected="NAME=VALUE, such as width_m=0.2"
            )
    return {name: value for name, _, value in (word.partition("=") for word in words)}


def _described(family: Family) -> dict[str, Any]:
    return {
        "name": family.name,
        "label": family.label,
        "surface": family.surface,
        "parameters": {
            parameter.name: {
                **({"range": list(parameter.range)} if parameter.range else {}),
                **({"choices": list(parameter.choices)} if parameter.choices else {}),
                "default": parameter.default,
                "about": parameter.about,
            }
            for parameter in family.parameters.values()
        },
    }
