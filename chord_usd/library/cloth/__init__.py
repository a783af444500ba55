"""Cloths: those let fall once in Blender are kept as small meshes beside this file."""
