#!/usr/bin/python3
"""Plots of curves as PNG or SVG, from a JSON file that names the picture and holds its panels.

  tools/common/plots.py plot.json     # {"file": "error.png", "panels": [...]}

palpate's programs start it. A panel has title, x and y (labels with units), curves (name, x, y, dashed) and optionally
logarithmic (of the y axis), logarithmic_x, limits (of the y axis) and equal (units of both axes of equal length). A
curve is interrupted where its y is null; with `points` it is drawn as separate points.
"""
import argparse
import importlib.util
import io
import json
import logging
import pathlib
import sys

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999"]
DASHES = ["-", "--", ":"]
FEW_POINTS = 12  # are marked individually
WIDTH, HEIGHT = 11, 4.2  # inches, of a panel
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "palpate", "font.size": 9, "text.parse_math": False,
         "axes.formatter.limits": (-3, 4)}  # tick labels that leave room for the axis' label

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # nothing about its caches


def missing(*modules):
    """What to install before these modules can be imported; empty if nothing."""
    packages = [f"python3-{module}" for module in modules if importlib.util.find_spec(module) is None]
    return f"missing Python package: {', '.join(packages)} (apt-get install {' '.join(packages)})" if packages else ""


def curve(name, x, y, colour=None, dashed=False, points=False):
    """A curve without a number of its colour has one after the other."""
    return {"name": name, "x": x, "y": y, "colour": colour, "dashed": dashed, "points": points}


def draw_panel(axes, panel, ticker):
    axes.set(title=panel["title"], xlabel=panel["x"], ylabel=panel["y"])
    axes.grid(True, color="#ddd")
    for i, line in enumerate(panel["curves"]):
        at = i if line.get("colour") is None else line["colour"]
        style = "--" if line["dashed"] else DASHES[at // len(COLOURS) % len(DASHES)]
        axes.plot(line["x"], line["y"], label=line["name"].lstrip("_"),
                  color=COLOURS[at % len(COLOURS)],
                  linestyle="none" if line.get("points") else style,
                  marker="x" if line.get("points") else "." if len(line["x"]) <= FEW_POINTS else None)
    for axis, scale, is_logarithmic in ((axes.xaxis, axes.set_xscale, panel.get("logarithmic_x")),
                                        (axes.yaxis, axes.set_yscale, panel.get("logarithmic"))):
        if is_logarithmic:
            scale("log")
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(ticker.LogFormatter())
    if panel.get("limits"):
        axes.set_ylim(*panel["limits"])
    if panel.get("equal"):
        axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=8, frameon=False)


def draw(panels, kind="svg"):
    """The bytes of a picture, "svg" or "png", with panels one below the other; 1100 x 420 pixels each."""
    import matplotlib
    from matplotlib import figure, ticker
    with matplotlib.rc_context(STYLE):
        height = HEIGHT * len(panels)
        drawing = figure.Figure(figsize=(WIDTH, height), dpi=100)
        for axes, panel in zip(drawing.subplots(len(panels), squeeze=False)[:, 0], panels):
            draw_panel(axes, panel, ticker)
        # Equal widths regardless of legends, so that the time axes are aligned.
        drawing.subplots_adjust(left=0.09, right=0.66, top=1 - 0.4 / height, bottom=0.5 / height, hspace=0.35)
        out = io.BytesIO()
        drawing.savefig(out, format=kind, metadata={"Date": None} if kind == "svg" else {})
        return out.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plot", type=pathlib.Path, help="the JSON file")
    plot = json.loads(parser.parse_args().plot.read_text(encoding="utf-8"))
    if lacking := missing("matplotlib"):
        return lacking
    file = pathlib.Path(plot["file"])
    file.write_bytes(draw(plot["panels"], file.suffix[1:]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
