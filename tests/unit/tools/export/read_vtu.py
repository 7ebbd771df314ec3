"""Reads a .pvd series with meshio, an independent reader of VTK's files, and prints its contents as
JSON.

usage: read_vtu.py SERIES.pvd
"""
import json
import pathlib
import sys
import xml.etree.ElementTree

import meshio


def ends(values):
    return {"shape": list(values.shape), "least": float(values.min()) if values.size else None,
            "greatest": float(values.max()) if values.size else None}


def main():
    series = pathlib.Path(sys.argv[1])
    steps = []
    for entry in xml.etree.ElementTree.parse(series).getroot().iter("DataSet"):
        mesh = meshio.read(series.parent / entry.get("file"))
        fields = {name: ends(values) for name, values in mesh.point_data.items()}
        fields.update({name: ends(values[0]) for name, values in mesh.cell_data.items()})
        steps.append({"time": float(entry.get("timestep")), "points": mesh.points.tolist(),
                      "cells": {block.type: block.data.tolist() for block in mesh.cells}, "fields": fields})
    print(json.dumps(steps))
    return 0


if __name__ == "__main__":
    sys.exit(main())
