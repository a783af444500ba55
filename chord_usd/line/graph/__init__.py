"""LayoutImage -> SceneGraph: detection, rooms, matching."""
