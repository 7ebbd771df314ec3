"""A depth camera's clouds as observed points of the object on SHAPE_OBSERVATION."""
