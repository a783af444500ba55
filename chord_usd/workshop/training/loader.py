"""Batches made by worker processes while the network learns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.context import ForkServerContext
from typing import Generic, TypeVar

import torch
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

BatchT = TypeVar("BatchT")

_SEEDS_APART = 1_000_003
"""Between workers: seeds of steps are counted from one, and never reach the next worker's."""


class Seeded(IterableDataset[BatchT], Generic[BatchT]):
    """Endless batches from a seed; each worker has a seed of its own."""

    def __init__(self, batches: Callable[[int], Iterable[BatchT]], seed: int) -> None:
        self.batches, self.seed = batches, seed

    def __iter__(self) -> Iterator[BatchT]:
        worker = get_worker_info()
        return iter(self.batches(self.seed + _SEEDS_APART * (worker.id if worker else 0)))


def batches_ahead(
    source: IterableDataset[BatchT], workers: int, *, ahead: int = 4, pinned: bool = False
) -> DataLoader[BatchT]:
    """The batches of a source; with workers = 0 they are made in this process.

    ahead: batches that each worker makes in advance; pinned: in memory that a GPU copies from.
    """
    return DataLoader(
        source,
        batch_size=None,
        num_workers=workers,
        prefetch_factor=ahead if workers else None,
        worker_init_fn=_single_thread if workers else None,
        multiprocessing_context=_fork_server() if workers else None,
        persistent_workers=bool(workers),
        pin_memory=pinned,
    )


def _fork_server() -> ForkServerContext:
    """Forks workers from a clean process: threads of OpenCV do not survive a fork of this one.

    torch is imported there beforehand; else workers import it one after the other.
    """
    context = get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def _single_thread(_worker: int) -> None:
    # Threads of OpenCV and torch would compete with the training for the same cores.
    import cv2

    cv2.setNumThreads(1)
    torch.set_num_threads(1)
