"""How MiniLM computes, as an ONNX file without its weights: planning/minilm.onnx.

The file is part of the program. `python -m chord_usd.training.text_graph` writes it again, should a
version of ONNX Runtime not read it any more.
"""

from __future__ import annotations

from pathlib import Path

import torch
from torch import Tensor, nn

from chord_usd.planning.encoder import GRAPH_PATH, minilm_folder
from chord_usd.runtime.files import deliver
from chord_usd.training.onnx_file import leave_out, traced

TEXTS, TOKENS = "texts", "tokens"
"""Axes of any length."""


class _Hidden(nn.Module):
    """A text model of transformers, of which the last hidden state is looked at."""

    def __init__(self, model: nn.Module) -> None:
        super().__init__()
        self.model = model

    def forward(self, input_ids: Tensor, attention_mask: Tensor) -> Tensor:
        hidden: Tensor = self.model(
            input_ids=input_ids, attention_mask=attention_mask
        ).last_hidden_state
        return hidden


def write_text_graph(path: Path, folder: Path) -> None:
    """Write the graph of the text model in folder, as transformers reads it."""
    from transformers import AutoModel

    # The other ways to attend look at the values of the mask, which a graph must not.
    model = AutoModel.from_pretrained(folder, local_files_only=True, attn_implementation="eager")
    # Two lengths, or the mask would be left out.
    ids = torch.tensor([[101, 2048, 102, 0], [101, 2048, 5010, 102]])
    inputs = {"input_ids": ids, "attention_mask": (ids > 0).long()}
    axes = {name: {0: TEXTS, 1: TOKENS} for name in (*inputs, "hidden")}
    graph = traced(_Hidden(model), inputs, ["hidden"], axes)
    leave_out(graph.graph, {f"model.{name}": name for name in model.state_dict()}, half=False)
    with deliver() as delivery:
        delivery.place(path).write_bytes(graph.SerializeToString())


if __name__ == "__main__":
    write_text_graph(GRAPH_PATH, minilm_folder())
