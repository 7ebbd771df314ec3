"""A simulated cell for palpate-setup: scenes of palpate-sim that stand for the arm in each step, and the files of a user."""
import pathlib
import random
import shlex
import sys

import yaml

BIAS = "[1.2, -0.8, 2.1, 0.05, -0.03, 0.02]"  # N, N m, of the sensor
MASS = 4.8  # kg, of the hand
MODULUS = 45e3  # Pa, of the bar
SIZE, DENSITY = (0.5, 0.06, 0.06), 30.0
PLACE = ([1.36, 0.03, 0.28], [0.0, 0.0, 180.0])  # of the bar in W


class Cell:
    """Answers in a folder, and the commands that stand for the arm. binaries: of the build; source: its tree."""

    def __init__(self, folder, binaries, source):
        sys.path[:0] = [str(source / "tools" / name) for name in ("register", "common")]
        self.folder, self.binaries, self.source = pathlib.Path(folder), binaries, source
        generator = random.SystemRandom()
        group, port = f"239.255.{generator.randint(160, 250)}.{generator.randint(1, 250)}", generator.randint(10000, 32000)
        self.urls = {"control": f"udpm://{group}:{port}?ttl=0", "housekeeping": f"udpm://{group}:{port + 1}?ttl=0"}
        self.answers = {
            "machine": {"lateness": "simulator", "accept_failures": True},
            "channels": {**self.urls, "lower": [0.3, -0.5, 0.05], "upper": [1.0, 0.5, 0.9], "linear_speed": 0.08, "angular_speed": 0.5,
                         "force": 20, "torque": 5},
            "wrist": {"sensor_in_flange_position": [0, 0, 0.04], "imu_in_flange_position": [0, 0.055, 0.1],
                      "imu_in_flange_rpy_deg": [0, 0, 90], "grasp_in_flange_position": [0, 0, 0.3], "grasp_in_flange_rpy_deg": [0, 90, 180],
                      "seconds": 26, "clock": "sent"},
            "object": {"mesh": "box", "size": list(SIZE), "mass": DENSITY * SIZE[0] * SIZE[1] * SIZE[2], "clamped": "x-", "held": "x+",
                       "held_depth": 0.05, "grasp": [0.47, 0.03, 0.03], "grasp_stiffness": 1e6},
            "registration": {"position": [1.33, 0.05, 0.26], "rpy_deg": [4, -5, 172], "touches": "file", "touch_file": "touches.csv",
                             "deviation": 2e-4},
            "material": {"young_modulus": 20e3, "clock": "sent"},
            "commands": {"channels": self.hand(), "wrist": self.hand(moves=True), "material": self.bar(), "motion": self.bar()},
        }

    def _simulator(self, scene, **sets):
        words = [self.binaries / "palpate-sim", self.source / "sim/scenes" / scene]
        for key, value in {**{f"bus.{name}": url for name, url in self.urls.items()}, **sets}.items():
            words += ["--set", f"{key}={value}"]
        return shlex.join(map(str, words))

    def hand(self, moves=False):
        """The hand with nothing held, which wanders where it `moves`."""
        force_torque = ("{cable: {stiffness: 0, torsion: 0}, force: {hysteresis: 0}, torque: {hysteresis: 0}, "
                        f"bias: {BIAS}, warm_up: {{time: 600, wrench: [0, 0, 0, 0, 0, 0]}}}}")
        wander = "{duration: 40, rise: 2, seed: 5, periods: [2.5, 9], translation: [0.1, 0.1, 0.1], rotation_deg: [60, 40, 40]}"
        motion = {"motion": f"{{start_delay: 1, wander: {wander}}}"} if moves else {}
        return self._simulator("payload.yaml", **{"sensors.force_torque": force_torque, **motion})

    def bar(self, modulus=MODULUS):
        """The hand holds the bar and obeys palpated."""
        return self._simulator("bar_long_soft_control.yaml", **{"object.elements": "[10, 1, 1]", "sensors.force_torque.bias": BIAS,
                                                                "object.pads.stiffness": "1e6", "object.material.density": DENSITY,
                                                                "object.material.young_modulus": modulus})

    def write(self, **changes):
        """answers.yaml and touches.csv: 14 points on all sides of the bar but its clamped end, with 0.2 mm of noise."""
        import numpy as np
        from palpate_common.pose import Pose
        from palpate_common.rotations import from_rpy
        from palpate_common.surface import box_surface

        bar, random_numbers = box_surface(SIZE), np.random.default_rng(1)
        pose = Pose(from_rpy(np.radians(PLACE[1])), np.array(PLACE[0]))
        on, of = bar.samples(200, seed=4)
        chosen = [i for i in random_numbers.permutation(len(on)) if on[i, 0] > 0.02 and bar.normals[of[i], 0] < 0.5][:13]
        chosen += [i for i in range(len(on)) if bar.normals[of[i], 0] > 0.5][:1]  # its free end
        points = pose.of(on[chosen]) + 2e-4 * random_numbers.normal(size=(len(chosen), 3))
        rows = np.hstack([points, bar.normals[of[chosen]] @ pose.R.T])
        text = "x,y,z,nx,ny,nz\n" + "".join(",".join(f"{value:.6f}" for value in row) + "\n" for row in rows)
        (self.folder / "touches.csv").write_text(text)
        for step, change in changes.items():
            self.answers[step] = {**self.answers.get(step, {}), **change}
        path = self.folder / "answers.yaml"
        path.write_text(yaml.safe_dump(self.answers, sort_keys=False, width=1000))
        return path
