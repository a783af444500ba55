"""MiniLM as a checkpoint of this program: its weights in eight bits, its graph, its tokenizer.

python -m chord_usd.workshop.training.text_graph MODEL CHECKPOINT

MODEL is a folder that transformers reads: config.json, model.safetensors, tokenizer.json.
"""

from __future__ import annotations

import sys
from pathlib import Path

import torch
from torch import Tensor, nn

from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.networks import WEIGHTS_FILE
from chord_usd.line.planning.encoder import TOKENIZER_FILE
from chord_usd.workshop.training.onnx_file import write_graph
from chord_usd.workshop.training.packed_file import write_eight_bits

TEXTS, TOKENS = "texts", "tokens"
"""Axes of any length."""

_UNUSED = ("pooler.", "embeddings.position_ids", "embeddings.token_type_ids")
"""Weights that the graph does without: for one vector of the whole text, and mere counting."""


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


def write_text_encoder(model_folder: Path, folder: Path) -> None:
    """Write a text model that transformers reads, a BERT, as a checkpoint folder."""
    from safetensors.torch import save
    from transformers import AutoModel

    # The other ways to attend look at the values of the mask, which a graph must not.
    model = AutoModel.from_pretrained(
        model_folder, local_files_only=True, attn_implementation="eager"
    )
    stored = {
        name: tensor.half()
        for name, tensor in model.state_dict().items()
        if not name.startswith(_UNUSED)
    }
    with checkpoint_files(folder):
        write_atomic(folder / WEIGHTS_FILE, save(stored))
        for name in ("config.json", TOKENIZER_FILE):
            write_atomic(folder / name, (model_folder / name).read_bytes())
    write_eight_bits(folder)
    # Two lengths, or the mask would be left out.
    ids = torch.tensor([[101, 2048, 102, 0], [101, 2048, 5010, 102]])
    inputs = {"input_ids": ids, "attention_mask": (ids > 0).long()}
    axes = {name: {0: TEXTS, 1: TOKENS} for name in (*inputs, "hidden")}
    names = {f"model.{name}": name for name in stored}
    write_graph(folder, _Hidden(model), names, inputs, ["hidden"], axes)


if __name__ == "__main__":
    write_text_encoder(Path(sys.argv[1]), Path(sys.argv[2]))
