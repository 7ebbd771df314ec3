"""Groups of a mesh by the command and by its browser page, up to the daemon's check of a configuration.

usage: regions_test.py BINARIES SOURCE [--pictures FOLDER]
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PICTURES = sys.argv[4] if len(sys.argv) > 4 else None
sys.path.insert(0, str(SOURCE / "tests/process/view"))
try:
    import numpy as np
    from browser import Browser, wait_for
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)

# The bar of the example, with its two ends as groups of faces: 9 corners and 16 middles of edges each.
CONFIGURATION = """base: {base}
object: {{mesh: {{box: ~, file: bar.msh}}, fixed_box: ~, grasp_box: ~, fixed_group: {clamp}, grasp_group: grasp,
         material: {{regions: [{{group: core, factor: 2}}]}}}}
feature: {{component: points, rest_points: ~, surface: 4, surface_group: surface}}
"""
END_AREA = 0.06 * 0.06  # m^2


class RegionsTest(unittest.TestCase):
    """Tests run in alphabetical order: each continues where the previous one ended."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="palpate_regions_")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.process, cls.page = None, Browser()

    @classmethod
    def tearDownClass(cls):
        cls.page.quit()
        if cls.process and cls.process.poll() is None:
            cls.process.kill()
        if cls.process:
            cls.process.stdout.close()
        cls.temporary.cleanup()

    def run_program(self, name, *words):
        return subprocess.run([BINARIES / name, *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              timeout=600)

    def mesh(self, *words):
        done = self.run_program("palpate-mesh", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def check(self, clamp="clamp"):
        """palpated's check of a configuration that names the groups."""
        (self.folder / "bar.yaml").write_text(CONFIGURATION.format(
            base=SOURCE / "rt/config/examples/bar_long_soft.yaml", clamp=clamp))
        done = self.run_program("palpated", "--config", "bar.yaml", "--check")
        return done.returncode, done.stdout + done.stderr

    def group(self, name):
        return next((g for g in self.page.js("palpate.state.groups.map(({outer, ...rest}) => rest)")
                     if g["name"] == name), None)

    def press(self, *points):
        """Presses the mouse at the first of these places of the mesh, moves, and lets it go at the last."""
        pixels = self.page.project(np.array(points, float))[:, :2]
        self.page.mouse("mousePressed", *pixels[0])
        for x, y in pixels[1:]:
            self.page.mouse("mouseMoved", x, y)
        self.page.mouse("mouseReleased", *pixels[-1])

    def choose(self, group, of="faces"):
        self.page.browser.execute_script(
            "document.getElementById('new-name').value = arguments[0];"
            "document.getElementById('new-of').value = arguments[1];", group, of)
        self.page.click("#new-group button")
        self.assertEqual(self.page.js("palpate.active"), {"name": group, "of": of})

    def test_1_command_writes_what_the_daemon_reads(self):
        self.mesh("box", "bar.msh", "--size", 0.5, 0.06, 0.06, "--cells", 10, 2, 2)
        self.mesh("regions", "bar.msh", "--group", "clamp", "--side", -1, 0, 0, "--output", "bar.msh")
        self.mesh("regions", "bar.msh", "--group", "core", "--of", "elements", "--box", 0.2, 0, 0, 0.3, 1, 1,
                  "--output", "bar.msh")
        self.mesh("regions", "bar.msh", "--group", "surface", "--side", 0, 0, 1, "--output", "bar.msh")
        code, said = self.check()
        self.assertEqual(code, 78, said)
        self.assertIn("object.grasp_group", said)
        self.assertIn("no group 'grasp'; allowed: body, clamp, core, surface", said)
        code, said = self.check("surface")
        self.assertIn("no group 'grasp'", said)
        self.mesh("regions", "bar.msh", "--group", "grasp", "--side", 1, 0, 0, "--output", "bar.msh")
        code, said = self.check()
        self.assertEqual(code, 0, said)
        self.assertIn("25 grasped, 25 fixed", said)
        code, said = self.check("surface")
        self.assertEqual(code, 78, said)
        self.assertIn("object.grasp_group: 5 of its 25 nodes are held twice: they belong to fixed_group as well", said)
        self.mesh("regions", "bar.msh", "--delete", "grasp", "--output", "bar.msh")

    def test_2_page_needs_the_token(self):
        self.start()
        # Without its token the page only shows.
        page = self.page
        page.open(f"http://127.0.0.1:{self.port}/", self.folder, 1280, 800)
        wait_for(lambda: page.js("!!window.palpate && palpate.view.mesh !== null && palpate.state.groups.length > 0"),
                 "the mesh is shown")
        page.js("palpate.link.send({type: 'delete', group: 'clamp'})")
        wait_for(lambda: "token" in page.text("#reason"), "the refusal is shown")
        self.assertIsNotNone(self.group("clamp"))
        self.assertTrue(page.js("document.getElementById('save').disabled"))
        page.browser.get("about:blank")
        page.browser.get(f"http://127.0.0.1:{self.port}/#token={self.token}")
        wait_for(lambda: page.js("!!window.palpate && palpate.granted && palpate.view.mesh !== null"
                                 " && palpate.state.groups.length > 0"), "the page may change groups")
        self.assertNotIn("token", page.js("location.href"))

    def start(self):
        """palpate-mesh regions --edit, until it has printed its address."""
        cls = type(self)
        cls.process = subprocess.Popen([BINARIES / "palpate-mesh", "regions", "bar.msh", "--edit", "--port", "0"],
                                       cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        address = self.process.stdout.readline()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#token=([0-9a-f]{64})\n", address)
        self.assertTrue(found, address)
        cls.port, cls.token = found.groups()

    def redraw(self):
        """Draws what is shown now: the page draws by itself only where something has changed."""
        before = self.page.frames()
        self.page.browser.execute_script("palpate.stage.dirty = true;")
        wait_for(lambda: self.page.frames() > before, "a frame is drawn")

    def test_3_side_is_picked_and_shown(self):
        page = self.page
        # From further right, so that the end at the hand is visible.
        page.browser.execute_script("palpate.stage.camera.position.x += 0.6; palpate.stage.controls.update();"
                                    "palpate.stage.dirty = true;")
        self.choose("grasp")
        page.click('#pointer [data-mode="connected"]')
        self.redraw()
        self.press([0.5, 0.02, 0.03])  # the end at the hand
        wait_for(lambda: self.group("grasp"), "the side is selected")
        grasp = self.group("grasp")
        self.assertEqual((grasp["faces"], grasp["nodes"]), (8, 9))
        self.assertAlmostEqual(grasp["area"], END_AREA, 9)
        self.redraw()
        x, y = page.project(np.array([[0.5, 0.02, 0.04]]))[0, :2].astype(int)
        red, green, blue = page.picture(PICTURES and f"{PICTURES}/regions.png")[y, x]
        self.assertGreater(green, 1.5 * max(red, blue), "the group's colour")

    def test_4_brush_is_one_step_of_undo(self):
        page = self.page
        page.click('#pointer [data-mode="brush"]')
        # On the side towards the viewer, at its end: more faces, all of that side.
        self.press(*[[x, 0, 0.03] for x in np.linspace(0.47, 0.44, 7)])
        wait_for(lambda: self.group("grasp")["faces"] > 8, "faces are painted")
        painted = np.array(page.js("Array.from(palpate.state.groups.find(({name}) => name === 'grasp').outer)"))
        triangles = np.array(page.js("Array.from(palpate.view.mesh.triangles)")).reshape(-1, 3)
        rest = np.array(page.js("Array.from(palpate.view.mesh.rest)")).reshape(-1, 3)
        corners = rest[triangles[painted]]
        on_end = (np.abs(corners[:, :, 0] - 0.5) < 1e-6).all(axis=1)
        on_side = (np.abs(corners[:, :, 1]) < 1e-6).all(axis=1)
        self.assertEqual(on_end.sum(), 8)
        self.assertTrue((on_end | on_side).all())
        self.assertGreater(corners[on_side, :, 0].min(), 0.3)
        page.click("#undo")
        wait_for(lambda: self.group("grasp")["faces"] == 8, "the whole stroke is undone")

    def test_5_rectangle_and_box(self):
        page = self.page
        self.choose("patch")
        page.click('#pointer [data-mode="rectangle"]')
        # A frame around the visible end: of the faces turned to the viewer those of this end, at least.
        end = page.project(np.array([[0.5, y, z] for y in (0, 0.06) for z in (0, 0.06)], float))[:, :2]
        page.mouse("mousePressed", *(end.min(axis=0) - 3))
        page.mouse("mouseMoved", *(end.max(axis=0) - 3))
        page.mouse("mouseReleased", *(end.max(axis=0) + 3))
        wait_for(lambda: self.group("patch"), "the rectangle is selected")
        patch = self.group("patch")
        self.assertGreaterEqual(patch["faces"], 8)
        page.browser.execute_script(
            "document.getElementById('lower-x').value = 0.4; document.getElementById('upper-x').value = 0.5;")
        self.choose("slice", "elements")
        page.click("#box-apply")
        wait_for(lambda: self.group("slice"), "the box is selected")
        self.assertEqual(self.group("slice")["elements"], 2 * 2 * 2 * 6)
        self.assertAlmostEqual(self.group("slice")["volume"], 0.1 * END_AREA, 9)
        page.click('#groups tr[data-group="patch"] button')
        wait_for(lambda: not self.group("patch"), "the group is deleted")

    def test_6_what_is_saved_is_what_the_daemon_reads(self):
        page = self.page
        self.assertEqual(page.text("#saved"), "not saved")
        # A clamp that meets the grasp is not saved.
        self.choose("clamp")
        page.click("#all-apply")
        wait_for(lambda: "clamp and grasp share 9 nodes" in page.text("#contradiction"), "the conflict is shown")
        before = (self.folder / "bar.msh").read_bytes()
        page.click("#save")
        wait_for(lambda: "nothing is written" in page.text("#reason"), "the refusal is shown")
        self.assertEqual((self.folder / "bar.msh").read_bytes(), before)
        page.click("#undo")
        wait_for(lambda: page.js("document.getElementById('contradiction').hidden"), "the conflict is gone")
        page.click("#save")
        wait_for(lambda: page.text("#saved") == "saved", "the file is written")
        code, said = self.check()
        self.assertEqual(code, 0, said)
        self.assertIn("25 grasped, 25 fixed", said)
        self.assertEqual(page.errors(), [])
        page.click("#finish")
        self.assertEqual(self.process.wait(300), 0)
        said = self.process.stdout.read()
        self.assertIn("fixed_group: clamp, grasp_group: grasp", said)
        self.assertRegex(said, r"slice +\d+ +0 +0 +48 +0\.00036")
        self.assertEqual(os.listdir(self.folder).count("bar.msh"), 1)


if __name__ == "__main__":
    result = unittest.main(argv=[sys.argv[0]], exit=False, verbosity=2, failfast=True).result
    sys.exit(not result.wasSuccessful())
