"""Which processor Cycles runs on."""

from __future__ import annotations

from typing import Any

import bpy

from chord_usd.base.runtime.networks import granted_threads

GPU_BACKENDS = ("OPTIX", "CUDA", "HIP", "ONEAPI", "METAL")
"""In the order they are tried."""


class DeviceMissingError(Exception):
    """The device the job names is not in this machine."""


def share_processor(scene: Any) -> None:
    """Take no more cores than OMP_NUM_THREADS grants, where several renders share a machine."""
    granted = granted_threads()
    if granted:
        scene.render.threads_mode, scene.render.threads = "FIXED", granted


def choose_device(scene: Any, wanted: str) -> str:
    """Select CPU or GPU; `auto` takes the first GPU there is, else the CPU. Returns what it took.

    Raises DeviceMissingError.
    """
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    if wanted == "cpu":
        return "CPU"
    preferences = bpy.context.preferences.addons["cycles"].preferences
    backends = GPU_BACKENDS if wanted in ("auto", "gpu") else (wanted.upper(),)
    for backend in backends:
        try:
            preferences.compute_device_type = backend
        except TypeError:  # this build of Blender does not know the backend
            continue
        preferences.refresh_devices()
        usable = [device for device in preferences.devices if device.type == backend]
        if usable:
            for device in preferences.devices:
                device.use = device in usable
            scene.cycles.device = "GPU"
            return f"{backend} {usable[0].name}"
    if wanted != "auto":
        raise DeviceMissingError(f"this machine has no {wanted} device that Blender can use")
    return "CPU"
