"""What is wrong with what the panel was asked for, in words for people."""


class InputError(Exception):
    """Something is missing or not as it should be; the text says what, and what to do."""
