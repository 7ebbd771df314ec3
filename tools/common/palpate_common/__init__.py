"""What the set-up programs in Python share: poses, surfaces, files and command lines."""
