"""Nothing leaves the machine: settings of libraries, made before they are imported.

ONNX Runtime 1.31 opens a store of usage events in the home folder when it is imported, and looks
up the host that it sends them to once a session is made; disable_telemetry_events() comes too late
for both. The others look for newer versions, models or fonts, or count their users.
"""

from __future__ import annotations

import os

_TELEMETRY = {
    "ORT_DISABLE_TELEMETRY": "1",
    "RAY_USAGE_STATS_ENABLED": "0",
    "HF_HUB_DISABLE_TELEMETRY": "1",
    "DO_NOT_TRACK": "1",
}
_DOWNLOADS = {
    "HF_HUB_OFFLINE": "1",
    "TRANSFORMERS_OFFLINE": "1",
    "YOLO_OFFLINE": "true",
}


def refuse_telemetry() -> None:
    """Have no library of this process, or of those it starts, report what it is used for."""
    os.environ.update(_TELEMETRY)


def stay_offline() -> None:
    """Also have them fetch nothing. For processes that are ours alone, first thing of all.

    A program that imports chord_usd may have downloads of its own to make.
    """
    refuse_telemetry()
    os.environ.update(_DOWNLOADS)
