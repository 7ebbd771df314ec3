"""The page of palpate-evaluate shapes: measured and predicted outlines, and the scores of each prediction."""
from page import Markup, curve, document, draw, element, figure, table

ABOUT = """Real objects, clamped and at rest under their weight or pushed on a table, compared with the shape that
the model predicts. A beam's Young's modulus is fitted to the drop of its end block alone, or on another beam;
nothing is fitted to the cylinder; a sponge is fitted to 20 % depth and scored to 40 %. Errors are predicted minus measured, or distances; sd is the standard deviation
that the recording states."""
HEADER = ["quantity", "unit", "error", "recording's sd", "goal", ""]
MEASURED = 6  # number of the colour


def verdict(score):
    if score["fitted"]:
        return "fitted"
    return "" if score["met"] is None else "met" if score["met"] else "MISSED"


def number(value, decimals):
    return "" if value is None else f"{value:.{decimals}f}"


def rows_of(shape):
    return [[score["quantity"], score["unit"], number(score["error"], 2),
             number(score["deviation_of_recording"], 1), number(score["goal"], 0), verdict(score)]
            for score in shape["scores"]]


def by_recording(shapes):
    """(recording, its predictions) in the order of their first occurrence."""
    names = dict.fromkeys(shape["recording"] for shape in shapes)
    return [(name, [shape for shape in shapes if shape["recording"] == name]) for name in names]


def panel_of(recording, shapes):
    """Measured outlines once, the predicted ones of every model; None if there is none."""
    curves, drawn = [], set()
    for colour, shape in enumerate(shapes):
        for line in shape["outlines"]:
            if line["measured"] and line["name"] in drawn:
                continue
            drawn.add(line["name"])
            name = line["name"] if line["measured"] else f"{line['name']}: {shape['model']}"
            curves.append(curve(name, line["x_mm"], line["y_mm"], MEASURED if line["measured"] else colour,
                                points=not line["line"]))
    curves.sort(key=lambda line: line["colour"] == MEASURED)  # on top
    return {"title": recording, "x": "mm", "y": "mm", "equal": True, "curves": curves} if curves else None


def section_of(recording, shapes):
    out = [element("h2", recording)]
    if panel := panel_of(recording, shapes):
        out.append(figure(draw([panel]), "svg+xml", "Measured and predicted shape, in the plane of sag"))
    for shape in shapes:
        nodes = f", {shape['nodes']} nodes" if shape["nodes"] else ""
        out.append(element("h3", f"{shape['model']}{nodes}; {shape['material']}".rstrip("; ")))
        if shape["scores"]:
            out.append(table(HEADER, rows_of(shape), figures=True))
        if (deviation := shape["incremental_deviation_m"]) is not None:
            out.append(element("p", "Largest distance of a node of the incremental model, which palpated "
                                    f"runs, from this equilibrium: {1e6 * deviation:.2g} micrometres."))
        out += [element("p", note) for note in shape["notes"]]
    return Markup("").join(out)


def page_of(result):
    """HTML text of the JSON that palpate-evaluate shapes writes."""
    out = [element("p", " ".join(ABOUT.split()))]
    out += [section_of(*group) for group in by_recording(result["shapes"])]
    return document("palpate: real shapes", Markup("").join(out))
