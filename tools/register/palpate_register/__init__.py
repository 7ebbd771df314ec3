"""Pose of an object's mesh in the robot's base from touched points, from a cloud, or both."""
