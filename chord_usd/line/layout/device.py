"""Where a network runs and how: device, precision, memory."""

from __future__ import annotations

import ctypes
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TypeVar

from chord_usd.base.errors import ChordError, MissingExtraError
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.machine import is_out_of_memory

Job = TypeVar("Job")
Result = TypeVar("Result")


def choose_device(name: str) -> str:
    """auto, cpu, cuda or cuda:1 to what torch takes; auto is cpu where torch is not installed.

    Raises ChordError where there is no such device, MissingExtraError where only torch is missing.
    """
    if not re.fullmatch(r"auto|cpu|cuda(:\d{1,3})?", name):
        raise ChordError(
            "unknown device", where=f"<device={name:.40}>", value=name, expected="cpu or cuda"
        )
    if name == "cpu":
        return name
    try:
        has_cuda = _has_cuda()
    except MissingExtraError:
        if name != "auto":
            raise
        has_cuda = False
    if name == "auto":
        return "cuda" if has_cuda else "cpu"
    if not has_cuda:
        raise ChordError(
            "no CUDA device here",
            where=f"<device={name}>",
            value=name,
            try_=("<device=cpu>", "<device=auto>"),
        )
    return name


def half_precision(device: str) -> AbstractContextManager[Any]:
    """A context in which convolutions run in bfloat16 where that is faster, else one that does
    nothing.

    Processors without bfloat16 instructions would emulate them, at several times the cost.
    """
    import torch

    kind = torch.device(device).type
    if kind == "cuda":
        fast = torch.cuda.is_bf16_supported()
    else:
        fast = bool(torch.ops.mkldnn._is_mkldnn_bf16_supported())
    return torch.autocast(kind, torch.bfloat16) if fast else nullcontext()


def _has_cuda() -> bool:
    """Asks torch only where there is a driver: importing it costs more than a layout."""
    try:
        ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
    except OSError:
        return False
    with needed_for("a CUDA device", "<device=cpu>"):
        import torch
    return torch.cuda.is_available()


def in_batches(
    work: Callable[[Sequence[Job]], Sequence[Result]],
    jobs: Sequence[Job],
    batch: int,
    warn: Callable[[str], None] | None = None,
) -> Iterator[Result]:
    """Results of all jobs in order, worked on in batches that are halved where memory ends.

    warn is called at each halving. Raises ChordError where one job alone is too much.
    """
    start = 0
    while start < len(jobs):
        try:
            results = work(jobs[start : start + batch])
        except (MemoryError, RuntimeError) as error:
            if not is_out_of_memory(error):
                raise
            if batch == 1:
                raise ChordError(
                    "out of memory with a batch of one",
                    expected="a few hundred MiB free",
                    try_=("<device=cpu>", "a machine with more memory"),
                ) from error
            batch = max(batch // 2, 1)
            if warn:
                warn(f"out of memory: went on with a batch of {batch}")
            _give_memory_back()
            continue
        yield from results
        start += batch


def _give_memory_back() -> None:
    torch = sys.modules.get("torch")
    if torch and torch.cuda.is_available():
        torch.cuda.empty_cache()
