"""Runs inside Blender, in a process of its own: imports bpy, never pxr."""
