"""What the panel decides, without Blender: testable on its own, imports no bpy."""
