"""What a request asks for: its JSON, and of which type each of its fields is."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator, Collection, Iterator, Mapping
from typing import Any

import anyio
from starlette.requests import Request

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.settings import offered_by
from chord_usd.faces.page.uploads import UploadError

MOST_JSON_BYTES = 8 * 2**20
LONGEST_TEXT = 2000

SLOWEST_S = 30.0
"""A request that sends nothing for so long is ended."""

PACKS = {
    "usda": "house.zip", "web": "house.usdz", "ar": "house_ar.usdz", "gltf": "house.glb",
    "ifc": "house.ifc", "dxf": "house.dxf", "mujoco": "house_mujoco.zip", "ros": "house_ros.zip",
    "blend": "house.blend",
}  # fmt: skip
"""What can be taken away, and the name of its file: the folder of the stage, else export's."""

QUALITIES = {"draft": ("draft", "640x360"), "good": ("good", "1280x720")}
"""What render is asked for, by the name on the page."""

Fields = Mapping[str, type | tuple[type, ...]]

GIVEN: Fields = {
    "version": int, "part": int, "force": int, "scale": (int, float), "keep": list,
    **{option.name: type(option.default) for option in offered_by("page")},
    **dict.fromkeys(
        (
            "room", "with", "without", "text", "sentence", "category", "size", "model", "colour",
            "camera", "quality", "lighting", "for",
        ),
        str,
    ),
}  # fmt: skip
"""What jobs are given."""

NEEDED = {
    "refurnish": ("version", "room"), "say": ("version", "sentence"),
    "models": ("category", "size"), "swap": ("version", "model"),
    "render": ("version", "camera"), "check": ("version",),
    "view": ("version",), "pack": ("version", "for"),
}  # fmt: skip

CHOICES: Mapping[str, Collection[str]] = {
    "for": PACKS,
    "quality": QUALITIES,
    # Names only: the verb takes an HDRI of the machine's disk, too.
    **{
        option.name: option.offered or option.choices
        for option in offered_by("page")
        if option.offered or option.choices
    },
}


async def parts_of(request: Request) -> AsyncIterator[bytes]:
    """The body of a request, part by part. Raises UploadError where it stops for SLOWEST_S."""
    stream = request.stream()
    while True:
        try:
            with anyio.fail_after(SLOWEST_S):
                part = await anext(stream)
        except StopAsyncIteration:
            return
        except TimeoutError:
            raise UploadError("the request takes too long", 408) from None
        yield part


async def fields_of(request: Request, fields: Fields) -> dict[str, Any]:
    """The JSON object of a request, with none but these fields; any may be missing.

    Raises ChordError for anything else.
    """
    data = bytearray()
    async for part in parts_of(request):
        data += part
        if len(data) > MOST_JSON_BYTES:
            raise UploadError("the request is too large", 413)
    body = parse_json(bytes(data), "the request")
    if not isinstance(body, dict):
        raise ChordError("the request is no JSON object")
    if not all(map(math.isfinite, _floats_in(body))):
        raise ChordError("the request holds a number that is not finite")
    _require_types(body, fields)
    return body


def given_of(kind: str, given: object) -> dict[str, Any]:
    """What a job is given, as it can be put on a command line. Raises ChordError."""
    if not isinstance(given, dict):
        raise ChordError("what the job is given is no object")
    _require_types(given, GIVEN)
    for name, value in given.items():
        for text in value if isinstance(value, list) else [value]:
            if isinstance(value, list) and not isinstance(text, str):
                raise ChordError(f"{name} holds other things than texts")
            if isinstance(text, str) and (len(text) > LONGEST_TEXT or "\0" in text):
                raise ChordError(
                    f"{name} is no text", expected=f"at most {LONGEST_TEXT} characters"
                )
    for name in NEEDED.get(kind, ()):
        if not given.get(name):
            raise ChordError(f"{kind} needs {name}")
    for name, choices in CHOICES.items():
        if given.get(name) and given[name] not in choices:
            raise ChordError(f"there is no such {name}", expected=f"one of {', '.join(choices)}")
    for option in offered_by("page"):
        if option.limits and given.get(option.name) is not None:
            option.refuse(given[option.name])
    return given


def _require_types(given: Mapping[str, Any], fields: Fields) -> None:
    """Raises ChordError for a field of another name or type; null stands for a missing one."""
    for name, value in given.items():
        if name not in fields:
            raise ChordError(f"{name[:40]!r} is no field", expected=f"{', '.join(fields)}")
        # To Python a truth value is a number.
        right = isinstance(value, fields[name]) and not isinstance(value, bool)
        if value is not None and not right:
            raise ChordError(f"{name} is of another type")


def _floats_in(value: object) -> Iterator[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _floats_in(inner)
