"""Guided set-up of a robot and an object: palpate-setup."""
