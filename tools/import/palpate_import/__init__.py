"""Recordings of CSV files, MCAP files and ROS 2 bags to one LCM log: palpate-import."""
