"""SceneGraph -> StageFile: shell, items, lights, looks, check."""
