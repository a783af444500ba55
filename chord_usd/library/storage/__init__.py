"""Cabinets, shelves, boxes and baskets."""
