"""StageFile -> pictures, in Blender's own process."""
