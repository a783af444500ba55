"""Furniture of other people: read from their libraries, converted to components of this library."""
