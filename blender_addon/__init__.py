"""CHOrD in Blender's sidebar: furnish a floor plan, change the house, render it.

All work is done by the chord-usd program in a process of its own; see core/ for what is decided and
the other modules for how Blender shows it.
"""

from importlib import import_module

_PARTS = (
    "preferences",
    "properties",
    "previews",
    "operators",
    "pieces",
    "library",
    "panel",
    "files",
)
"""In the order in which they need each other. Imported late, so that core/ is without Blender."""


def register() -> None:
    """Called by Blender when the extension is enabled."""
    for part in _PARTS:
        import_module(f".{part}", __package__).register()


def unregister() -> None:
    """Called by Blender when the extension is disabled: nothing is left behind."""
    for part in reversed(_PARTS):
        import_module(f".{part}", __package__).unregister()
