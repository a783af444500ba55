"""SceneGraph -> SceneGraph: what rooms are dressed with, chosen by kind, area, style and seed."""
