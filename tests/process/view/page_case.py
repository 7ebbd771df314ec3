"""A page of palpate-view in a real browser, with simulator and daemon behind it."""
import sys
import time
import unittest

import numpy as np
from cell import Cell, wait_for
import udpm

WIDE, PHONE = (1280, 800), (390, 844)


class PageCase(unittest.TestCase):
    """Tests run in alphabetical order: each continues where the previous one ended."""
    binaries, source, pictures = None, None, None

    @classmethod
    def setUpClass(cls):
        try:
            cls.cell = Cell(cls.binaries, cls.source)
        except OSError as error:
            raise SystemExit(f"{error}: build palpate-command, palpate-sim, palpated, palpate-view")
        try:
            cls.control = udpm.Listener(cls.cell.group, cls.cell.ports[0])
            cls.housekeeping = udpm.Listener(cls.cell.group, cls.cell.ports[1])
            cls.cell.start_simulator()
            cls.cell.start_daemon()
            cls.cell.start_view()
            cls.cell.open_browser(*WIDE)
        except Exception:
            print(cls.cell.tail())
            cls.cell.close()
            raise

    @classmethod
    def tearDownClass(cls):
        for listener in (cls.control, cls.housekeeping):
            listener.stop()
        cls.cell.close()

    def tearDown(self):
        outcome = self._outcome.result
        if any(test is self for test, _ in outcome.failures + outcome.errors) and self.pictures:
            self.cell.picture(f"{self.pictures}/failed.png")

    def shape(self):
        return udpm.shape(self.housekeeping.last["SHAPE"])[0]

    def still_shape(self):
        """Once nothing moves by more than 0.05 mm in a second."""
        def still():
            before = self.shape()
            time.sleep(1)
            now = self.shape()
            return now if before.shape == now.shape and np.abs(now - before).max() < 5e-5 else None
        shape = wait_for(still, "the shape comes to rest")
        self.cell.next_frames()
        return shape

    def shown(self):
        """Positions shown by the page: bit-identical to those of a received message."""
        x = np.array(self.cell.js("Array.from(palpate.estimate.position.array)"))
        heard = np.float32(x).astype(">f4").tobytes()
        self.assertTrue(any(heard in data for data in list(self.housekeeping.shapes)),
                        "no SHAPE held what the page shows")
        return x.reshape(-1, 3)

    def picture(self, path=None):
        """The page's data and its pixels, while nothing moves by a third of a millimetre."""
        def take():
            before, pixels = self.shown(), self.cell.picture(path)
            return (before, pixels) if np.abs(self.shown() - before).max() < 3e-4 else None
        return wait_for(take, "a picture of something still")

    def command(self, event):
        """By the page's button, until the daemon has confirmed it."""
        seen = len(self.housekeeping.history["COMPONENT_EVENT"])
        self.cell.click(f'#commands [data-event="{event}"]')
        wait_for(lambda: any(udpm.event(data)[2] == event for _, data in
                             self.housekeeping.history["COMPONENT_EVENT"][seen:]), event)

    def set_layers(self, **wanted):
        for layer, on in wanted.items():
            if self.cell.js(f"palpate.layers.{layer}") != on:
                self.cell.click(f'#layers [data-layer="{layer}"]')
        self.cell.next_frames(2)

    def start(self):
        """By the page, once it draws."""
        cell = self.cell
        wait_for(lambda: cell.js("!!window.palpate && palpate.frames > 3 && palpate.truth.mesh"
                                 " !== null && palpate.control.granted"), "the page draws")
        self.assertEqual(cell.text("#state"), "inactive")
        self.command("start")
        wait_for(lambda: cell.js("palpate.estimate.mesh !== null"), "the estimate is shown")

    def drag_target(self):
        """A manual target: 50 mm upwards in O from the current feature. Returns once it is reached."""
        cell = self.cell
        cell.click('#pointer [data-mode="target"]')
        value = np.array(wait_for(lambda: cell.js("palpate.frame?.feature?.value"), "a feature")[:3])
        here, there = cell.project(np.array([value, value + [0, 0, 0.05]]))[:, :2]
        cell.mouse("mousePressed", *here)
        for share in np.linspace(0.2, 1, 5):
            cell.mouse("mouseMoved", *(here + share * (there - here)))
        cell.mouse("mouseReleased", *there)
        wait_for(lambda: cell.js("palpate.frame?.feature?.revision >= 0"), "the target is taken")
        target = np.array(cell.js("palpate.frame?.feature?.target")[:3])
        # Dragged in the plane that faces the camera, which is not that of the object's z.
        self.assertTrue(np.allclose(cell.project(target[None])[0, :2], there, atol=3))
        wait_for(lambda: bool(np.linalg.norm(cell.js("palpate.frame?.feature?.error ?? [1]")) < 1.5e-3),
                 "the feature reaches it")
        cell.click('#pointer [data-mode="look"]')


def main():
    """Of a program with the arguments BINARIES SOURCE [--pictures FOLDER]."""
    PageCase.binaries, PageCase.source = sys.argv[1:3]
    PageCase.pictures = sys.argv[4] if len(sys.argv) > 4 else None
    result = unittest.main(argv=[sys.argv[0]], exit=False, verbosity=2, failfast=True).result
    sys.exit(not result.wasSuccessful())
