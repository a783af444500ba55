"""Parametric furniture and the mesh database."""
