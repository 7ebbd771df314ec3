"""Plots: their curves, axes and texts, and what is reported if they cannot be drawn."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
FILE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/common/plots.py"
sys.path.insert(0, str(FILE.parent))
import plots  # noqa: E402


def panel(*curves, **more):
    return {"title": "Time", "x": "nodes", "y": "ms", "curves": list(curves), **more}


def styles(svg):
    """(colour, whether it is dashed) of each curve in its axes."""
    return [(colour, "stroke-dasharray" in style) for style, colour in
            re.findall(r'<path d="[^"]*" clip-path="[^"]*" style="([^"]*stroke: (#[0-9a-f]{6})[^"]*)"', svg)
            if colour != "#dddddd"]


class Picture(unittest.TestCase):
    def test_every_curve_has_a_style_of_its_own(self):
        curves = [plots.curve(f"c{i}", [0, 1], [0, i]) for i in range(3 * len(plots.COLOURS))]
        svg = plots.draw([panel(*curves)]).decode()
        found = re.findall(r'<path d="[^"]*" clip-path="[^"]*" style="([^"]*stroke: #(?!ddd)[^"]*)"', svg)
        self.assertEqual(len(set(found)), len(curves))
        for i in range(len(curves)):
            self.assertIn(f">c{i}</text>", svg)

    def test_a_curve_keeps_a_colour_that_it_was_given(self):
        curves = plots.curve("a", [0, 1], [0, 1], 2), plots.curve("b", [0, 1], [1, 0], 2, dashed=True)
        svg = plots.draw([panel(*curves)]).decode()
        self.assertEqual(styles(svg), [(plots.COLOURS[2], False), (plots.COLOURS[2], True)])

    def test_texts_are_drawn_as_they_are(self):
        svg = plots.draw([panel(plots.curve("_a_b", [0, 1], [0, 1]), title="$x$ & <b>")]).decode()
        for text in ("$x$ &amp; &lt;b&gt;", ">nodes<", ">ms<", ">a_b<"):
            self.assertIn(text, svg)

    def test_axes_of_logarithms_have_plain_numbers(self):
        svg = plots.draw([panel(plots.curve("a", [1, 10, 1000], [0.01, 1, 100]), logarithmic=True, logarithmic_x=True)])
        for text in (b">1000</text>", b">0.01</text>", b">100</text>"):
            self.assertIn(text, svg)
        self.assertNotIn(b"mathdefault", svg)

    def test_each_panel_has_the_same_height(self):
        sizes = [plots.draw([panel(plots.curve("a", [0], [0]))] * count, "png")[16:24] for count in (1, 3)]
        self.assertEqual([(int.from_bytes(size[:4], "big"), int.from_bytes(size[4:], "big")) for size in sizes],
                         [(1100, 420), (1100, 1260)])

    def test_it_is_the_same_every_time(self):
        self.assertEqual(*(plots.draw([panel(plots.curve("a", [0, 1], [0, None]))]) for _ in range(2)))


class Program(unittest.TestCase):
    def run_program(self, plot, *options):
        with tempfile.TemporaryDirectory() as name:
            file = pathlib.Path(name) / "plot.json"
            plot["file"] = str(file.with_suffix(".svg"))
            file.write_text(json.dumps(plot), encoding="utf-8")
            done = subprocess.run([sys.executable, *options, FILE, file], check=False, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            return done, file.with_suffix(".svg").exists()

    def test_the_picture_is_where_the_file_says(self):
        done, made = self.run_program({"panels": [panel(plots.curve("a", [0, 1], [0, 1]))]})
        self.assertEqual((done.returncode, done.stdout, made), (0, "", True))

    def test_a_missing_package_is_named(self):
        done, made = self.run_program({"panels": []}, "-S")  # no site's packages
        self.assertEqual((done.returncode, made), (1, False))
        self.assertEqual(done.stdout,
                         "missing Python package: python3-matplotlib (apt-get install python3-matplotlib)\n")


if __name__ == "__main__":
    unittest.main()
