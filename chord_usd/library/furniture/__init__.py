"""Parametric furniture, one module per kind of room or use. catalogue.designs() lists it all."""
