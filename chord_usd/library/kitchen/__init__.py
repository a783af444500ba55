"""Kitchen units, appliances and what stands on worktops."""
