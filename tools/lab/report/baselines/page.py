"""Parts of the report: tables, curves, images, as self-contained printable HTML."""
import base64
import html
import math

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999"]
DASHES = ["", "5 3", "1 3"]

HEAD = ("<!doctype html><meta charset='utf-8'><title>{title}</title><style>"
        "body{{font:13px sans-serif;max-width:1100px;margin:2em auto}}table{{border-collapse:collapse;"
        "margin:1em 0}}td,th{{border:1px solid #bbb;padding:2px 6px;text-align:left}}"
        "svg text{{font:11px sans-serif}}figure{{display:inline-block;margin:6px}}"
        "@media print{{.page{{break-before:page}}}}</style><h1>{title}</h1>")


def head(title):
    return HEAD.format(title=html.escape(title))


def table(header, rows):
    out = ["<table><tr>" + "".join(f"<th>{html.escape(h)}</th>" for h in header) + "</tr>"]
    out += ["<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>"
            for row in rows]
    return "".join(out) + "</table>"


def plot(curves):
    """Error over time, with a logarithmic axis from 0.1 to 100 mm. curves: (name, curve)."""
    curves = [(name, curve) for name, curve in curves if curve.get("time_s")]
    if not curves:
        return ""
    until = max(curve["time_s"][-1] for _, curve in curves)
    width, height, left, foot = 620, 230, 45, 30

    def x(time):
        return left + (width - left - 10) * time / until

    def y(mm):
        return 10 + (height - foot - 10) * (2 - math.log10(min(100, max(0.1, mm)))) / 3
    out = [f'<svg viewBox="0 0 {width} {height + 16 * len(curves)}" width="{width}">']
    for mm in (0.1, 1, 2, 5, 10, 100):
        out.append(f'<line x1="{left}" x2="{width - 10}" y1="{y(mm):.1f}" y2="{y(mm):.1f}" '
                   f'stroke="#ddd"/><text x="2" y="{y(mm) + 4:.1f}">{mm} mm</text>')
    for second in range(0, int(until) + 1, 3):
        out.append(f'<text x="{x(second):.1f}" y="{height - 12}">{second} s</text>')
    for i, (name, curve) in enumerate(curves):
        dash = DASHES[i // len(COLOURS) % len(DASHES)]
        line = f'stroke="{COLOURS[i % len(COLOURS)]}" stroke-dasharray="{dash}"'
        points = " ".join(f"{x(t):.1f},{y(mm):.1f}"
                          for t, mm in zip(curve["time_s"], curve["mm"]))
        at = height + 16 * i
        out.append(f'<polyline points="{points}" fill="none" {line}/>'
                   f'<line x1="{left}" x2="{left + 25}" y1="{at}" y2="{at}" {line}/>'
                   f'<text x="{left + 30}" y="{at + 4}">{html.escape(name)}</text>')
    return "".join(out) + "</svg>"


def picture(run):
    """The last state of a run for which there is an image."""
    files = sorted(run["folder"].glob("state_*.png"))
    if not files:
        return ""
    data = base64.b64encode(files[-1].read_bytes()).decode()
    return (f'<figure><img src="data:image/png;base64,{data}" width="360"/><figcaption>'
            f'{html.escape(run["application"])}, {html.escape(run["level"])}</figcaption></figure>')
