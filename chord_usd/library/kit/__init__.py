"""Solids, joints and designs that furniture is modelled from."""
