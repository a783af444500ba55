"""The shape of the code, kept by a machine: who may import whom, and what."""

from __future__ import annotations

import ast
import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from tests.every import for_every

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "chord_usd"
MODULES = sorted(PACKAGE.rglob("*.py"))
CODE = sorted(
    file
    for folder in ("chord_usd", "tests", "benchmarks", "examples", "blender_addon")
    for file in (ROOT / folder).rglob("*.py")
)

WINGS: dict[str, tuple[str, ...]] = {
    "base": ("terms", "errors", "runtime", "scene", "raster", "metrics", "places"),
    "library": ("library",),
    "line": (
        *("plan", "planning", "lists", "layout", "graph", "compose", "arrange", "dressing"),
        *("stage", "image", "pipeline"),
    ),
    "workshop": ("data", "training", "evaluation"),
    "faces": ("commands", "page", "batch", "farm", "standby", "worker", "cli", "api"),
}
"""Folders of the package and their parts. `cli` and `api` are doors, and lie at the root."""

BELOW: dict[str, set[str]] = {
    "base": set(),
    "library": {"base"},
    "line": {"base", "library"},
    "workshop": {"base", "library", "line"},
    "faces": {"base", "library", "line", "workshop"},
}
"""Wings that a wing may import."""

BASE = WINGS["base"]
"""Parts that everything may import; each of them, those before it."""

STEPS = tuple(part for part in WINGS["line"] if part != "pipeline")
WORKSHOP = (*WINGS["workshop"], "library", "metrics", "places")
LINE = ("cli", "api", "standby", "commands", "pipeline", "pipeline.planner")

ALLOWED: dict[str, set[str]] = {
    **{part: set(BASE[:index]) for index, part in enumerate(BASE)},
    **{step: set() for step in STEPS},
    "arrange": {"graph", "stage", "library"},
    "stage": {"library"},
    "dressing": {"library"},
    "library": set(),
    "data": {"library", "compose", "lists"},
    "training": {"planning", "lists", "layout", "graph", "data"},
    "evaluation": {
        *("planning", "lists", "layout", "graph", "arrange", "data"),
        "pipeline.as_drawn",
        "pipeline.redraw",
    },
    "farm": set(),
    "page": set(),
    "batch": {"pipeline", "data", "stage", "image"},
    "pipeline.as_drawn": {"arrange"},
    "pipeline.redraw": {"lists", "layout", "compose", "arrange", "pipeline.as_drawn"},
    "pipeline.resample": {"lists", "layout", "pipeline.redraw"},
    "pipeline": {
        *(*STEPS, "library", "pipeline.as_drawn", "pipeline.redraw", "pipeline.resample"),
    },
    "pipeline.planner": {"pipeline", *STEPS},
    "commands": {
        "pipeline",
        "pipeline.as_drawn",
        "pipeline.planner",
        "batch",
        "farm",
        "page",
        *STEPS,
        *WORKSHOP,
    },
    "cli": {"commands"},
    "__main__": {"cli"},
    "standby": {"cli", "pipeline", *STEPS},
    "worker": {"cli", "standby"},
    "api": {"commands", "pipeline", *STEPS},
    "__init__": {"api"},
}
"""What a part may import besides itself and the base. A module named here is its own part."""

HEAVY = {
    "torch": ("layout", "planning", "training", "evaluation"),
    "diffusers": ("layout", "training"),
    "ultralytics": ("training",),
    "onnx": ("training",),
    "pxr": ("runtime", "arrange", "stage", "library", "image"),
    "bpy": ("image", "library"),
    "transformers": ("planning", "training"),
}
"""Which parts may import a heavy library at all."""

LONGEST_FILE_LINES = 500


def name_of(file: Path) -> str:
    return str(file.relative_to(ROOT))


def part_named(names: Sequence[str]) -> str:
    """The part of a module, by the names of its folders and file below the package."""
    below = names[1:] if names[0] in WINGS and names[0] != "library" else names
    two = ".".join(below[:2])
    return two if two in ALLOWED else below[0] if below else names[0]


def part_of(file: Path) -> str:
    """The part of a file."""
    return part_named(file.relative_to(PACKAGE).with_suffix("").parts)


def wing_of(part: str) -> str:
    """The wing of a part; of entries at the root, the faces."""
    part = part.split(".")[0]
    return next((wing for wing, parts in WINGS.items() if part in parts), "faces")


def imports_of(node: ast.AST) -> Iterator[tuple[str, ast.stmt]]:
    """Full names of everything imported in a tree."""
    for child in ast.walk(node):
        if isinstance(child, ast.Import):
            for alias in child.names:
                yield alias.name, child
        elif isinstance(child, ast.ImportFrom):
            assert child.level == 0, "relative import"
            for alias in child.names:
                yield f"{child.module}.{alias.name}", child


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text())


def parts_imported(file: Path) -> set[str]:
    names = (name.split(".") for name, _ in imports_of(parsed(file)))
    own = {part_named(name[1:]) for name in names if name[0] == "chord_usd" and len(name) > 1}
    return {part for part in own if part in ALLOWED}


def only_for_types(tree: ast.Module) -> set[ast.stmt]:
    """Imports under `if TYPE_CHECKING`, which never run."""
    return {
        statement
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for statement in node.body
    }


@for_every("file", MODULES, ids=name_of)
def test_imports_point_one_way(file: Path) -> None:
    part = part_of(file)
    foreign = parts_imported(file) - {part}
    assert part in ALLOWED, "a module at the root that no part is"
    allowed = ALLOWED[part] | (set() if part in BASE else set(BASE))
    assert foreign <= allowed, f"{part} imports {foreign - allowed}"


def test_folders_are_wings() -> None:
    folders = {file.name for file in PACKAGE.iterdir() if (file / "__init__.py").is_file()}
    assert folders == set(WINGS)


@for_every("part", sorted(ALLOWED))
def test_parts_import_no_wing_above_theirs(part: str) -> None:
    wing = wing_of(part)
    assert {wing_of(other) for other in ALLOWED[part]} <= {wing, *BELOW[wing]}


@for_every("file", MODULES, ids=name_of)
def test_heavy_libraries_stay_in_their_step(file: Path) -> None:
    part = part_of(file)
    tree = parsed(file)
    heavy = {name.split(".")[0] for name, _ in imports_of(tree)} & set(HEAVY)
    wrong = {library for library in heavy if part not in HEAVY[library]}
    assert not wrong, f"{part} imports {wrong}"


@for_every("file", [f for f in MODULES if part_of(f) not in (*STEPS, *WORKSHOP)], ids=name_of)
def test_the_line_and_the_base_import_steps_only_inside_functions(file: Path) -> None:
    """So that `chord-usd --help` does not wait for numpy, let alone torch."""
    tree = parsed(file)
    skipped = only_for_types(tree)
    line = part_of(file) in LINE
    for statement in tree.body:
        if statement in skipped or not isinstance(statement, ast.Import | ast.ImportFrom):
            continue
        for name, _ in imports_of(statement):
            parts = name.split(".")
            assert parts[0] not in HEAVY, name
            if parts[0] == "chord_usd" and len(parts) > 1:
                assert part_named(parts[1:]) not in (*STEPS, *WORKSHOP), name
            assert not (line and parts[0] in ("numpy", "PIL", "cv2", "shapely")), name


@for_every("file", CODE, ids=name_of)
def test_files_are_short_enough_to_read(file: Path) -> None:
    assert len(file.read_text().splitlines()) < LONGEST_FILE_LINES


@for_every(
    "file",
    [
        *CODE,
        *(ROOT / f for f in ("Makefile", "pyproject.toml", "constraints.txt", "README.md")),
        *(ROOT / "checkpoints").rglob("*.json"),
        *(ROOT / "checkpoints").rglob("*.yaml"),
        *(ROOT / "materials").rglob("*.usda"),
    ],
    ids=name_of,
)
def test_no_absolute_paths(file: Path) -> None:
    """A path of one machine is wrong on every other."""
    personal = re.compile(r"""/(?:home|root|Users|work|mnt|opt|workspace)/|[A-Z]:\\\\Users""")
    if file == Path(__file__):
        return
    found = [line for line in file.read_text().splitlines() if personal.search(line)]
    assert not found


def test_every_palette_colour_is_written_once() -> None:
    """One table per fact: no other module holds the paper's colours."""
    code = re.compile(r"""["']#?([0-9A-Fa-f]{6})["']""")
    rows = csv.DictReader((PACKAGE / "base/scene/categories.tsv").open(), delimiter="\t")
    colours = {row["colour"] for row in rows if row["colour"]}
    assert len(colours) > 28
    assert [name_of(f) for f in MODULES if colours & set(code.findall(f.read_text()))] == []


VERBS_AND_THEIR_STEPS = {"check", "describe", "diff", "export", "looks", "render"}
"""A verb is called as the step's module that does it."""


def test_a_name_stands_for_one_module() -> None:
    names = Counter(file.stem for file in MODULES)
    twice = {name for name, count in names.items() if count > 1}
    assert twice <= VERBS_AND_THEIR_STEPS | {"__init__", "__main__"}


def test_a_wheel_holds_every_file_of_the_package() -> None:
    """setup.py names all that is no code, by patterns."""
    lists = [node for node in ast.walk(parsed(ROOT / "setup.py")) if isinstance(node, ast.List)]
    texts = (ast.literal_eval(item) for one in lists for item in one.elts
             if isinstance(item, ast.Constant))  # fmt: skip
    shipped = {file for pattern in texts for file in PACKAGE.glob(str(pattern))}
    files = {file for file in PACKAGE.rglob("*") if file.is_file()}
    assert {file for file in files - shipped if file.suffix not in (".py", ".pyc")} == set()
