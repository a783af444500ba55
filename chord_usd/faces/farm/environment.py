"""The packages that this program runs with, by their exact versions."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError, distribution

_NAME = re.compile(r"[A-Za-z0-9][\w.-]*")


def pinned(package: str = "chord-usd") -> list[str]:
    """Lines for `pip install -r`: the package and all that it needs, extras left out."""
    versions: dict[str, str] = {}
    due = [package]
    while due:
        name = due.pop()
        key = re.sub(r"[-_.]+", "-", name).lower()
        if key in versions:
            continue
        try:
            installed = distribution(name)
        except PackageNotFoundError:  # of another system
            continue
        versions[key] = f"{key}=={installed.version}"
        due += [
            match[0]
            for line in installed.requires or ()
            if "extra ==" not in line and (match := _NAME.match(line))
        ]
    return sorted(versions.values())
