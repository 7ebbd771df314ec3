"""Corners of an ArUco marker in images, by OpenCV (python3-opencv), which nothing else needs."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.square_edges import square_corners
from palpate_common.input_error import InputError

Floats = NDArray[np.float64]
DICTIONARIES = ("4x4_50", "4x4_100", "4x4_250", "5x5_50", "5x5_100", "5x5_250",
                "6x6_50", "6x6_100", "6x6_250", "aruco_original")


def opencv() -> ModuleType:
    """The module. Raises InputError with the remedy where it is missing."""
    try:
        import cv2
    except ImportError as error:
        raise InputError("--marker: missing Python package cv2; remedy: apt-get install python3-opencv") from error
    if not hasattr(cv2, "aruco"):
        raise InputError("--marker: the Python package cv2 lacks its module aruco; remedy: apt-get install python3-opencv")
    return cv2


def read_image(path: Path) -> NDArray[np.uint8]:
    """(rows, columns), grey. Raises InputError."""
    if not path.is_file():
        raise InputError(f"{path}: No such file")
    image = opencv().imread(str(path), 0)
    if image is None:
        raise InputError(f"{path}: is no image that OpenCV reads, such as PNG")
    return np.asarray(image, np.uint8)


class MarkerDetector:
    """Finds one marker. dictionary: one of DICTIONARIES. number: of the marker in it. Raises InputError."""

    def __init__(self, dictionary: str, number: int) -> None:
        self._cv = opencv()
        aruco = self._cv.aruco
        self._dictionary = aruco.getPredefinedDictionary(getattr(aruco, f"DICT_{dictionary.upper()}"))
        size = len(self._dictionary.bytesList)
        if not 0 <= number < size:
            raise InputError(f"--marker: {number}; allowed: 0 to {size - 1} of {dictionary}")
        self._number = number
        self._detect = self._detector(aruco)

    def _detector(self, aruco: Any) -> Any:
        """OpenCV's interface changed in 4.7."""
        if hasattr(aruco, "ArucoDetector"):
            return aruco.ArucoDetector(self._dictionary, aruco.DetectorParameters()).detectMarkers
        parameters = aruco.DetectorParameters_create()
        return lambda image: aruco.detectMarkers(image, self._dictionary, parameters=parameters)

    def corners(self, image: NDArray[np.uint8]) -> Optional[Floats]:
        """(4, 2), px, in the order of palpate_calibrate.camera.marker.CORNERS; None where it is not found."""
        found, numbers, _ = self._detect(image)
        if numbers is None:
            return None
        for corners, number in zip(found, np.ravel(numbers)):
            if number == self._number:
                return square_corners(image, np.asarray(corners, float).reshape(4, 2))
        return None
