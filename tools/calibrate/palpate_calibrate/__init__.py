"""Calibration of the set-up of an arm: see palpate_calibrate.command and tools/calibrate/README.md."""
