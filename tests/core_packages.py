"""The environment of `pip install chord-usd`, without extras, inside that of the tests."""

from __future__ import annotations

import os
import tomllib
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]

INSTALLERS = frozenset({"chord-usd", "pip", "setuptools"})
"""There in any environment."""


@cache
def core_environment() -> dict[str, str]:
    """Variables with which an interpreter finds nothing that the core does not ask for."""
    core = INSTALLERS | closure(PROJECT["dependencies"])
    refused = [
        module
        for module, distributions in packages_distributions().items()
        if not core & {canonicalize_name(name) for name in distributions}
    ]
    path = (str(ROOT / "tests" / "core_only"), str(ROOT), os.environ.get("PYTHONPATH", ""))
    return {
        "CHORD_USD_TEST_REFUSED": " ".join(refused),
        "PYTHONPATH": os.pathsep.join(filter(None, path)),
    }


def closure(wanted: list[str]) -> set[str]:
    """Canonical names of the installed packages that requirements bring, and theirs."""
    found: set[str] = set()
    waiting = [Requirement(line) for line in wanted]
    while waiting:
        one = waiting.pop()
        name = canonicalize_name(one.name)
        if name in found or not (one.marker is None or one.marker.evaluate({"extra": ""})):
            continue
        found.add(name)
        try:
            waiting += map(Requirement, requires(name) or ())
        except PackageNotFoundError:
            continue
    return found
