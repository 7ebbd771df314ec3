"""The example with a manual force applied by mouse: palpated and palpate-view only.

usage: pushed_test.py BINARIES SOURCE
"""
import sys
import unittest

try:
    import numpy as np
    from cell import Cell, wait_for
    import udpm
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)

BINARIES, SOURCE = sys.argv.pop(1), sys.argv.pop(1)
SIDE, MODULUS, NU = 0.06, 300e3, 0.3  # as in bar_pushed.yaml


def deflection(force, at):
    """Deflection of a clamped beam (Timoshenko) at a transverse force, `at` m from the clamp."""
    bending = force * at**3 / (3 * MODULUS * SIDE**4 / 12)
    return bending + force * at / (MODULUS / (2 * (1 + NU)) * SIDE**2 * 5 / 6)


class PushedTest(unittest.TestCase):
    def test_a_node_that_is_pulled_by_the_mouse_gives_way_as_beam_theory_says(self):
        cell = Cell(BINARIES, SOURCE, "bar_pushed.yaml", sets=(), robot=None)
        listeners = [udpm.Listener(cell.group, port) for port in cell.ports]
        try:
            self.push(cell, *listeners)
        except BaseException:
            print(cell.tail())
            raise
        finally:
            for listener in listeners:
                listener.stop()
            cell.close()

    def push(self, cell, control, housekeeping):
        cell.start_daemon()
        cell.start_view()
        cell.open_browser(1280, 800)
        wait_for(lambda: cell.js("!!window.palpate && palpate.control.granted"), "the page may command")
        cell.click('#commands [data-event="start"]')
        wait_for(lambda: cell.js("palpate.estimate.mesh !== null"), "the shape is shown")
        wait_for(lambda: cell.text("#state") == "active", "the daemon senses")
        cell.browser.execute_script("palpate.frameObject()")
        cell.next_frames()
        rest, _ = wait_for(housekeeping.mesh, "the mesh")
        # Not at the end: viewing rays graze two sides at its corners.
        node = int(np.argmin(np.linalg.norm(rest - [0.4, SIDE / 2, SIDE], axis=1)))
        place = cell.project(rest[node][None])[0, :2]
        there = cell.project((rest[node] + [0, 0, 0.06])[None])[0, :2]
        cell.click('#pointer [data-mode="push"]')
        cell.mouse("mousePressed", *place)
        for share in np.linspace(0.25, 1, 4):
            cell.mouse("mouseMoved", *(place + share * (there - place)))
        forces = control.history["MANUAL_FORCE"]

        def agrees():
            """Force and position refer to the same time only once both rest."""
            if not forces:
                return False
            point, force = udpm.manual_force(forces[-1][1])
            moved = (udpm.shape(housekeeping.last["SHAPE"])[0] - rest)[node]
            expected = deflection(force[2], point[0])
            self.seen = f"node {node}: {moved} m by {force} N at {point}; theory {expected} m"
            return bool(force[2] > 0.2 and abs(moved[2] - expected) < 0.1 * expected)
        self.seen = "no force"
        try:
            wait_for(agrees, "the expected displacement of the node")
        except AssertionError as error:
            raise AssertionError(f"{error}; {self.seen}") from None
        cell.mouse("mouseReleased", *there)
        wait_for(lambda: bool(np.abs(udpm.shape(housekeeping.last["SHAPE"])[0] - rest).max() < 1e-4),
                 "the shape comes back")
        self.assertEqual(cell.errors(), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
