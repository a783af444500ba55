"""Cameras: places and directions in rooms."""
