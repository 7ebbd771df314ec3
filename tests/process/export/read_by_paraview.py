"""Run by pvpython: prints the contents of a series of shapes as read by ParaView, as JSON.

usage: read_by_paraview.py SERIES.pvd ...
"""
import json
import sys

from paraview import servermanager, simple


def arrays(data):
    found = {}
    for index in range(data.GetNumberOfArrays()):
        array = data.GetArray(index)
        found[array.GetName()] = {"components": array.GetNumberOfComponents(), "values": array.GetNumberOfTuples(),
                                  "range": array.GetRange(-1 if array.GetNumberOfComponents() > 1 else 0)}
    return found


def series(path):
    reader = simple.PVDReader(FileName=path)
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues)
    reader.UpdatePipeline(times[-1])
    block = servermanager.Fetch(reader)
    while block.IsA("vtkMultiBlockDataSet"):
        block = block.GetBlock(0)
    # A filter of ParaView's own must take it too.
    surface = simple.ExtractSurface(Input=reader)
    surface.UpdatePipeline(times[-1])
    return {"times": times, "cells": block.GetNumberOfCells(),
            "points": [block.GetPoint(i) for i in range(block.GetNumberOfPoints())],
            "fields": {**arrays(block.GetPointData()), **arrays(block.GetCellData())},
            "surface": surface.GetDataInformation().GetNumberOfCells()}


print("\n" + json.dumps({path: series(path) for path in sys.argv[1:]}))
