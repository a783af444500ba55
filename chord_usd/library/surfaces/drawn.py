"""Finishes whose picture is drawn only when somebody looks them up."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from chord_usd.library.surfaces.finishes import Finish


@dataclass(frozen=True, eq=False)
class DrawnFinishes(Mapping[str, Finish]):
    """A table of finishes and, beside it, some that cost time to draw."""

    base: Mapping[str, Finish]
    drawn: Mapping[str, Callable[[], Finish]]
    """Must return the same finish each time: cache them."""

    def __getitem__(self, key: str) -> Finish:
        return self.drawn[key]() if key in self.drawn else self.base[key]

    def __iter__(self) -> Iterator[str]:
        yield from self.base
        yield from (key for key in self.drawn if key not in self.base)

    def __len__(self) -> int:
        return len(set(self.base) | set(self.drawn))
