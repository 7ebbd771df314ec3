"""Friction of an arm's joints, as its joint torques contain it: `palpate-calibrate friction`."""
