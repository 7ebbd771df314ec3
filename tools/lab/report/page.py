"""Parts of a page: tables, plots, pictures, as self-contained printable HTML. All text is escaped."""
import base64
import importlib.util
import io

PACKAGES = {"jinja2": "python3-jinja2", "matplotlib": "python3-matplotlib"}
MISSING = [package for module, package in PACKAGES.items() if importlib.util.find_spec(module) is None]
if MISSING:
    raise SystemExit(f"missing Python package: {', '.join(MISSING)} (apt-get install {' '.join(MISSING)})")

import jinja2  # noqa: E402
import matplotlib  # noqa: E402
from markupsafe import Markup  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "palpate", "font.size": 9})

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999"]
DASHES = ["-", "--", ":"]
FEW_POINTS = 12  # are marked individually

TEMPLATES = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined,
                               loader=jinja2.DictLoader({
    "page": """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{{ title }}</title><style>
body{font:14px/1.4 sans-serif;max-width:1280px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0;font-size:13px;display:block;overflow-x:auto}
td,th{border:1px solid #ccc;padding:3px 7px;text-align:left;vertical-align:top}
th{background:#eef1f5}
table.figures td,table.figures th{text-align:right}
table.figures td:first-child,table.figures th:first-child{text-align:left}
table.figures td.title{background:#f7f7f2;font-weight:bold}
figure{display:inline-block;margin:6px}img{max-width:100%}
figcaption{color:#555}pre{background:#f5f5f5;padding:.6em;overflow-x:auto}
@media print{.page{break-before:page}}
</style></head>
<body><h1>{{ title }}</h1>
{{ body }}
</body></html>
""",
    "table": """<table{% if figures %} class="figures"{% endif %}>
{%- if header|select|list %}<tr>{% for cell in header %}<th>{{ cell }}</th>{% endfor %}</tr>{% endif %}
{% for row in rows %}<tr>{% if row|length == 1 and header|length > 1 -%}
<td class="title" colspan="{{ header|length }}">{{ row[0] }}</td>{% else -%}
{% for cell in row %}<td>{{ cell }}</td>{% endfor -%}
{% endif %}</tr>
{% endfor %}</table>
""",
    "figure": """<figure><img alt="{{ caption }}" src="data:image/{{ kind }};base64,{{ data }}"
{%- if width %} width="{{ width }}"{% endif %}/><figcaption>{{ caption }}</figcaption></figure>
""",
}))

def document(title, body):
    return TEMPLATES.get_template("page").render(title=title, body=body)


def element(name, text):
    return Markup(f"<{name}>{{}}</{name}>\n").format(text)


def table(header, rows, figures=False):
    """Rows of cells; a row of one cell spans the table as a title. figures: aligned as numbers."""
    return Markup(TEMPLATES.get_template("table").render(
        header=list(header), rows=[list(row) for row in rows], figures=figures))


def section(*parts):
    """Parts that begin on a sheet of their own when printed."""
    return Markup('<section class="page">{}</section>\n').format(Markup("").join(parts))


def figure(data, kind, caption, width=None):
    return Markup(TEMPLATES.get_template("figure").render(
        data=base64.b64encode(data).decode(), kind=kind, caption=caption, width=width))


def picture(file, caption, width=None):
    """A PNG file embedded in the page; one line of text if there is none."""
    if not file.is_file():
        return element("p", f"{caption}: no picture")
    return figure(file.read_bytes(), "png", caption, width)


def curve(name, x, y, colour=None, dashed=False):
    return {"name": name, "x": x, "y": y, "colour": colour, "dashed": dashed}


def draw(panels):
    """SVG of panels, one below the other: dictionaries with title, x, y (labels), curves, and
    optionally logarithmic and limits (of the y axis). Curves without a colour have one after the other.
    """
    drawing = Figure(figsize=(11, 4.2 * len(panels)))
    for axes, panel in zip(drawing.subplots(len(panels), squeeze=False)[:, 0], panels):
        axes.set(title=panel["title"], xlabel=panel["x"], ylabel=panel["y"])
        axes.grid(True, color="#ddd")
        if panel.get("logarithmic"):
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter("{x:g}")
        for i, line in enumerate(panel["curves"]):
            at = i if line["colour"] is None else line["colour"]
            axes.plot(line["x"], line["y"], label=line["name"].lstrip("_"), color=COLOURS[at % len(COLOURS)],
                      linestyle="--" if line["dashed"] else DASHES[at // len(COLOURS) % len(DASHES)],
                      marker="." if len(line["x"]) <= FEW_POINTS else None)
        if panel.get("limits"):
            axes.set_ylim(*panel["limits"])
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=8, frameon=False)
    # Equal widths regardless of legends, so that the time axes are aligned.
    drawing.subplots_adjust(left=0.08, right=0.66, top=1 - 0.4 / (4.2 * len(panels)),
                            bottom=0.5 / (4.2 * len(panels)), hspace=0.35)
    out = io.BytesIO()
    drawing.savefig(out, format="svg", metadata={"Date": None})
    return out.getvalue()


def error_plot(curves):
    """Errors over time from 0.1 to 100 mm. curves: (name, {"time_s": [...], "mm": [...]})."""
    lines = [curve(name, line["time_s"], line["mm"]) for name, line in curves if line.get("time_s")]
    if not lines:
        return Markup("")
    return figure(draw([{"title": "", "x": "time, s", "y": "mm", "logarithmic": True,
                         "limits": (0.1, 100), "curves": lines}]), "svg+xml", "Error over time")
