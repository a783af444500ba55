"""What is fuzzed: kinds of input, how each is changed, and the command lines that read it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePath
from random import Random

from outside import mutate
from outside.mutate import Mutator

Words = tuple[str, ...]


@dataclass(frozen=True)
class Kind:
    """One kind of input."""

    samples: tuple[str, ...]
    """Files, or folders of which one file is changed, below the folder of samples."""
    commands: tuple[Words, ...]
    """{in} is the changed file or folder, {dir} the folder it lies in, {out} a path for an output,
    without a suffix. `call MODULE:FUNCTION {in}` calls a reader."""
    changed: tuple[str, ...] = ("*",)
    """Of a folder: patterns of the files that are changed."""
    env: Mapping[str, str] = field(default_factory=dict)


def mutator_of(name: str) -> Mutator:
    """How a file of this name is changed."""
    return _BY_SUFFIX.get(PurePath(name).suffix.lower(), mutate.generic)


def _text_file(data: bytes, rng: Random) -> bytes:
    return mutate.lines(data, rng) if rng.random() < 0.7 else mutate.generic(data, rng)


_BY_SUFFIX: dict[str, Mutator] = {
    ".json": mutate.json_text, ".jsonl": mutate.json_lines, ".gz": mutate.json_lines,
    ".svg": mutate.xml, ".xml": mutate.xml, ".png": mutate.png, ".glb": mutate.glb,
    ".usda": mutate.usda, ".dxf": _text_file, ".ifc": _text_file, ".pdf": _text_file,
    ".obj": _text_file, ".properties": _text_file, ".mtl": _text_file,
    ".sh3d": mutate.zipped(lambda name: mutator_of(name)),
    ".sh3f": mutate.zipped(lambda name: mutator_of(name)),
    ".usdz": mutate.zipped(lambda name: mutator_of(name)),
}  # fmt: skip

READ = ("plan", "read", "{in}", "-o", "{out}.json")
SCALED = (*READ, "--scale", "0.05")
_PICTURES = tuple(f"plan.{s}" for s in ("png", "jpg", "webp", "tiff", "gif", "bmp"))

KINDS: dict[str, Kind] = {
    "picture": Kind((*_PICTURES, "lines.png"), (READ, SCALED, (*READ, "--overlay", "{out}.png"))),
    "pdf": Kind(("plan.pdf",), (READ, SCALED)),
    "svg": Kind(("plan.svg",), (READ, SCALED)),
    "dxf": Kind(("plan.dxf",), (READ, SCALED)),
    "ifc": Kind(("plan.ifc",), (READ, (*READ, "--part", "2"))),
    "sh3d": Kind(("plan.sh3d",), (READ,)),
    "plan json": Kind(
        ("plan.json",),
        (("plan", "draw", "{in}", "-o", "{out}.png"), READ, ("plan", "draw", "{in}", "-o",
        "{out}.png")),
    ),
    "scene json": Kind(
        ("small.json", "scene.json"),
        (("call", "chord_usd.base.scene.chord_json:read_scene", "{in}"),) * 9
        + (("stage", "{in}", "-o", "{out}.usda"),),
    ),
    "layout png": Kind(
        ("layout.png", "plan.png"),
        (("call", "chord_usd.base.raster.raster_files:read_layout", "{in}"),) * 9
        + (("graph", "{in}", "-o", "{out}.json"), ("layout", "{in}", "-o", "{out}.png", "--steps",
        "1")),
    ),
    "stage": Kind(
        ("house",),
        (
            ("check", "{in}/house.usda"), ("describe", "{in}/house.usda"),
            ("diff", "{in}/house.usda", "{dir}/house.usdz"),
            ("export", "{in}/house.usda", "--for", "web", "-o", "{out}.usdz"),
            ("export", "{in}/house.usda", "--for", "gltf", "-o", "{out}.glb"),
            ("farm", "bundle", "{in}/house.usda", "-o", "{out}"),
            ("regenerate", "{in}/house.usda", "--room", "Bedroom_0", "--steps", "1",
            "--no-tabletop",
             "-o", "{out}.usda"),
        ),
        ("house.usda", "house.usda", "*.usda", "*.usdc", "*.png", "*.jpg"),
    ),
    "stage binary": Kind(
        ("house",),
        (("check", "{in}/house.usdc"), ("describe", "{in}/house.usdc"),
         ("export", "{in}/house.usdc", "--for", "web", "-o", "{out}.usdz"),
         ("diff", "{in}/house.usda", "{in}/house.usdc")),
        ("house.usdc",),
    ),
    "package": Kind(
        ("house.usdz",),
        (("check", "{in}"), ("describe", "{in}"), ("diff", "{in}", "{in}"),
         ("regenerate", "{in}", "--room", "Bedroom_0", "--steps", "1", "--no-tabletop", "-o",
         "{out}.usdz"),
         ("export", "{in}", "--for", "gltf", "-o", "{out}.glb")),
    ),
    "edits": Kind(
        ("house",),
        (("regenerate", "{in}/house.usda", "--room", "Bedroom_0", "--edits", "{in}/edits.usda",
          "--steps", "1", "--no-tabletop", "-o", "{out}.usda"),
         ("check", "{in}/edits.usda"), ("diff", "{in}/house.usda", "{in}/edits.usda")),
        ("edits.usda",),
    ),
    "library": Kind(
        ("library",), (("assets", "add", "{in}", "-o", "{out}"),),
        ("manifest.json", "*.glb", "*.obj"),
    ),
    "sh3f": Kind(("chairs.sh3f",), (("assets", "add", "{in}", "-o", "{out}"),)),
    "database": Kind(
        ("database",),
        (("assets", "nearest", "chair", "--size", "0.5x0.5x0.9", "--assets", "{in}"),
         ("assets", "list", "--assets", "{in}"),
         ("stage", "{dir}/small.json", "-o", "{out}.usda", "--assets", "{in}")),
        ("index.json", "index.json", "*.usda", "*.usdc"),
    ),
    "flats": Kind(
        ("flats.jsonl", "flats.jsonl.gz"),
        (("call", "chord_usd.workshop.data.flats:read_flats", "{in}"),
         ("dataset", "import", "{in}", "-o", "{out}")),
    ),
    "foreign": Kind(
        ("front.json", "procthor.json", "mixed.jsonl"),
        (("dataset", "import", "{in}", "-o", "{out}"),
         ("dataset", "import", "{in}", "-o", "{out}", "--furnish"),
         ("dataset", "stats", "{dir}/houses", "--against", "{in}")),
    ),
    "models": Kind(
        ("model_info.json", "asset-database.json"),
        (("dataset", "import", "{dir}/mixed.jsonl", "--models", "{in}", "-o", "{out}"),),
    ),
    "houses": Kind(
        ("houses",),
        (("dataset", "stats", "{in}"), ("dataset", "clean", "{in}", "-o", "{out}"),
         ("dataset", "draw", "{in}"), ("dataset", "import", "{in}", "-o", "{out}")),
    ),
    "checkpoints": Kind(
        ("checkpoints",), (("plan", "from-text", "two bedrooms", "-o", "{out}.png"),),
        ("*.json", "*.safetensors", "*.onnx", "SHA256SUMS"), {"CHORD_USD_CHECKPOINTS": "{in}"},
    ),
}  # fmt: skip

NEEDS = ("house.usdz", "small.json", "mixed.jsonl", "houses")
"""What commands name beside the changed file, in {dir}; it is put there whole."""
