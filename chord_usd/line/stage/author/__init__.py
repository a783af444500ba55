"""Writes a stage: rooms, furniture, lights, looks, physics."""
