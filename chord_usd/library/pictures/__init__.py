"""Pictures, panels, mirrors and clocks."""
