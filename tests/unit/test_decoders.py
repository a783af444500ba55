"""Strangers' bytes are decoded in processes with limits, by the readers of one table."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from chord_usd.base.runtime.confined import DECODERS
from tests.unit.test_architecture import MODULES, PACKAGE, parsed

LIBRARIES = {
    "PIL.Image.open", "PIL.ImageFile.Parser",
    "cv2.imread", "cv2.imreadmulti", "cv2.imdecode", "cv2.VideoCapture",
    "OpenEXR.File", "OpenEXR.InputFile",
    "trimesh.load", "trimesh.load_mesh", "trimesh.load_scene", "trimesh.load_path",
    "pxr.Usd.Stage.Open", "pxr.Usd.Stage.OpenMasked", "pxr.Sdf.Layer.FindOrOpen",
    "pxr.Sdf.Layer.OpenAsAnonymous",
    "ezdxf.readfile", "ezdxf.read", "ezdxf.recover.readfile", "ezdxf.recover.read",
    "ifcopenshell.open", "pypdfium2.PdfDocument",
    "xml.etree.ElementTree.parse", "xml.etree.ElementTree.fromstring",
    "xml.etree.ElementTree.XML", "xml.etree.ElementTree.iterparse",
    "xml.etree.ElementTree.XMLPullParser",
    "numpy.load", "numpy.loadtxt", "numpy.genfromtxt", "pickle.load", "pickle.loads", "torch.load",
    "zipfile.ZipFile", "tarfile.open", "gzip.GzipFile", "gzip.open",
    "imageio.imread", "imageio.v3.imread",
}  # fmt: skip
"""Decoders of the libraries that the package or its dependencies bring."""

HERE = {
    # Files that this program has written itself, or ships.
    "api": {"PIL.Image.open"},
    "library.cloth.stored": {"numpy.load"},
    "faces.commands.agent_tools": {"PIL.Image.open"},
    "workshop.data.drawn.fills": {"cv2.imread"},
    "line.image.exr": {"OpenEXR.File"},
    "line.image.products": {"PIL.Image.open"},
    # Weights that the user names, as tensors only.
    "workshop.evaluation.encoders": {"torch.load"},
    # Pictures that it has just encoded.
    "workshop.data.drawn.paper": {"PIL.Image.open"},
    "workshop.data.drawn.wear": {"cv2.imdecode"},
    "workshop.data.spoilt_layouts": {"cv2.imdecode"},
    "workshop.evaluation.painters": {"cv2.imdecode"},
    # What makes the units of a batch, from the program that began it.
    "faces.batch.ray_engine": {"pickle.loads"},
    # What it writes, or holds in memory.
    "faces.batch.shards": {"tarfile.open"},
    "base.raster.hdri": {"OpenEXR.File"},
    "line.stage.export.web": {"pxr.Usd.Stage.Open"},
    # The arguments of a confined reader, from its caller.
    "base.runtime.confined": {"pickle.load"},
    # Looked at before anything is unpacked, and no more of it than a limit.
    "base.runtime.archives": {"zipfile.ZipFile"},
    "base.runtime.json_lines": {"gzip.GzipFile"},
    # Textures of a stage that was tried, after a look at their heads.
    "line.stage.author.surfaces": {"PIL.Image.open"},
}  # fmt: skip
"""What is decoded in the program's process, module by module."""


def calls_in(tree: ast.Module) -> Iterator[str]:
    """Full names of everything that is called, through whatever a module calls its imports."""
    known = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            known |= {alias.asname or alias.name: alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            known |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute | ast.Name) and isinstance(node.ctx, ast.Load):
            name = ast.unparse(node)
            first, dot, rest = name.partition(".")
            yield f"{known[first]}{dot}{rest}" if first in known else name


def decoders_called() -> dict[str, set[str]]:
    found = {}
    for file in MODULES:
        name = ".".join(file.relative_to(PACKAGE).with_suffix("").parts)
        if called := LIBRARIES.intersection(calls_in(parsed(file))):
            found[name] = called
    return found


def test_every_call_of_a_decoder_is_listed() -> None:
    listed = {module: set(names) for module, names in HERE.items()}
    for row in DECODERS.values():
        for module, names in row.calls.items():
            listed.setdefault(module, set()).update(names.split())
    assert decoders_called() == listed


def test_calls_are_seen_under_any_name() -> None:
    code = "from PIL import Image as P\nimport numpy as np\nf = P.open\nnp.load(x)"
    assert {"PIL.Image.open", "numpy.load"} <= set(calls_in(ast.parse(code)))


def test_readers_run_by_their_row_only() -> None:
    readers: dict[str, set[str]] = {}
    for row in DECODERS.values():
        module, _, function = row.reader.partition(":")
        readers.setdefault(module, set()).add(function)
    for module, functions in readers.items():
        tree = parsed(PACKAGE / f"{module.replace('.', '/')}.py")
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert functions <= defined, module
        assert all(name.startswith("_") for name in functions), "private to its module"
        used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert not functions & used, f"{module} calls {functions & used} in the main process"


def test_nothing_else_is_confined() -> None:
    users = {
        ".".join(file.relative_to(PACKAGE).with_suffix("").parts)
        for file in MODULES
        if "chord_usd.base.runtime.confined.confined" in set(calls_in(parsed(file)))
    }
    assert users == set(), "decoders, in the same module, call it"


def test_no_reader_takes_more_than_a_gibibyte() -> None:
    assert max(row.limits.memory_bytes for row in DECODERS.values()) <= 2**30
