"""palpate-view in a real browser, with simulator and daemon behind it.

usage: view_test.py BINARIES SOURCE [--pictures FOLDER]
"""
import sys
import threading

try:
    import numpy as np
    from cell import wait_for
    from expected_picture import viridis, visible
    from page_case import PHONE, PageCase, main
    import udpm
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)


class ViewTest(PageCase):
    def test_1_loads_and_shows_the_shape(self):
        cell = self.cell
        self.start()
        self.assertTrue(cell.js("document.getElementById('waiting').hidden"))
        wait_for(lambda: cell.text("#state") == "active", "the page says so")
        self.assertNotIn("token", cell.js("location.href"), "and no longer stands in the address")
        rest, triangles = wait_for(self.housekeeping.mesh, "the mesh")
        self.assertTrue(np.allclose(np.array(cell.js("Array.from(palpate.estimate.mesh.rest)")),
                                    rest.ravel()))
        self.assertEqual(cell.js("palpate.estimate.mesh.triangles.length"), triangles.size)
        self.assertEqual(cell.js("palpate.stage.robots.length"), 1)

    def test_2_moves_with_the_data(self):
        before = self.shown()
        self.drag_target()
        self.still_shape()
        self.assertGreater(np.abs(self.shown() - before).max(), 0.02, "the mesh has moved")

    def test_3_pictures_show_the_data(self):
        cell = self.cell
        cell.browser.execute_script("palpate.frameObject()")
        self.still_shape()
        rest, triangles = self.housekeeping.mesh()
        error = wait_for(lambda: cell.js("palpate.frame?.shape_error"), "the error of the shape")
        self.assertLess(0, error["mean"])
        self.assertLess(error["mean"], error["rms"])
        self.assertLess(error["rms"], error["largest"])
        self.assertLess(error["largest"], 0.03, "m: the estimate agrees with the simulator")
        wait_for(lambda: "mm" in cell.text("#shape-error-now"), "its numbers")
        self.assertFalse(cell.js("document.getElementById('shape-error').hidden"))
        cell.picture(self.pictures and f"{self.pictures}/view.png")
        self.set_layers(truth=False, robot=False, forces=False, feature=False, plain=True, lines=False)
        shape, picture = self.picture(self.pictures and f"{self.pictures}/unlit.png")
        pixels = cell.project(shape)
        found, middle = visible(pixels, triangles)
        self.assertGreater(len(found), 20)
        displacement = 1e3 * np.linalg.norm(shape - rest, axis=1)
        top = float(cell.js("document.querySelector('#legend-ticks span:last-child').textContent"))
        self.assertGreaterEqual(top * 1.001, displacement.max())
        self.assertIn("Displacement, mm", cell.text("#legend-title"))
        colours = viridis(displacement / top)
        expected = colours[triangles[found]].mean(axis=1)
        x, y = middle[found, 0].astype(int), middle[found, 1].astype(int)
        off = np.abs(picture[y, x] - expected).max(axis=1)
        self.assertLess(np.median(off), 6, "colours of 255")
        self.assertGreater((off < 16).mean(), 0.9, f"{off.round()}")
        spread = np.abs(expected.max(axis=0) - expected.min(axis=0)).max()
        self.assertGreater(spread, 80, "the picture distinguishes large from small")
        # Next to the object there is nothing.
        low, high = pixels[:, :2].min(axis=0) - 25, pixels[:, :2].max(axis=0) + 25
        for p in ([low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]):
            self.assertLess(picture[int(p[1]), int(p[0])].max(), 100)
        self.set_layers(estimate=False)
        gone = cell.picture()
        self.assertGreater((np.abs(gone[y, x] - expected).max(axis=1) > 20).mean(), 0.8)
        self.set_layers(estimate=True, truth=True, robot=True, forces=True, feature=True,
                        plain=False, lines=True)
        for field, title in (("strain", "strain"), ("stress", "stress"),
                             ("uncertainty", "deviation")):
            cell.browser.execute_script(
                "const s = document.getElementById('field'); s.value = arguments[0]; s.onchange();",
                field)
            wait_for(lambda: cell.js("palpate.frame?.field") == field, field)
            wait_for(lambda: title in cell.text("#legend-title"), f"legend of {field}")
        self.assertIn("pose_wrench_filter", cell.text("#legend-note"), "pose_driven reports none")
        cell.browser.execute_script("const s = document.getElementById('field');"
                                    "s.value = 'displacement'; s.onchange();")

    def test_4_picks_and_pushes(self):
        cell = self.cell
        self.still_shape()
        shape = self.shown()
        rest, triangles = self.housekeeping.mesh()
        pixels = cell.project(shape)
        found, middle = visible(pixels, triangles)
        # At the middle of the bar, where nothing holds it.
        t = min(found, key=lambda k: abs(rest[triangles[k], 0].mean() - 0.22))
        node = min(triangles[t], key=lambda n: abs(rest[n, 0] - 0.22))
        place = pixels[node, :2] + 0.2 * (middle[t, :2] - pixels[node, :2])
        cell.mouse("mousePressed", *place)
        cell.mouse("mouseReleased", *place)
        self.assertEqual(cell.js("palpate.pointer.picked"), node)
        wait_for(lambda: f"Node {node}" in cell.text("#picked"), "its numbers")

        cell.click('#pointer [data-mode="push"]')
        forces = self.control.history["MANUAL_FORCE"]
        forces.clear()
        cell.mouse("mousePressed", *place)
        for share in np.linspace(0.25, 1, 4):
            cell.mouse("mouseMoved", place[0], place[1] - 110 * share)
        wait_for(lambda: bool(forces and np.linalg.norm(udpm.manual_force(forces[-1][1])[1]) > 0.3),
                 "a force on the bus")

        def moved():
            force = udpm.manual_force(forces[-1][1])[1]
            along = (self.shape()[node] - shape[node]) @ force / max(np.linalg.norm(force), 1e-9)
            return bool(along > 1e-3)
        wait_for(moved, "the node moves under the push")
        self.assertTrue(np.allclose(udpm.manual_force(forces[-1][1])[0], rest[node], atol=1e-6))
        before = len(forces)
        wait_for(lambda: len(forces) > before + 3, "it is renewed while the button is held")
        self.assertIn("Pushing node", cell.text("#hint"))
        if self.pictures:
            cell.picture(f"{self.pictures}/push.png")
        cell.mouse("mouseReleased", place[0], place[1] - 110)
        wait_for(lambda: not udpm.manual_force(forces[-1][1])[1].any(), "the last one is zero")
        wait_for(lambda: bool(np.abs(self.shape() - shape).max() < 2e-3), "the shape comes back")

        # A page that no longer renews its force, for whatever reason, stops pushing.
        cell.mouse("mousePressed", *place)
        cell.mouse("mouseMoved", place[0], place[1] - 110)
        wait_for(moved, "it moves again")
        cell.browser.execute_script("palpate.pointer.renew = () => {}")
        wait_for(lambda: bool(np.abs(self.shape() - shape).max() < 2e-3), "the push has expired")
        self.assertGreater(np.linalg.norm(udpm.manual_force(forces[-1][1])[1]), 0.3, "it was not ended")
        cell.mouse("mouseReleased", place[0], place[1] - 110)
        cell.browser.execute_script("delete palpate.pointer.renew")
        cell.click('#pointer [data-mode="look"]')

    def test_5_replaces_components(self):
        cell = self.cell
        cell.click('#tabs [data-tab="control"]')

        def put_in(slot, key, name):
            cell.browser.execute_script(
                "const s = document.querySelector(arguments[0]); s.value = arguments[1];"
                "s.nextElementSibling.click();", f'#slots select[data-slot="{slot}"][data-key="{key}"]', name)
            return wait_for(lambda: (lambda said: said if said and said != "\u2026" and "replacing" not in said
                                     else None)(cell.text("#answers li:first-child div")), f"answer for {name}")
        self.assertEqual(put_in("deformation", "component", "linear"), "replaced")
        self.assertIn(("deformation", "linear", "replaced"),
                      [udpm.event(data) for _, data in self.housekeeping.history["COMPONENT_EVENT"]])
        self.assertTrue(put_in("feature", "component", "pose").startswith("refused"), "it needs three points")
        self.assertEqual(cell.js("document.querySelector('#slots select[data-slot=feature]').value"), "point",
                         "what there is")
        if self.pictures:
            cell.picture(f"{self.pictures}/control.png")
        cell.next_frames()

    def test_5_shows_fingertips(self):
        cell = self.cell
        cell.click('#tabs [data-tab="plots"]')
        cell.next_frames(5)
        self.assertTrue(cell.js("document.getElementById('fingertips').hidden"), "there is none")
        sender, seq = udpm.Sender(cell.group, cell.ports[0]), 0
        counts = {2: [2000 + i for i in range(19)], 4: [1500] * 19}

        def sent_until(condition, what):
            """Sends further messages until the page fulfils the condition."""
            def send():
                nonlocal seq
                seq += 1
                for finger, electrodes in counts.items():
                    sender.send(f"BIOTAC_{finger}", udpm.biotac(seq, electrodes, [2 * seq, 2 * seq + 1], 700))
                return cell.js(condition)
            wait_for(send, what)
        sent_until("palpate.fingertips.rests.get('BIOTAC_2')?.count === 5", "the rest is known")
        self.assertFalse(cell.js("document.getElementById('fingertips').hidden"))
        self.assertEqual(cell.js("[...document.getElementById('finger').options].map((o) => o.text)"),
                         ["fingertip 2", "fingertip 4"])
        counts[2][9] += 150
        counts[2][2] -= 90
        sent_until("palpate.fingertips.differences[9] === 150 && palpate.fingertips.differences[2] === -90",
                   "a touch is shown")
        cell.browser.execute_script("document.getElementById('electrodes').scrollIntoView({block: 'center'})")
        cell.next_frames(5)
        picture = cell.picture(self.pictures and f"{self.pictures}/fingertip.png")
        # Above the texts of each electrode's disc.
        places = cell.js(
            "(() => { const b = document.getElementById('electrodes').getBoundingClientRect(), f = palpate.fingertips;"
            "return f.places.map((p) => f.pixel(p)).map(([x, y]) => [b.left + x, b.top + y - 10]); })()")
        red, green, blue = np.array([picture[int(y), int(x)] for x, y in places]).T
        self.assertGreater(red[9], blue[9] + 50, "increased")
        self.assertGreater(blue[2], red[2] + 50, "decreased")
        rest = [i for i in range(19) if i not in (2, 9)]
        self.assertGreater(min(red[rest].min(), green[rest].min(), blue[rest].min()), 230, "at rest")
        signals = cell.text("#fingertip-signals")
        self.assertIn("700", signals)
        self.assertIn("temperature", signals, "is not valid")
        pac = cell.js("Array.from(palpate.frame.BIOTAC_2_pac)")
        self.assertEqual(pac, list(range(pac[0], pac[0] + len(pac))))
        self.assertIn(f"last {len(pac)}:", cell.text("#pac-now"))
        choose = "const f = document.getElementById('finger'); f.value = arguments[0];"
        cell.browser.execute_script(choose, "BIOTAC_4")
        sent_until("palpate.fingertips.differences.every((d) => d === 0)", "the other one is untouched")
        cell.browser.execute_script(choose, "BIOTAC_2")
        sent_until("palpate.fingertips.differences[9] === 150", "the first one again")
        cell.click("#electrodes")
        sent_until("palpate.fingertips.differences[9] === 0", "a click tares")
        wait_for(lambda: " s old" in cell.text("#fingertip-age"), "the age, once nothing arrives")
        sender.stop()

    def test_5_shows_what_contradicts_the_model(self):
        cell = self.cell
        cell.click('#tabs [data-tab="plots"]')
        cell.next_frames(5)
        self.assertTrue(cell.js("document.getElementById('consistency').hidden"), "pose_driven has no test")
        wait_for(lambda: "(configured)" in cell.text("#numbers"), "E and nu are not estimated")
        self.assertNotIn("\u00b1", cell.text("#numbers"))
        sender, content, stopped = udpm.Sender(cell.group, cell.ports[0]), [1.5], threading.Event()

        def send():
            """As the daemon: without pause, however long the page takes."""
            seq = 0
            while not stopped.wait(0.05):
                seq += 1
                sender.send("DISCREPANCY", udpm.discrepancy(seq, *content))
        thread = threading.Thread(target=send, daemon=True)
        thread.start()
        wait_for(lambda: cell.text("#consistency-now") == "1.50, threshold 4.90", "the test")
        self.assertTrue(cell.js("document.getElementById('contradiction').hidden"))
        self.assertEqual(cell.text("#explanations"), "")
        causes = [(1, 0.82, (0.21, 0, 0.03), (0, 0, -1.2, 0, 0, 0)), (6, 0.1, (0.3, 0, 0), (0, 0, -0.4, 0, 0, 0)),
                  (2, 0.001, (0, 0, 0), (0.01, 0, 0, 0, 0, 0))]
        content[:] = [80, causes]
        wait_for(lambda: cell.js("palpate.consistency.plot.lines[2].value.filter((v) => v === 80).length > 20"),
                 "a contradiction")
        self.assertIn("force of hand 0 along z", cell.text("#contradiction"))
        self.assertFalse(cell.js("document.getElementById('contradiction').hidden"))
        lines = cell.js("[...document.querySelectorAll('#explanations li')].map((item) => item.textContent)")
        self.assertEqual(lines, ["For 2.1 s: force of hand 0 along z",
                                 "most likely: external contact near (0.210, 0.000, 0.030) m, 1.20 N; 0.82",
                                 "second: additional weight near (0.300, 0.000, 0.000) m, 0.40 N; 0.10"])
        cells = cell.js("[...document.getElementById('differences').rows].map((r) => [...r.cells].map("
                        "(c) => [c.textContent, c.className]))")
        self.assertEqual(cells[1][3], ["-1.20 \u00b1 0.10", "warn"])
        self.assertEqual(cells[1][1], ["0.00 \u00b1 0.10", ""])
        cell.browser.execute_script("document.getElementById('consistency-plot').scrollIntoView({block: 'center'})")
        cell.next_frames(5)
        picture = cell.picture(self.pictures and f"{self.pictures}/contradiction.png")
        left, top, right, bottom = cell.js("(() => { const b = document.getElementById('consistency-plot')"
                                           ".getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })()")
        # Below the legend: the contradiction above the threshold on the logarithmic axis.
        red, green, blue = np.moveaxis(picture[int(top) + 20:int(bottom) - 17, int(left) + 50:int(right) - 8], 2, 0)
        rows = {}
        for name, colour in (("contradiction", (242, 104, 106)), ("threshold", (240, 180, 64))):
            off = np.abs(np.stack([red, green, blue]) - np.array(colour)[:, None, None]).max(axis=0)
            self.assertGreater((off < 60).sum(), 3, name)
            rows[name] = np.median(np.nonzero(off < 60)[0])
        self.assertAlmostEqual((rows["threshold"] - rows["contradiction"]) / len(red), np.log10(80 / 4.9) / 4, delta=0.05)
        stopped.set()
        thread.join()
        wait_for(lambda: cell.js("document.getElementById('contradiction').hidden"), "hidden once nothing arrives")
        wait_for(lambda: cell.text("#consistency-now") == "not tested", "and said so")
        sender.stop()

    def test_6_survives_restarts(self):
        cell = self.cell
        cell.stop("palpated")
        wait_for(lambda: cell.text("#state") == "no daemon", "the page sees that it is gone")
        wait_for(lambda: "old" in cell.text("#stale"), "and that the shape is old")
        cell.start_daemon()
        wait_for(lambda: cell.text("#state") == "inactive", "the new one is seen")
        self.command("start")
        wait_for(lambda: cell.js("palpate.frame?.shape?.age_ms < 1000"), "its shape is shown")
        wait_for(lambda: cell.js("document.getElementById('stale').hidden"), "which is new")
        cell.next_frames()
        self.assertEqual(cell.stop("palpate-view"), 0)
        wait_for(lambda: not cell.js("palpate.connected"), "the connection has ended")
        self.assertEqual(cell.text("#state"), "no server")
        frames = cell.frames()
        cell.start_view()
        wait_for(lambda: cell.js("palpate.connected && palpate.control.granted"),
                 "the page connects again and may command")
        wait_for(lambda: cell.frames() > frames + 3, "frames come again")
        self.assertTrue(cell.js("document.getElementById('fingertips').hidden"), "none has been received since")
        self.command("stop")
        self.command("start")
        wait_for(lambda: cell.js("palpate.estimate.group.visible && palpate.truth.group.visible"),
                 "the shapes are shown again")

    def test_7_fits_a_phone(self):
        cell = self.cell
        cell.resize(*PHONE)
        cell.click('#tabs [data-tab="plots"]')
        cell.next_frames()
        self.assertLessEqual(cell.js("document.documentElement.scrollWidth"), PHONE[0])
        boxes = cell.js(
            "Object.fromEntries(['header', '#tools', '#legend', '#home', 'aside', '#tabs', '#picked', '#error-plot'].map((s) => {"
            "const b = document.querySelector(s).getBoundingClientRect();"
            "return [s, [b.left, b.top, b.right, b.bottom]]; }))")
        for name, (left, top, right, bottom) in boxes.items():
            self.assertTrue(-1 <= left and right <= PHONE[0] + 1 and top < PHONE[1], f"{name} lies outside")
        parts = ["header", "#tools", "#legend", "#home", "#picked", "aside"]
        for i, a in enumerate(parts):
            for b in parts[i + 1:]:
                (l1, t1, r1, b1), (l2, t2, r2, b2) = boxes[a], boxes[b]
                over = min(r1, r2) - max(l1, l2) > 1 and min(b1, b2) - max(t1, t2) > 1
                self.assertFalse(over, f"{a} and {b} overlap")
        buttons = cell.js("[...document.querySelectorAll('#commands button')].map((b) =>"
                          "b.getBoundingClientRect().right)")
        self.assertLessEqual(max(buttons), PHONE[0])
        cell.browser.execute_script("palpate.frameObject()")
        cell.next_frames()
        pixels = cell.project(self.shape())
        canvas = cell.js("(() => { const b = palpate.stage.canvas.getBoundingClientRect();"
                         "return [b.left, b.top, b.right, b.bottom]; })()")
        self.assertTrue((pixels[:, 0] > canvas[0]).all() and (pixels[:, 0] < canvas[2]).all(),
                        "the object lies in the picture")
        if self.pictures:
            cell.picture(f"{self.pictures}/phone.png")

    def test_9_draws_as_sharp_as_is_fluent(self):
        # By the test's own clock: [ms between frames, by sharpness] for this many s.
        script = """
            const [full, half, seconds, moves] = arguments, done = arguments[arguments.length - 1];
            import('./pace.js').then(({Pace}) => {
              const pace = new Pace(), seen = [];
              for (let now = 1000, sharpness = 1; now < 1000 * seconds;) {
                if (now < 1000 * moves) pace.moved(now);
                sharpness = pace.next(now, true);
                seen.push(sharpness);
                now += sharpness > 0.8 ? full : half;
              }
              done([Math.min(...seen), seen[Math.floor(seen.length / 2)], seen[seen.length - 1]]);
            });"""

        def paced(*words):
            return self.cell.browser.execute_async_script(script, *words)
        self.assertEqual(paced(17, 17, 10, 10), [1, 1, 1], "a fluent picture stays sharp")
        least, middle, last = paced(60, 25, 10, 10)
        self.assertEqual((least, middle, last), (0.75, 0.75, 0.75), "a slow one becomes fluent")
        self.assertEqual(paced(60, 25, 10, 8)[2], 1, "and sharp again once it rests")
        self.assertEqual(paced(60, 58, 12, 12)[1:], [1, 1], "where it does not help it stays sharp")

    def test_9_says_nothing_on_the_console(self):
        # Without the test's intervention while the server was down.
        errors = [e for e in self.cell.errors() if "ERR_CONNECTION_REFUSED" not in e]
        self.assertEqual(errors, [])


if __name__ == "__main__":
    main()
