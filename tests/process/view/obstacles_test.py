"""The page shows the obstacles of the daemon's configuration where they are, and names them.

usage: obstacles_test.py BINARIES SOURCE [--pictures FOLDER]
"""
import pathlib
import sys
import tempfile
import threading
import unittest

try:
    import numpy as np
    from cell import Cell, wait_for
    import udpm
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)

BINARIES, SOURCE = sys.argv[1:3]
PICTURES = sys.argv[4] if len(sys.argv) > 4 else None
WEDGE = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PLACES = {"table": (0, 0, 0.1), "crate": (1.3, -0.1, 0.15), "ball": (1.0, 0.2, 0.2), "rod": (1.12, 0, 0.17),
          "post": (1.25, 0.2, 0.2), "wedge": (1.1, -0.2, 0.1), "plate": (1.05, 0, 0.45)}  # in W, m
LIST = """obstacles=[
  {{name: table, shape: half_space, pose: {{position: [0, 0, 0.1]}}}},
  {{name: crate, shape: box, size: [0.08, 0.08, 0.1], pose: {{position: [1.3, -0.1, 0.15], rpy_deg: [0, 0, 30]}}}},
  {{name: ball, shape: sphere, radius: 0.04, pose: {{position: [1.0, 0.2, 0.2]}}}},
  {{name: rod, shape: cylinder, radius: 0.02, length: 0.2, pose: {{position: [1.12, 0, 0.17], rpy_deg: [90, 0, 0]}}}},
  {{name: post, shape: capsule, radius: 0.03, length: 0.12, pose: {{position: [1.25, 0.2, 0.2]}}}},
  {{name: wedge, shape: mesh, cell: 0.005, file: {wedge}, pose: {{position: [1.1, -0.2, 0.1]}}}},
  {{name: plate, shape: box, size: [0.1, 0.1, 0.02], moved: true, timeout_ms: 500, pose: {{position: [1.05, 0, 0.45]}}}},
  {{name: palm, shape: sphere, radius: 0.05, link: hand}}]"""


class ObstaclesTest(unittest.TestCase):
    def test_they_are_drawn_where_they_are(self):
        with tempfile.TemporaryDirectory() as folder:
            wedge = pathlib.Path(folder, "wedge.obj")
            wedge.write_text(WEDGE)
            robot = "{urdf: " + f"{SOURCE}/sim/robot/lwr_hand.urdf" + "}"
            cell = Cell(BINARIES, SOURCE, sets=(LIST.format(wedge=wedge).replace("\n", ""), f"robot={robot}"))
            sender, self.stopped = udpm.Sender(cell.group, cell.ports[0]), threading.Event()
            try:
                self.see(cell, sender)
            except BaseException:
                print(cell.tail())
                if PICTURES and cell.browser:
                    cell.picture(f"{PICTURES}/failed.png")
                raise
            finally:
                self.stopped.set()
                sender.stop()
                cell.close()

    def see(self, cell, sender):
        cell.start_simulator()
        cell.start_daemon()
        cell.start_view()
        cell.open_browser(1280, 800)
        wait_for(lambda: cell.js("!!window.palpate && palpate.control.granted"), "the page may command")
        self.assertEqual(cell.js("palpate.obstacles.list.map((one) => one.obstacle.name)"), [*PLACES, "palm"])
        self.assertFalse(cell.js("document.querySelector('#layers [data-layer=obstacles]').hidden"))
        cell.click('#commands [data-event="start"]')
        wait_for(lambda: cell.js("palpate.frame?.x && palpate.estimate.mesh && palpate.frame.links"), "shape and arm")
        cell.next_frames()
        wait_for(lambda: "as configured: no message yet" in cell.text("#key"), "the plate's note")

        correction = "{axis: 'along z', unit: 'mm', displacement: -4.9, deviation: 0.5}"
        texts = cell.js("(() => { const o = palpate.obstacles, f = palpate.frame; o.show({...f, obstacles: f.obstacles.map("
                        f"(p, i) => i ? p : {{...p, corrections: [{correction}]}})}}, palpate.estimate, true); return o.texts(); }})()")
        self.assertEqual(texts[0], "table (estimated at −4.9 ± 1.0 mm along z)")

        for name, place in PLACES.items():
            if name != "table":
                self.assertLess(np.abs(self.place(cell, name) - place).max(), 1e-5, name)
        table = self.place(cell, "table")
        self.assertAlmostEqual(table[2], PLACES["table"][2], delta=1e-5)
        self.assertLess(np.abs(table[:2] - [1.11, 0]).max(), 0.05, "under the bar")
        extents = {"crate": (0.08, 0.08, 0.1), "ball": (0.08, 0.08, 0.08), "rod": (0.04, 0.04, 0.2), "post": (0.06, 0.06, 0.18),
                   "wedge": (0.1, 0.1, 0.1), "table": (1, 1, 0)}
        for name, extent in extents.items():
            found = cell.js(f"(() => {{ const g = {self.one(name)}.surface.geometry; g.computeBoundingBox();"
                            "return g.boundingBox.getSize(new THREE.Vector3()).toArray(); })()")
            self.assertLess(np.abs(np.array(found) - extent).max(), 1e-3, name)
        palm = self.place(cell, "palm")
        self.assertLess(np.linalg.norm(palm - [0.8, 0, 0.31]), 0.2, f"at the bar's end that the hand holds: {palm}")

        self.look(cell)
        self.move(cell, sender)
        self.assertEqual(cell.errors(), [])

    def look(self, cell):
        """At the pixels of some, and at the name under the pointer."""
        cell.browser.execute_script("palpate.frameObject()")
        cell.next_frames(5)
        shown = cell.picture(PICTURES and f"{PICTURES}/obstacles.png")
        cell.click('#layers [data-layer="obstacles"]')
        cell.next_frames(5)
        hidden = cell.picture()
        cell.click('#layers [data-layer="obstacles"]')
        cell.next_frames(5)
        for name in ("crate", "wedge", "rod", "post"):
            x, y = (int(v) for v in self.pixel(cell, name))
            more = shown[y, x] - hidden[y, x]
            self.assertGreater(more[2], 15, f"{name} is violet: {hidden[y, x]} becomes {shown[y, x]}")
            self.assertLess(more[1], more[2], name)
        cell.mouse("mouseMoved", *self.pixel(cell, "crate"), pressed=False)
        wait_for(lambda: cell.text("#hovered") == "crate", "its name")
        cell.mouse("mouseMoved", 700, 70, pressed=False)
        wait_for(lambda: cell.js("document.getElementById('hovered').hidden"), "no obstacle there")

    def move(self, cell, sender):
        there = np.array([1.2, 0.1, 0.5])

        def send():
            seq = 0
            while not self.stopped.wait(0.02):
                for name, place in (("plate", there), ("unknown", (0, 0, 0)), ("crate", (0, 0, 0))):  # the crate is fixed
                    seq += 1
                    sender.send("WORLD_STATE", udpm.world_state(seq, name, place))
        thread = threading.Thread(target=send, daemon=True)
        thread.start()
        wait_for(lambda: np.abs(self.place(cell, "plate") - there).max() < 1e-5, "the plate has moved")
        wait_for(lambda: "plate," in cell.text("#key"), "without a note")
        self.assertLess(np.abs(self.place(cell, "crate") - PLACES["crate"]).max(), 1e-5)
        self.stopped.set()
        thread.join()
        wait_for(lambda: "plate (no message for" in cell.text("#key"), "its message is old")

    @staticmethod
    def one(name):
        return f"palpate.obstacles.list.find((one) => one.obstacle.name === '{name}')"

    def place(self, cell, name):
        """In W, of one that is shown."""
        at = cell.js(f"(() => {{ const {{group}} = {self.one(name)}, {{floor}} = palpate.stage; return group.visible && "
                     "group.position.clone().sub(floor.position).applyQuaternion(floor.quaternion.clone().inverse()).toArray(); })()")
        self.assertTrue(at, f"{name} is not shown")
        return np.array(at)

    def pixel(self, cell, name):
        """Of the middle of its surface."""
        middle = cell.js(f"(() => {{ const {{surface, group}} = {self.one(name)}; group.updateMatrixWorld(); surface.geometry.computeBoundingSphere();"
                         "return surface.geometry.boundingSphere.center.clone().applyMatrix4(group.matrixWorld).toArray(); })()")
        return cell.project(np.array(middle)[None])[0, :2]


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
