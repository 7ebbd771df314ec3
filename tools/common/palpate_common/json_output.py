"""Results as JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def write_json(values: Any, file: str) -> None:
    """Into a file; - for the standard output."""
    text = json.dumps(values, indent=1) + "\n"
    if file == "-":
        sys.stdout.write(text)
    else:
        Path(file).write_text(text)
