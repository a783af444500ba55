"""Radiators, switches and sockets."""
