"""Several files to one log, clocks that are fitted to the data, and the preview."""

import json
import unittest

from support import WRENCH, ImportTest

import numpy as np
import yaml

from palpate_import.clock import NotObservable, Signal, fit_offset

ROW = "{},0,0,{},0,0,0\n"


def motion(time, seed=1):
    """A smooth quantity that does not repeat, 0 to about 3."""
    random = np.random.default_rng(seed)
    return np.abs(
        sum(
            a * np.sin(w * time + p)
            for a, w, p in zip(random.uniform(0.3, 1, 6), random.uniform(0.5, 12, 6), random.uniform(0, 6, 6))
        )
    )


class FilesTest(ImportTest):
    def describe(self, *files):
        self.write(yaml.safe_dump({"files": list(files)}), "map.yaml")
        return ["--map", self.folder / "map.yaml"]

    def wrench(self, name, channel, **keys):
        return {"file": name, "streams": [{"channel": channel, "format": "force_torque"}], **keys}


class Files(FilesTest):
    def test_of_different_clocks_and_heads_become_one_log(self):
        self.write(WRENCH + "".join(ROW.format(0.1 * i, i) for i in range(3)), "a.csv")
        self.write("# ms since the start\n" + WRENCH.replace("t,", "t [ms];", 1).replace(",", ";")
                   + "".join(ROW.format(100 * i, 10 * i).replace(",", ";") for i in range(3)), "b.csv")  # fmt: skip
        words = self.describe(self.wrench("a.csv", "FT_WRENCH"), self.wrench("b.csv", "FT_WRENCH_1", start=0.05))
        made = self.imported(*words, "--json", self.folder / "out.json")
        self.assertEqual([utime for utime, _ in made["FT_WRENCH"]], [0, 100000, 200000])
        self.assertEqual([(utime, m.wrench[2]) for utime, m in made["FT_WRENCH_1"]], [(50000, 0), (150000, 10), (250000, 20)])
        order = [event.channel for event in __import__("palpate").EventLog(self.log)]
        self.assertEqual(order, ["FT_WRENCH", "FT_WRENCH_1"] * 3)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual((report["rows"], report["input"]), (6, [str(self.folder / "a.csv"), str(self.folder / "b.csv")]))

    def test_may_be_named_on_the_command_line(self):
        for name in ("a.csv", "b.csv"):
            self.write(WRENCH + ROW.format(0, 1), name)
        files = [{"streams": self.wrench("", channel)["streams"]} for channel in ("FT_WRENCH", "FT_WRENCH_1")]
        words = self.describe(*files)
        self.assertEqual(len(self.imported(self.folder / "a.csv", self.folder / "b.csv", *words)), 2)
        self.log.unlink()
        self.assertIn("1 recordings on the command line; allowed: 2", self.refused(self.folder / "a.csv", *words, code=78))
        self.write(
            yaml.safe_dump({"files": [self.wrench("a.csv", "A"), self.wrench("no.csv", "B", optional=True)]}), "map.yaml"
        )
        self.assertEqual(list(self.imported(*words)), ["A"])

    def test_what_is_wrong_is_named(self):
        self.write(WRENCH + ROW.format(0, 1), "a.csv")
        self.write(WRENCH + ROW.format(100, 1), "b.csv")
        a, b = self.wrench("a.csv", "A"), self.wrench("b.csv", "B")
        for files, code, expected in [
            ([a, {**b, "streams": a["streams"]}], 1, "b.csv: channel A is given twice; it is from"), ([{**a, "strems": []}], 78, "files.0.strems: is unknown"),
            ([{**a, "time_unit": "h"}], 78, "time_unit: h; allowed: s, ms, us, ns"), ([{**a, "streams": []}], 78, "streams: []; allowed: one"),
            ([{**a, "preset": "no"}], 78, "preset: no; allowed: "), ([{**a, "rate": -1}], 78, "rate: -1; allowed: a number from 0"),
            ([a, {**b, "clock": {"quantity": "B.force", "follows": "C.force"}}], 78, "clock: 'C.force'; allowed: CHANNEL.QUANTITY of A"),
            ([a, {**b, "clock": {"quantity": "B.colour", "follows": "A.force"}}], 78, "quantity 'B.colour'; allowed: force, torque, fx"),
            ([{**a, "streams": [{"channel": "A", "format": "force_torque", "topic": "/a"}]}], 78, "allowed of a CSV file: no topic"),
        ]:  # fmt: skip
            self.assertIn(expected, self.refused(*self.describe(*files), code=code))
        self.imported(*self.describe(a, b))
        self.assertIn("warning", self.complaint)
        self.assertIn("have no time in common", self.complaint)

    def test_a_preset_has_keys_of_the_description_over_its_own(self):
        names = ["timestamp", *(f"actual_TCP_pose_{i}" for i in range(6))]
        self.write(",".join(names) + "\n1,0,0,0,0,0,0\n", "ur.csv")
        made = self.imported(*self.describe({"file": "ur.csv", "preset": "ur_rtde", "start": 2}))
        self.assertEqual(made["ROBOT_STATE"][0][0], 3000000)


class Clocks(FilesTest):
    def write_motion(self, name, offset, seed=1, noise=0.02, period=0.01):
        """A force whose size is `motion`, by a clock that is behind by `offset`, s."""
        random = np.random.default_rng(seed + 7)
        time = 5 + np.arange(0, 20, period) + 1e-4 * random.normal(size=int(20 / period)).clip(-2, 2)
        force = motion(time) + noise * random.normal(size=len(time))
        self.write(WRENCH + "".join(ROW.format(repr(float(t - offset)), repr(float(f))) for t, f in zip(time, force)), name)

    def test_an_offset_is_found_with_its_deviation(self):
        self.write_motion("a.csv", 0, 1)
        self.write_motion("b.csv", 0.7312, 2, period=0.004)
        clock = {"quantity": "B.force", "follows": "A.fz", "within": 3}
        report = self.folder / "out.json"
        made = self.imported(
            *self.describe(self.wrench("a.csv", "A"), self.wrench("b.csv", "B", clock=clock)), "--json", report
        )
        found = json.loads(report.read_text())["clocks"][str(self.folder / "b.csv")]
        self.assertAlmostEqual(found["offset"], 0.7312, delta=max(4 * found["deviation"], 1e-4))
        self.assertLess(found["deviation"], 1e-3)
        self.assertGreater(found["correlation"], 0.95)
        self.assertAlmostEqual(made["B"][0][0] * 1e-6, 5, delta=2e-3)
        self.assertIn("+0.73", self.said)

    def test_intervals_hold(self):
        errors = []
        for seed in range(25):
            random = np.random.default_rng(seed)
            offset = random.uniform(-1, 1)
            a, b = (np.sort(random.uniform(0, 15, 1500)) for _ in range(2))
            noise = [0.1 * np.convolve(random.normal(size=1505), np.ones(6), "valid") / 6**0.5 for _ in range(2)]
            found = fit_offset(Signal(a - offset, 2 * motion(a, seed) + noise[0]), Signal(b, motion(b, seed) + noise[1]), 1.5)
            errors.append((found.seconds - offset) / found.deviation)
        inside = np.mean(np.abs(errors) < 1.96)
        print(f"offsets within 95 % intervals: {100 * inside:.0f} %, deviation of normalised errors {np.std(errors):.2f}")
        self.assertGreaterEqual(inside, 0.8)  # of 25; over 200 draws 0.92 to 0.95
        self.assertLess(np.std(errors), 1.6)

    def test_what_is_not_observable_is_refused(self):
        time = np.arange(0, 20, 0.01)
        noise = np.random.default_rng(3).normal(size=(2, len(time)))
        for values, expected in [((motion(time), np.ones(len(time))), "is constant"), ((noise[0], noise[1]), "the largest correlation"),
                                 ((np.sin(9 * time), np.sin(9 * time)), "two offsets fit alike"),
                                 ((motion(time + 3), motion(time)), "allowed|end of the range|correlation")]:  # fmt: skip
            with self.assertRaisesRegex(NotObservable, expected):
                fit_offset(Signal(time, values[0]), Signal(time, values[1]), 1.0)
        self.write_motion("a.csv", 0)
        self.write_motion("b.csv", 0.1, 2, noise=1.0)
        clock = {"quantity": "B.force", "follows": "A.fz", "deviation": 1e-5}
        text = self.refused(*self.describe(self.wrench("a.csv", "A"), self.wrench("b.csv", "B", clock=clock)))
        self.assertIn("b.csv: the offset of its clock is not observable from B.force and A.fz", text)
        later = [
            self.wrench("a.csv", "A", clock={"quantity": "A.fz", "follows": "B.force"}),
            self.wrench("b.csv", "B", clock=clock),
        ]
        self.assertIn("whose own clock is fitted later", self.refused(*self.describe(*later), code=78))


class Preview(FilesTest):
    def test_shows_a_table_and_a_picture_and_writes_nothing_else(self):
        self.write(WRENCH + "".join(ROW.format(0.1 * i + (3 if i > 30 else 0), i) for i in range(50)), "a.csv")
        self.write("t,px,py,pz,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n0.1,1,2,4,1,0,0,0\n", "b.csv")
        robot = {"file": "b.csv", "streams": [{"channel": "ROBOT_STATE", "format": "robot_state"}]}
        words = self.describe(self.wrench("a.csv", "FT_WRENCH"), robot)
        picture = self.folder / "out.png"
        self.assertEqual(self.run_program(*words, "--preview", picture), 0, self.complaint)
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertFalse(self.log.exists())
        self.assertRegex(self.said, r"FT_WRENCH +50 +0\.000 +7\.900 +6\.2 +1 +3\.1000  force 0 to 49 N")
        self.assertRegex(self.said, r"ROBOT_STATE +2 .* speed 10 to 10|ROBOT_STATE +2 ")
        self.assertEqual(self.run_program(*words, "--preview", self.folder / "out.bmp"), 64)
        self.write(WRENCH + "0,1,2,3,4,5,x\n", "a.csv")
        picture.unlink()
        self.assertIn("a.csv:2:tz: 'x'", self.refused(*words, "--preview", picture))
        self.assertFalse(picture.exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
