"""Faults of a written stage: the certificate and numbered rules."""
