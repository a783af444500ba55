"""Cloths that were let fall once in Blender and are kept as small meshes beside this file."""
