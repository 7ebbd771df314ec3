"""Parts of a page: tables, plots, pictures, as self-contained printable HTML. All text is escaped."""
import base64
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "common"))
from plots import curve, draw, missing  # noqa: E402

if LACKING := missing("jinja2", "matplotlib"):
    raise SystemExit(LACKING)

import jinja2  # noqa: E402
from markupsafe import Markup  # noqa: E402

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


def error_plot(curves):
    """Errors over time from 0.1 to 100 mm. curves: (name, {"time_s": [...], "mm": [...]})."""
    lines = [curve(name, line["time_s"], line["mm"]) for name, line in curves if line.get("time_s")]
    if not lines:
        return Markup("")
    return figure(draw([{"title": "", "x": "time, s", "y": "mm", "logarithmic": True,
                         "limits": (0.1, 100), "curves": lines}]), "svg+xml", "Error over time")
