"""CHOrD: a floor plan picture becomes a furnished, hierarchical OpenUSD house."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chord_usd.api import House as House
    from chord_usd.api import generate as generate
    from chord_usd.api import open as open
    from chord_usd.base.errors import ChordError as ChordError

__version__ = "0.1.0"

_EXPORTED = {"House": "api", "generate": "api", "open": "api", "ChordError": "base.errors"}
"""Names of other modules, by which of them; looked up when they are asked for, so that the command
line does not wait for them."""


def __getattr__(name: str) -> object:
    from importlib import import_module

    if name not in _EXPORTED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_EXPORTED[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_EXPORTED})
