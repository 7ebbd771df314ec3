"""Input that the user can correct."""

FAILED, WRONG_CONFIGURATION = 1, 78  # exit codes; the second one is EX_CONFIG of sysexits.h


class InputError(Exception):
    """The message names file, line, key or column, value and what is allowed.

    exit_code: that the program ends with: WRONG_CONFIGURATION for a configuration, description or scene, else FAILED.
    """

    def __init__(self, message: str, exit_code: int = FAILED) -> None:
        super().__init__(message)
        self.exit_code = exit_code
