"""palpate-view plays a recording in a real browser.

usage: recording_test.py BINARIES SOURCE [--pictures FOLDER]
"""
import struct
import sys

try:
    import numpy as np
    from cell import wait_for
    from page_case import PageCase, main
    import udpm
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)


class RecordingTest(PageCase):
    def test_plays_a_recording(self):
        cell = self.cell
        self.start()
        self.drag_target()
        self.assertTrue(self.record(f"{cell.folder.name}/run.log"))
        cell.stop("palpate-view")
        cell.start_view("--log", f"{cell.folder.name}/run.log")
        wait_for(lambda: cell.js("palpate.connected && !!palpate.frame?.player"), "the recording")
        self.assertFalse(cell.js("document.getElementById('timeline').hidden"))
        self.assertTrue(cell.js("document.getElementById('commands').hidden"), "nothing to command")
        if not cell.js("palpate.frame?.player?.playing"):
            cell.click("#play")
        wait_for(lambda: cell.js("palpate.frame?.player?.time > 0.3"), "it plays")
        if cell.js("palpate.frame?.player?.playing"):
            cell.click("#play")
        wait_for(lambda: cell.js("palpate.frame?.player?.playing === false"), "it pauses")
        paused = cell.js("palpate.frame?.player?.time")
        cell.next_frames()
        self.assertEqual(cell.js("palpate.frame?.player?.time"), paused)
        # A shape at rest is drawn once, and sharp: except for the colour scale, which may shrink
        # once.
        wait_for(lambda: cell.js("palpate.stage.sharpness") == 1, "a sharp picture")
        before = cell.js("palpate.pictures")
        cell.next_frames(10)
        self.assertLessEqual(cell.js("palpate.pictures"), before + 1, "nothing is drawn for nothing")
        for number in (250, 60, 199):
            cell.browser.execute_script(
                "const s = document.getElementById('seek'); s.value = arguments[0];"
                "s.oninput(); s.onchange();", self.recorded[number][0] + 0.004)
            expected = udpm.shape(self.recorded[number][1])[0]
            wait_for(lambda: np.array_equal(
                np.array(cell.js("Array.from(palpate.estimate.position.array)")).reshape(-1, 3),
                expected), f"shape {number} of the recording is shown")
        if self.pictures:
            cell.picture(f"{self.pictures}/recording.png")

    def record(self, path):
        """An LCM event log of the last 300 shapes, 10 ms apart."""
        wait_for(lambda: len(self.housekeeping.shapes) > 300, "enough shapes to record")
        shapes = list(self.housekeeping.shapes)[-300:]
        self.recorded = [(0.01 * i, data) for i, data in enumerate(shapes)]
        with open(path, "wb") as log:
            events = [(0, b"SHAPE_MESH", chunk) for chunk in self.housekeeping.mesh_chunks.values()]
            events += [(int(1e6 * at), b"SHAPE", data) for at, data in self.recorded]
            for number, (at, channel, data) in enumerate(events):
                log.write(struct.pack(">IqqII", 0xEDA1DA01, number, 1_700_000_000_000_000 + at,
                                      len(channel), len(data)) + channel + data)
        return len(events)


if __name__ == "__main__":
    main()
