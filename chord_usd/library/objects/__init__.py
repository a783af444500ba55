"""Small objects on desks and shelves."""
