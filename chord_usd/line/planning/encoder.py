"""Texts -> embeddings of their words, by a language model that never learns anything here."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.checksums import check_file
from chord_usd.base.runtime.extras import REINSTALL, needed_for
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import load_network
from chord_usd.line.planning.words import TEXT_CHANNELS

MOST_WORDS = 64
"""Words, and parts of words, of a text that are looked at."""


ENCODER_FOLDER = "text_encoder"
"""In a checkpoint: the text model that its network was trained with, where that is not ours."""

MINILM_CHECKPOINT = "text_encoder"
"""all-MiniLM-L6-v2 (Apache-2.0) in eight bits."""

TOKENIZER_FILE = "tokenizer.json"


class TextEncoder(Protocol):
    """Texts to one vector per word."""

    channels: int

    def encode(self, texts: Sequence[str]) -> list[npt.NDArray[np.float32]]:
        """For each text (N, channels), N its words and parts of words, MOST_WORDS at most."""


class TransformersEncoder:
    """Any text model that transformers reads from a folder: BERT's kind, or CLIP's text half."""

    def __init__(self, folder: Path) -> None:
        """Loads tokenizer and weights.

        Raises ChordError where they are not there, MissingExtraError without transformers.
        """
        with needed_for("a text model of one's own"):
            import torch
            from transformers import AutoConfig, AutoModel, AutoTokenizer, CLIPTextModel

        self._torch = torch
        try:
            kind = AutoConfig.from_pretrained(folder, local_files_only=True).model_type
            family = CLIPTextModel if kind.startswith("clip") else AutoModel
            self._tokenizer = AutoTokenizer.from_pretrained(folder, local_files_only=True)
            self._model = family.from_pretrained(folder, local_files_only=True).eval()
        except (OSError, ValueError, KeyError) as error:
            raise ChordError(
                "no text model that can be read",
                where=str(folder),
                expected="config.json, tokenizer and weights as transformers saves them",
                try_="<reinstall>, if it is the text model that comes with it",
            ) from error
        self._model.requires_grad_(False)
        self.channels = int(self._model.config.hidden_size)

    def save(self, folder: Path) -> None:
        """Tokenizer and weights, as the constructor reads them."""
        self._tokenizer.save_pretrained(folder)
        self._model.save_pretrained(folder)

    def encode(self, texts: Sequence[str]) -> list[npt.NDArray[np.float32]]:
        """As TextEncoder."""
        tokens = self._tokenizer(
            list(texts), padding=True, truncation=True, max_length=MOST_WORDS, return_tensors="pt"
        )
        with self._torch.inference_mode():
            hidden = self._model(**tokens).last_hidden_state.numpy()
        masks = tokens["attention_mask"].numpy().astype(bool)
        return [rows[mask] for rows, mask in zip(hidden, masks, strict=True)]


class MiniLM:
    """all-MiniLM-L6-v2 (Apache-2.0), on ONNX Runtime: torch takes longer to import than it runs."""

    def __init__(self, threads: int = 0) -> None:
        """threads: 0 takes every core. Raises CheckpointError."""
        from tokenizers import Tokenizer

        folder = checkpoint_folder(MINILM_CHECKPOINT)
        check_file(folder / TOKENIZER_FILE)
        self._network = load_network(folder, REINSTALL, threads)
        self._tokenizer = Tokenizer.from_file(str(folder / TOKENIZER_FILE))
        self._tokenizer.enable_truncation(MOST_WORDS)
        self._tokenizer.enable_padding()
        self.channels = TEXT_CHANNELS

    def encode(self, texts: Sequence[str]) -> list[npt.NDArray[np.float32]]:
        """As TextEncoder."""
        encodings = self._tokenizer.encode_batch(list(texts))
        ids, masks = (
            np.array([getattr(text, part) for text in encodings], np.int64)
            for part in ("ids", "attention_mask")
        )
        (hidden,) = self._network.run({"input_ids": ids, "attention_mask": masks})
        return [rows[mask] for rows, mask in zip(hidden, masks.astype(bool), strict=True)]


def encoder_of(checkpoint: Path) -> TextEncoder:
    """The text model that the network of a checkpoint folder has learned to read.

    Raises ChordError for one that cannot be read.
    """
    folder = checkpoint / ENCODER_FOLDER
    return TransformersEncoder(folder) if folder.is_dir() else MiniLM()
