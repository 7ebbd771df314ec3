"""What the set-up programs in Python share: rotations, YAML sections and command lines."""
