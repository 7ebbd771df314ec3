"""Pose of a depth camera in the robot's base: `palpate-calibrate camera`."""
