"""What a user can correct in the input."""


class InputError(Exception):
    """Wrong content of a file; the message names file, line, key or column, value and what is allowed."""
