"""On PYTHONPATH, this has an interpreter, and those that it starts, miss the packages of extras."""

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


sys.meta_path.insert(0, _Refuse)  # type: ignore[arg-type]
