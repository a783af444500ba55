"""Trained networks on a CPU, without torch: ONNX Runtime on the graph and weights of a checkpoint.

Importing torch and diffusers takes longer than furnishing a house. A checkpoint folder therefore
holds, beside its weights, how they are computed with: network.onnx, which training writes
(onnx_file.py). On a CUDA device, and for checkpoints without that file, torch is used.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import CheckpointError, Steps
from chord_usd.base.runtime.checksums import check_file, checkpoint_hash
from chord_usd.base.runtime.locations import cache_folder, shipped_checkpoints
from chord_usd.base.runtime.offline import refuse_telemetry

if TYPE_CHECKING:
    import onnxruntime

WEIGHTS_FILE = "weights.safetensors"
GRAPH_FILE = "network.onnx"
THREADS_VARIABLE = "OMP_NUM_THREADS"
"""Environment variable by which numeric libraries, Ray and Slurm say how many threads to start."""
STORED_SUFFIX = ".half"
"""Of the names, in the graph, of tensors that lie in the weights file."""


class Network:
    """A network ready to run. Make one with load_network."""

    def __init__(self, session: onnxruntime.InferenceSession, path: Path) -> None:
        self._session, self._path = session, path

    def shapes(self) -> dict[str, list[int]]:
        """Shapes of the inputs by name, in the order of its file; 0 for an axis of any length."""
        return {
            taken.name: [length if isinstance(length, int) else 0 for length in taken.shape]
            for taken in self._session.get_inputs()
        }

    def run(self, inputs: Mapping[str, npt.NDArray[Any]]) -> list[npt.NDArray[np.float32]]:
        """The network's outputs, in the order of its file.

        Raises MemoryError where there is not enough, CheckpointError where the graph cannot take
        these inputs.
        """
        from onnxruntime.capi.onnxruntime_pybind11_state import Fail, InvalidArgument

        try:
            return list(self._session.run(None, dict(inputs)))
        except InvalidArgument as error:
            raise CheckpointError(
                f"the network does not take these inputs ({_first_line(error)})",
                where=str(self._path),
                try_="copy the checkpoint again",
            ) from error
        except (Fail, RuntimeError) as error:
            if "allocat" in str(error).lower():
                raise MemoryError(_first_line(error)) from error
            raise


def import_onnxruntime() -> ModuleType:
    """ONNX Runtime, which reports nothing. Nothing else may import it first."""
    refuse_telemetry()
    import onnxruntime

    # For builds that do not know the variable, such as those for Windows.
    onnxruntime.disable_telemetry_events()
    return onnxruntime


def has_graph(folder: Path) -> bool:
    """Whether a checkpoint folder can be run without torch."""
    return (folder / GRAPH_FILE).is_file()


def content_hash(folder: Path) -> str:
    """First 16 hex digits of the SHA-256 of a checkpoint folder's weights."""
    return checkpoint_hash(folder / WEIGHTS_FILE)[:16]


def read_weights(path: Path, try_: Steps) -> dict[str, npt.NDArray[Any]]:
    """Tensors by name, those in eight bits unpacked.

    Raises CheckpointError with the remedy try_ where the file is unusable.
    """
    from safetensors import SafetensorError
    from safetensors.numpy import load_file

    check_file(path)
    try:
        return unpacked(load_file(path))
    except (OSError, SafetensorError, TypeError, ValueError, KeyError) as error:
        raise CheckpointError(
            f"the weights are damaged or cannot be read ({_first_line(error)})",
            where=str(path),
            expected="a safetensors file",
            try_=try_,
        ) from error


def load_network(folder: Path, try_: Steps, threads: int = 0) -> Network:
    """The network of a checkpoint folder that has a graph.

    try_: remedy to name in errors; threads: 0 takes every core. Raises CheckpointError.
    """
    path, weights_file = folder / GRAPH_FILE, folder / WEIGHTS_FILE
    check_file(path)
    check_file(weights_file)
    kept = _kept(folder)
    if kept and kept.is_file():
        with suppress(CheckpointError):  # else it is damaged: it is written again
            return load_graph(kept, {}, try_, threads)
    weights = read_weights(weights_file, try_)
    named = {name + STORED_SUFFIX: value for name, value in weights.items()}
    if kept:
        with suppress(OSError, CheckpointError):  # the cache is a convenience
            kept.parent.mkdir(parents=True, exist_ok=True)
            scratch = kept.with_name(f".{os.getpid()}-{kept.name}")
            try:
                load_graph(path, named, try_, threads, optimised=scratch)
                scratch.replace(kept)
            finally:
                scratch.unlink(missing_ok=True)
            return load_graph(kept, {}, try_, threads)
    return load_graph(path, named, try_, threads)


def _kept(folder: Path) -> Path | None:
    """Where the cache has the optimised graph of a shipped checkpoint, with its weights.

    To optimise it takes as long as to load the result. None for checkpoints of users' own.
    """
    if folder.parent != shipped_checkpoints():
        return None
    version = import_onnxruntime().__version__
    content = (checkpoint_hash(folder / name)[:16] for name in (GRAPH_FILE, WEIGHTS_FILE))
    return cache_folder() / "networks" / f"{folder.name}-{version}-{'-'.join(content)}.onnx"


def load_graph(
    path: Path, weights: Mapping[str, npt.NDArray[Any]], try_: Steps, threads: int = 0,
    optimised: Path | None = None,
) -> Network:  # fmt: skip
    """A network of a graph file and the tensors that it leaves out, by their names there.

    optimised: file for the graph after the passes that suit every machine. Other arguments and
    errors as load_network's.
    """
    onnxruntime = import_onnxruntime()
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads or usable_cores()
    options.log_severity_level = 3
    # Threads that spin while they wait take a busy machine's cores from others, and from us.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    if optimised:
        options.optimized_model_filepath = str(optimised)
        level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_EXTENDED
        options.graph_optimization_level = level
    given = [onnxruntime.OrtValue.ortvalue_from_numpy(value) for value in weights.values()]
    try:
        options.add_external_initializers(list(weights), given)
        session = onnxruntime.InferenceSession(str(path), options)
    except Exception as error:  # of a dozen classes, none of them documented
        raise CheckpointError(
            f"the network cannot be built ({_first_line(error)})",
            where=str(path),
            expected="a graph that belongs to its weights",
            try_=try_,
        ) from error
    return Network(session, path)


def usable_cores() -> int:
    """Cores this process may use; the runtime would count all cores of the machine.

    OMP_NUM_THREADS says so where several processes share a machine.
    """
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity else os.cpu_count() or 1
    return min(cores, granted_threads() or cores)


def granted_threads() -> int | None:
    """How many threads OMP_NUM_THREADS grants; None where it says nothing of use."""
    limit = os.environ.get(THREADS_VARIABLE, "")
    return int(limit) or None if limit.isdecimal() else None


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).strip().splitlines()[0][:200]


# Weights in eight bits: whole numbers from -127 to 127, and a scale for each row -----------------

# A row is what makes one output of a layer, or the vector of one word. Networks compute with the
# products, so a checkpoint in eight bits runs as fast as one in sixteen, from half the file.

SCALE_SUFFIX = ".scale"
"""Of the name of the scales of a tensor; their type is that of the tensor before."""

_LEAST_SIZE = 1024
"""Smaller tensors, and tensors of one axis, stay as they are."""

_STEPS = 127

Tensors = Mapping[str, npt.NDArray[Any]]


def packed(weights: Tensors) -> dict[str, npt.NDArray[Any]]:
    """Tensors by name, the large ones in eight bits with their scales beside them."""
    made: dict[str, npt.NDArray[Any]] = {}
    for name, values in weights.items():
        is_float = np.issubdtype(values.dtype, np.floating)
        if not is_float or values.ndim < 2 or values.size < _LEAST_SIZE:
            made[name] = values
            continue
        rows = values.astype(np.float32).reshape(len(values), -1)
        scales = (np.abs(rows).max(axis=1) / _STEPS).astype(values.dtype)
        steps = np.maximum(scales.astype(np.float32), np.finfo(np.float32).tiny)
        whole = np.clip(np.round(rows / steps[:, None]), -_STEPS, _STEPS)
        made[name] = whole.astype(np.int8).reshape(values.shape)
        made[name + SCALE_SUFFIX] = scales
    return made


def unpacked(stored: Tensors) -> dict[str, npt.NDArray[Any]]:
    """Tensors by name as they are computed with; those that never were packed stay the same.

    Raises KeyError, ValueError for scales that belong to no tensor, or to one of another shape.
    """
    made = {name: values for name, values in stored.items() if not name.endswith(SCALE_SUFFIX)}
    for name in stored.keys() - made.keys():
        scales, whole = stored[name], stored[name.removesuffix(SCALE_SUFFIX)]
        rows = scales.astype(np.float32).reshape(-1, *[1] * (whole.ndim - 1))
        product = (whole.astype(np.float32) * rows).astype(scales.dtype)
        made[name.removesuffix(SCALE_SUFFIX)] = product
    return made
