"""Plug-ins in the daemon itself: found by name, installed while the loop runs, closing the
loop, and the daemon's handling of failing ones."""

import re
import subprocess
import time
import unittest
from typing import Any

import numpy as np
import palpate

from processes import BAR, BIN, PATIENCE, RTCHECK, SANITIZED, SOURCE, ProcessTest, Program

MINE = f"[{{library: {BIN}/libmy_components.so}}]"
UNRULY = "[{library: palpate-unruly.so}]"
MY_BAR = SOURCE / "tools/examples/plugin/bar_long_soft.yaml"
REST, TARGET = [0.25, 0.03, 0.06], [0.25, 0.03, 0.08]
FAULTED = palpate.STATES.index("faulted")


# The setting that puts a component of UNRULY into a slot.
SLOTS = {
    "sensing": "sensing=[{{name: wrist, component: unruly_sensor, {}}}]",
    "contact": "contact=[{{component: unruly_transformer, {}}}]",
    "estimation": "estimation={{component: unruly_estimator, {}}}",
    "deformation": "deformation={{component: unruly_model, {}}}",
    "feature": "feature={{component: unruly_feature, {}}}",
    "control_provider": "control={{provider: unruly_provider, law: proportional_twist, {}}}",
    "control_law": "control={{provider: fem, law: unruly_law, {}}}",
}


class OwnComponents(ProcessTest):
    def test_own_sensor_and_law_close_the_loop(self) -> None:
        self.start_daemon(BAR, "--stepped", plugins=MINE)
        path = self.folder / "run.log"
        with palpate.Recorder(path, (self.control, self.housekeeping)):
            simulator = self.start_simulator("--fast")
            daemon = self.connect()
            daemon.start()
            # Both are installed by name while the loop runs.
            daemon.replace("sensing", "ft_median", {"samples": 9})
            daemon.replace("control", "", {"provider": "fem", "law": "integral_twist"})
            daemon.target("point", TARGET, [REST])
            features = daemon.control.subscribe("FEATURE", queue=1)

            since: list[int] = []  # us, settling time of the feature

            def settled(feature: Any) -> bool:
                there = feature.revision >= 0 and np.linalg.norm(feature.error[:3]) < 2e-4
                since[:] = (since or [feature.utime]) if there else []
                return bool(since and feature.utime - since[0] > 500_000)

            # Where the proportional law has a steady-state error of 1 mm, this one converges.
            features.wait_for(settled, PATIENCE)
            health = daemon.health()
            self.assertEqual(palpate.STATES[health.state], "active", palpate.text_of(health.reason))
            with self.assertRaisesRegex(palpate.Refused, "integral_gain.*0 to 50"):
                daemon.replace("control", "", {"integral_gain": 99})
            with self.assertRaisesRegex(palpate.Refused, "samples must be odd"):
                daemon.replace("sensing", "", {"samples": 4})
            with self.assertRaisesRegex(palpate.Refused, "plugins"):
                daemon.replace("all", "", {"plugins": []})
            daemon.stop()
            simulator.end()
        error = palpate.feature_error(palpate.read_log(path, clock="sent"))
        self.assertGreater(error.distance[0], 0.018)
        self.assertLess(error.at_rest, 0.002)
        # A replay uses them as well, and is bit-identical each time.
        words = [BIN / "palpate-replay", path, "--config", MY_BAR, "--set", f"plugins={MINE}"]
        said = [
            subprocess.run([str(w) for w in words], capture_output=True, text=True).stdout
            for _ in range(2)
        ]
        hashes = [re.search(r"[1-9]\d* shapes, hash (\w+)", text) for text in said]
        self.assertIsNotNone(hashes[0], said[0])
        self.assertEqual(*[found and found.group(1) for found in hashes])

    @unittest.skipIf(SANITIZED, "allocations are not counted in such a build")
    def test_they_allocate_nothing_in_the_loop(self) -> None:
        self.start_daemon(
            BAR,
            plugins=MINE,
            sensing="[{component: ft_median, tare_samples: 50}]",
            control="{provider: fem, law: integral_twist}",
        )
        self.start_simulator()
        daemon = self.connect()
        # First-time work of a thread is not caused by the components.
        daemon.wait_for(lambda health: health.cycles > 300, PATIENCE)
        daemon.start()
        daemon.target("point", TARGET, [REST])
        moving = daemon.control.subscribe("TWIST_COMMAND", queue=1)
        moving.wait_for(lambda command: any(command.twist), PATIENCE)
        cycles = daemon.health().cycles
        health = daemon.wait_for(lambda health: health.cycles > cycles + 1000, PATIENCE)
        self.assertEqual(health.allocations, 0)

    def test_a_wrong_library_ends_the_start_with_file_and_key(self) -> None:
        program = Program(self, [BIN / "palpated", "--config", BAR, *self.urls, "--set",
                                 "plugins=[{library: /no/such.so}]"])  # fmt: skip
        self.assertEqual(program.process.wait(PATIENCE), 78)
        self.assertIn("plugins.0.library: /no/such.so: there is no such file", program.output())


@unittest.skipIf(RTCHECK, "ends a program whose loop allocates, which is what is tested here")
class Unruly(ProcessTest):
    def running(self, **sets: str) -> palpate.Daemon:
        self.program = self.start_daemon(BAR, "--stepped", plugins=UNRULY, **sets)
        self.simulator = self.start_simulator("--fast")
        daemon = self.connect()
        daemon.start()
        daemon.target("point", TARGET, [REST])
        return daemon

    @unittest.skipIf(SANITIZED, "allocations are not counted in such a build")
    def test_one_that_allocates_is_counted(self) -> None:
        # In real time: in lock-step overruns are not counted.
        self.start_daemon(
            plugins=UNRULY, sensing="[{component: unruly_sensor, does: allocate, after: 100}]"
        )
        daemon = self.connect()
        daemon.start()
        daemon.wait_for(lambda health: health.allocations > 50, PATIENCE)

    def test_a_law_that_throws_faults_and_the_daemon_lives(self) -> None:
        daemon = self.running(control="{provider: fem, law: unruly_law, does: throw, after: 300}")
        health = daemon.wait_for(lambda health: health.state == FAULTED, PATIENCE)
        self.assertIn("the plug-in threw an exception", palpate.text_of(health.reason))
        twists = daemon.control.subscribe("TWIST_COMMAND", queue=1)
        twists.wait_for(lambda message: not any(message.twist), PATIENCE)
        # With another law instead, the loop continues.
        daemon.replace("control", "", {"law": "unruly_law", "does": "nothing"})
        daemon.reset()
        daemon.start()
        daemon.target("point", TARGET, [REST])
        twists.wait_for(lambda message: message.valid == 1 and message.twist[0] != 0, PATIENCE)
        self.assertEqual(self.program.end(), 0)

    def silence_before_zero(self, slot: str) -> int:
        """Time from the last command of the loop to the zero command, us, where a plug-in hangs."""
        setting = SLOTS[slot].format("does: hang, after: 300")
        program = self.start_daemon(BAR, "--set", setting, plugins=UNRULY)
        simulator = self.start_simulator()
        daemon = self.connect()
        seen: list[Any] = []
        daemon.control.subscribe("TWIST_COMMAND", seen.append)
        daemon.start()
        daemon.target("point", TARGET, [REST])
        for _ in range(1000):
            daemon.control.run(0.02)
            if program.process.poll() is not None:
                break
        daemon.control.run(0.1)
        self.assertEqual(program.process.wait(PATIENCE), 5, program.output())
        self.assertRegex(program.output(), "unruly_.*has not returned from a call in the loop")
        self.assertFalse(any(seen[-1].twist))
        self.assertEqual(seen[-1].valid, 0)
        simulator.end()
        return int(seen[-1].utime - seen[-2].utime)

    def test_one_that_hangs_in_the_loop_ends_the_daemon_after_a_zero_command(self) -> None:
        for slot in SLOTS:
            with self.subTest(slot):
                # At most three times: other programs may take the processor.
                self.assertTrue(any(self.silence_before_zero(slot) < 20_000 for _ in range(3)))

    def test_one_that_hangs_at_set_up_is_refused(self) -> None:
        # All at a time, since each is waited for.
        programs = {
            (slot, does): Program(self, [BIN / "palpated", "--config", BAR, *self.urls, "--set", f"plugins={UNRULY}",
                                         "--set", setting.format(f"does: {does}")])
            for slot, setting in SLOTS.items() for does in ("hang_setup", "hang_warm_up")
        }  # fmt: skip
        for (slot, does), program in programs.items():
            with self.subTest(slot=slot, does=does):
                self.assertEqual(program.process.wait(PATIENCE), 78)
                self.assertRegex(program.output(), "unruly_.*has not returned within 4 s")

    def test_one_that_hangs_when_it_is_installed_is_refused_and_the_loop_continues(self) -> None:
        program = self.start_daemon(BAR, plugins=UNRULY)
        simulator = self.start_simulator()
        daemon = self.connect()
        daemon.start()
        daemon.target("point", TARGET, [REST])
        hanging = {"does": "hang_warm_up"}
        wanted = {
            "estimation": ("unruly_estimator", hanging),
            "feature": ("unruly_feature", hanging),
            "control": ("", {"provider": "fem", "law": "unruly_law", **hanging}),
        }
        for slot, (component, parameters) in wanted.items():
            with self.subTest(slot):
                cycles, began = daemon.health().cycles, time.monotonic()
                with self.assertRaisesRegex(palpate.Refused, "has not returned within 4 s"):
                    daemon.replace(slot, component, parameters)
                waited = time.monotonic() - began
                self.assertGreater(daemon.health().cycles - cycles, 500 * waited)
                self.assertIn(palpate.STATES[daemon.health().state], ("active", "degraded"))
        simulator.end()
        self.assertEqual(program.end(), 0)

    def test_numbers_that_are_none_never_reach_the_robot(self) -> None:
        daemon = self.running(control="{provider: fem, law: unruly_law, does: nan, after: 300}")
        seen: list[Any] = []
        daemon.control.subscribe("TWIST_COMMAND", lambda message: seen.append(message.twist))
        health = None
        for _ in range(1000):
            daemon.control.run(0.02)
            health = daemon.health()
            if health.state == FAULTED:
                break
        assert health is not None
        self.assertIn("the command is not finite", palpate.text_of(health.reason))
        daemon.control.run(0.05)
        self.assertGreater(len(seen), 10)
        self.assertTrue(np.isfinite(np.array(seen)).all())


if __name__ == "__main__":
    unittest.main()
