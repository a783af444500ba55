"""Checkpoints in eight bits.

python -m chord_usd.workshop.training.packed_file FOLDER

The weights in FOLDER are replaced by the same in eight bits, with new hashes. Evaluate before and
after: the scores are to stay within their noise.
"""

from __future__ import annotations

import sys
from pathlib import Path

from safetensors.numpy import save

from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.networks import WEIGHTS_FILE, packed, read_weights


def write_eight_bits(folder: Path) -> None:
    """Pack the weights of a checkpoint folder. Raises CheckpointError where it has none."""
    weights = packed(read_weights(folder / WEIGHTS_FILE, "chord-usd train"))
    with checkpoint_files(folder):
        write_atomic(folder / WEIGHTS_FILE, save(weights))


if __name__ == "__main__":
    write_eight_bits(Path(sys.argv[1]))
