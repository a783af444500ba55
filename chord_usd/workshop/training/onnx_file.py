"""Networks as ONNX files that hold no weights: they stay in the checkpoint's safetensors.

The file says how a network computes; networks.py runs it on a CPU without torch.
It changes with the architecture only, so training needs to write it once.
"""

from __future__ import annotations

import copy
import io
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.networks import GRAPH_FILE, STORED_SUFFIX, WEIGHTS_FILE

OPSET = 18


def write_graph(
    folder: Path,
    network: nn.Module,
    stored: Mapping[str, str],
    inputs: Mapping[str, Tensor],
    outputs: Sequence[str],
    free_axes: Mapping[str, Mapping[int, str]] | None = None,
) -> None:
    """Write folder's network.onnx, and the hashes of its files.

    stored: by the name of one of network's tensors, its name in the weights file; inputs: an
    example, in the order of network's arguments; free_axes: by input or output, which of its axes
    may have any length, and that length's name.
    """
    with checkpoint_files(folder), deliver() as delivery:
        model = traced(network, inputs, outputs, free_axes)
        outside = {name: there + STORED_SUFFIX for name, there in stored.items()}
        leave_out(model.graph, outside)
        delivery.place(folder / GRAPH_FILE).write_bytes(model.SerializeToString())


def traced(
    network: nn.Module,
    inputs: Mapping[str, Tensor],
    outputs: Sequence[str],
    free_axes: Mapping[str, Mapping[int, str]] | None = None,
) -> Any:
    """The onnx.ModelProto of a network, arguments as write_graph's; its weights are random."""
    import onnx

    file: Any = io.BytesIO()  # the exporter that traces takes one
    with warnings.catch_warnings(), torch.inference_mode():
        # The exporter that follows tensors through plain Python warns at length.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            _with_unlike_weights(network.eval()),
            tuple(inputs.values()),
            file,
            dynamo=False,
            opset_version=OPSET,
            # Folded weights differ from the file's weights; the runtime folds them anyway.
            do_constant_folding=False,
            input_names=list(inputs),
            output_names=list(outputs),
            dynamic_axes={name: dict(axes) for name, axes in (free_axes or {}).items()},
        )
    return onnx.load_from_string(file.getvalue())


def _with_unlike_weights(network: nn.Module) -> nn.Module:
    """A copy whose tensors all differ: the exporter makes one of those that are equal."""
    copied = copy.deepcopy(network)
    generator = torch.Generator().manual_seed(0)
    for tensor in copied.state_dict().values():
        if tensor.is_floating_point():
            tensor.copy_(torch.rand(tensor.shape, generator=generator))
    return copied


def leave_out(graph: Any, outside: Mapping[str, str]) -> None:
    """Turn tensors of a graph into ones that are given at loading, in half precision.

    outside: by the name of a tensor, the name that it is given under.
    """
    from onnx import TensorProto, helper

    given = []
    for tensor in graph.initializer:
        if tensor.name not in outside:
            continue
        name = outside[tensor.name]
        node = helper.make_node("Cast", [name], [tensor.name], to=TensorProto.FLOAT)
        tensor.data_type = TensorProto.FLOAT16
        given.append(node)
        tensor.name = name
        tensor.ClearField("raw_data")
        tensor.ClearField("float_data")
        tensor.data_location = TensorProto.EXTERNAL
        entry = tensor.external_data.add()
        entry.key, entry.value = "location", WEIGHTS_FILE
    nodes = [*given, *graph.node]
    for node in nodes:
        node.ClearField("doc_string")  # paths of source files
    del graph.node[:]
    graph.node.extend(nodes)
