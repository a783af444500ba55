"""On PYTHONPATH, this has an interpreter, and those that it starts, miss the packages of extras."""

import importlib.util
import os
import sys

REFUSED = frozenset(os.environ.get("CHORD_USD_TEST_REFUSED", "").split())


class _Refuse:
    """Has packages of extras missing."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> None:
        """As importlib asks."""
        if name.partition(".")[0] in REFUSED:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


_find_spec = importlib.util.find_spec


def _found(name: str, package: str | None = None) -> object:
    """As a library asks whether another is there, without importing it."""
    return None if name.partition(".")[0] in REFUSED else _find_spec(name, package)


importlib.util.find_spec = _found  # type: ignore[assignment]
sys.meta_path.insert(0, _Refuse)  # type: ignore[arg-type]
