"""Buses, keys, and the protocol with a daemon emulated by the test."""

import os
import shutil
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path
from typing import Any, Callable

import numpy as np
import palpate
from palpate import messages
from palpate.authentication import Sealer
from palpate.channels import field_of, text_of

from support import private_url, require_multicast


def setUpModule() -> None:
    require_multicast()


class Buses(unittest.TestCase):
    def setUp(self) -> None:
        self.url = private_url()
        self.bus = palpate.Bus(self.url)
        self.addCleanup(self.bus.close)

    def test_messages_come_in_order_with_what_the_bus_fills_in(self) -> None:
        other = palpate.Bus(self.url)
        self.addCleanup(other.close)
        subscription = self.bus.subscribe("FEATURE")
        for value in range(3):
            message = messages.feature_t()
            message.kind, message.value_count = field_of("point", 32), 1
            message.value[0] = float(value)
            other.publish("FEATURE", message)
        taken = [subscription.get(5) for _ in range(3)]
        self.assertEqual([message.value[0] for message in taken], [0, 1, 2])
        self.assertEqual([message.seq for message in taken], [0, 1, 2])
        self.assertEqual(len({message.session for message in taken}), 1)
        self.assertAlmostEqual(taken[0].utime * 1e-6, time.time(), delta=60)

    def test_a_callback_gets_each_and_the_iterator_the_newest(self) -> None:
        called: list[int] = []
        self.bus.subscribe("SIM_TICK", lambda message: called.append(message.tick))
        few = self.bus.subscribe("SIM_TICK", queue=2)
        for tick in range(5):
            message = messages.sim_tick_t()
            message.tick = tick
            self.bus.publish("SIM_TICK", message)
        end = time.monotonic() + 10
        while len(called) < 5 and time.monotonic() < end:
            self.bus.handle(1)
        self.assertEqual(called, [0, 1, 2, 3, 4])
        self.assertEqual(few.dropped, 3)
        self.assertEqual([message.tick for _, message in zip(range(2), few)], [3, 4])

    def test_channels_have_other_names_on_the_bus(self) -> None:
        renamed = palpate.Bus(self.url, channels={"IMU": "LEFT_IMU", "FEATURE": "F"})
        self.addCleanup(renamed.close)
        there, here = self.bus.subscribe("IMU"), renamed.subscribe("IMU")
        self.bus.publish("IMU", messages.imu_t())  # by a name that no longer is the channel's
        renamed.publish("IMU", messages.imu_t())
        self.assertEqual(here.get(5).session, renamed._session)
        self.assertEqual(there.get(5).session, self.bus._session)
        self.bus._transport.publish("LEFT_IMU", messages.imu_t().encode())
        self.assertEqual(here.get(5).session, 0)
        with self.assertRaises(TimeoutError):
            here.get(0.1)

    def test_impossible_names_of_channels_are_named(self) -> None:
        for names, wrong in (({"IMU_": "A"}, "IMU_: is not a channel"), ({"IMU": "left imu"}, "IMU: left imu; allowed"),
                             ({"IMU": "FEATURE"}, "FEATURE is the name of FEATURE"),
                             ({"IMU": "A", "FEATURE": "A"}, "A is the name of FEATURE")):  # fmt: skip
            with self.assertRaisesRegex(ValueError, wrong):
                palpate.Bus(self.url, channels=names)
        palpate.Bus(self.url, channels={"IMU": "FEATURE", "FEATURE": "IMU"}).close()

    def test_large_messages_go_in_fragments(self) -> None:
        message = messages.picture_t()
        message.data = os.urandom(300_000)
        message.size = len(message.data)
        subscription = self.bus.subscribe("PICTURE")
        self.bus.publish("PICTURE", message)
        self.assertEqual(subscription.get(5).data, message.data)

    @unittest.skipUnless(shutil.which("lcm-logger"), "needs lcm-logger")
    def test_liblcm_takes_what_it_sends(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.log"
            logger = subprocess.Popen(
                ["lcm-logger", f"--lcm-url={self.url}", "--quiet", "--flush-interval=10", str(path)],
                stderr=subprocess.DEVNULL,
            )
            try:
                picture = messages.picture_t()
                picture.data, picture.size = bytes(range(250)) * 800, 200_000
                end, seen = time.monotonic() + 20, False
                while not seen and time.monotonic() < end:
                    self.bus.publish("PICTURE", picture)
                    self.bus.publish("IMU", messages.imu_t())
                    time.sleep(0.05)
                    if path.exists() and path.stat().st_size > 1_000_000:
                        seen = True
            finally:
                logger.terminate()
                logger.wait(10)
            log = palpate.read_log(path)
            self.assertEqual(log["PICTURE"].messages[0].data, picture.data)
            self.assertGreater(len(log["IMU"]), 0)
            self.assertEqual(log.undecodable, {})

    def test_another_type_is_counted_and_does_no_harm(self) -> None:
        subscription = self.bus.subscribe("IMU")
        self.bus._transport.publish("IMU", messages.sim_tick_t().encode())
        self.bus._transport.publish("IMU", b"")
        self.bus.publish("IMU", messages.imu_t())
        subscription.get(5)
        self.assertEqual(subscription.undecodable, 2)

    def test_mistakes_are_named(self) -> None:
        with self.assertRaisesRegex(TypeError, "takes imu_t, not sim_tick_t"):
            self.bus.publish("IMU", messages.sim_tick_t())
        with self.assertRaisesRegex(ValueError, "channel_names"):
            self.bus.subscribe("NONSENSE")
        with self.assertRaisesRegex(ValueError, "allowed: python, lcm"):
            palpate.Bus(self.url, "carrier pigeon")
        begin = time.monotonic()
        with self.assertRaisesRegex(TimeoutError, "no IMU in 0.05 s"):
            self.bus.subscribe("IMU").get(0.05)
        self.assertLess(time.monotonic() - begin, 5)

    def test_a_crowd_on_other_channels_does_not_hold_who_waits(self) -> None:
        over = threading.Event()

        def flood() -> None:
            with palpate.Bus(self.url) as bus:
                while not over.is_set():
                    bus.publish("SIM_TICK", messages.sim_tick_t())

        thread = threading.Thread(target=flood)
        thread.start()
        begin = time.monotonic()
        try:
            with self.assertRaises(TimeoutError):
                self.bus.subscribe("IMU").get(0.2)
        finally:
            over.set()
            thread.join()
        self.assertLess(time.monotonic() - begin, 10)


class Keys(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "robot.key"

    def write(self, data: bytes, mode: int = 0o600) -> None:
        self.path.write_bytes(data)
        self.path.chmod(mode)

    def test_keys_are_raw_or_hexadecimal(self) -> None:
        key = bytes(range(32))
        for data in (key, key.hex().encode(), key.hex().upper().encode() + b"\n"):
            self.write(data)
            self.assertEqual(palpate.read_key_file(self.path), key)

    def test_bad_files_are_named_with_the_remedy(self) -> None:
        for data, mode, word in (
            (bytes(32), 0o644, "chmod 600"),
            (bytes(31), 0o600, "32 bytes or 64"),
            (b"g" * 64, 0o600, "32 bytes or 64"),
            (b"0" * 66, 0o600, "32 bytes or 64"),
            (b" " * 64, 0o600, "32 bytes or 64"),
        ):
            self.write(data, mode)
            with self.assertRaisesRegex(ValueError, word):
                palpate.read_key_file(self.path)
        with self.assertRaises(OSError):
            palpate.read_key_file(self.path.with_name("absent.key"))

    def test_a_seal_holds_for_its_message_channel_and_key(self) -> None:
        key = bytes(range(32))
        message = messages.manual_force_t()
        sealer = Sealer("MANUAL_FORCE", key)
        first = sealer.put(message)
        self.assertTrue(palpate.verify(key, "MANUAL_FORCE", message))
        self.assertFalse(palpate.verify(key, "SHAPE_TARGET", message))
        self.assertFalse(palpate.verify(bytes(32), "MANUAL_FORCE", message))
        self.assertGreater(sealer.put(message), first)
        message.force = [0, 0, 1]
        self.assertFalse(palpate.verify(key, "MANUAL_FORCE", message))


class Answers(unittest.TestCase):
    """Handling of a daemon's messages by Daemon; the test is the daemon."""

    def setUp(self) -> None:
        control, housekeeping = private_url(), private_url()
        self.daemon = palpate.Daemon(control, housekeeping, timeout=8)
        self.addCleanup(self.daemon.close)
        self.control, self.housekeeping = palpate.Bus(control), palpate.Bus(housekeeping)
        self.addCleanup(self.control.close)
        self.addCleanup(self.housekeeping.close)

    def say(self, event: str, counter: int, reason: str = "") -> None:
        message = messages.component_event_t()
        message.slot = message.instance = message.component = bytes(32)
        message.event, message.command_counter = field_of(event, 32), counter
        message.reason = field_of(reason, 256)
        self.housekeeping.publish("COMPONENT_EVENT", message)

    def answering(
        self, answer: Callable[[int, Any], None], channel: str = "COMPONENT_COMMAND"
    ) -> None:
        """Calls `answer` with the number of previous messages, for each, until the test ends."""
        over = threading.Event()
        subscription = self.control.subscribe(channel)

        def work() -> None:
            count = 0
            while not over.is_set():
                self.control.handle(0.05)
                while len(subscription):
                    answer(count, subscription.get(0))
                    count += 1

        thread = threading.Thread(target=work)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(over.set)

    def test_a_command_is_sent_again_until_it_is_answered(self) -> None:
        counters = []

        def answer(count: int, command: messages.component_command_t) -> None:
            counters.append(command.counter)
            self.say("start", command.counter + 1, "of another sender")
            if count >= 2:
                self.say(text_of(command.event), command.counter)

        self.answering(answer)
        self.assertEqual(self.daemon.start(), ("start", ""))
        self.assertEqual(len(set(counters)), 1)

    def test_a_refusal_is_an_error_with_the_reason(self) -> None:
        self.answering(lambda _, command: self.say("refused", command.counter, "reset first"))
        with self.assertRaisesRegex(palpate.Refused, "start: reset first"):
            self.daemon.start()

    def test_a_replacement_is_waited_for_to_its_end(self) -> None:
        def answer(count: int, command: messages.component_command_t) -> None:
            if count == 0:
                self.say("refused", command.counter, "another replacement is under way")
            elif count == 1:
                self.say("replacing", command.counter)
            else:
                self.assertEqual(text_of(command.parameters), '{"gain": 2.0}')
                self.say("replaced", command.counter)

        self.answering(answer)
        self.assertEqual(self.daemon.replace("control", "", {"gain": 2.0}).event, "replaced")

    def test_a_target_of_many_points_comes_in_full_chunks(self) -> None:
        points = np.arange(390.0).reshape(130, 3)
        chunks = []

        def answer(_: int, chunk: messages.shape_target_t) -> None:
            chunks.append(chunk)
            if chunk.chunk == chunk.chunks - 1:
                self.say("target", chunk.counter)

        self.answering(answer, "SHAPE_TARGET")
        self.assertEqual(self.daemon.target("points", -points, points).event, "target")
        first = [chunk for chunk in chunks if chunk.revision == chunks[0].revision]
        self.assertEqual([chunk.chunk for chunk in first], [0, 1, 2])
        self.assertEqual([chunk.point_count for chunk in first], [64, 64, 2])
        self.assertEqual([chunk.value_count for chunk in first], [192, 192, 6])
        self.assertEqual(first[1].rest_points[0], (192.0, 193.0, 194.0))
        self.assertEqual(first[2].values[5], -389.0)

    def touched(self, request: messages.touch_request_t, state: int, reason: str = "") -> None:
        message = messages.touch_t()
        message.request, message.state = request.request, state
        message.point, message.centre = [0.4, 0.0, 0.25], [0.4, 0.0, 0.258]
        message.point_deviation, message.stiffness = 2e-4, 150.0
        message.stiffness_deviation, message.indentation = 12.0, -1.0
        message.reason = field_of(reason, 128)
        self.control.publish("TOUCH", message)

    def test_a_touch_is_asked_for_until_it_is_heard_and_followed_to_its_end(self) -> None:
        asked: list[messages.touch_request_t] = []
        seen: list[str] = []

        def answer(count: int, request: messages.touch_request_t) -> None:
            asked.append(request)
            if count < 2:  # lost
                return
            self.touched(request, messages.touch_t.WAITING)
            other = messages.touch_request_t()
            other.request = request.request + 1
            self.touched(other, messages.touch_t.STOPPED, "of another sender")
            self.touched(request, messages.touch_t.APPROACHING)
            self.touched(request, messages.touch_t.TOUCHED)

        self.answering(answer, "TOUCH_REQUEST")
        touch = self.daemon.touch(
            [0, 0, -2], 0.2, distance=0.03, progress=lambda now: seen.append(now.state)
        )
        self.assertTrue(touch.touched)
        np.testing.assert_array_equal(touch.point, [0.4, 0.0, 0.25])
        np.testing.assert_array_equal(touch.centre, [0.4, 0.0, 0.258])
        self.assertEqual((touch.point_deviation, touch.stiffness), (2e-4, 150.0))
        self.assertIsNone(touch.indentation)
        self.assertEqual(seen, ["waiting", "approaching"])
        self.assertEqual(len({request.request for request in asked}), 1)
        self.assertEqual(tuple(asked[0].direction), (0.0, 0.0, -2.0))
        self.assertEqual((asked[0].force, asked[0].speed, asked[0].distance), (0.2, 0.0, 0.03))

    def test_a_touch_without_contact_has_no_point_and_a_refusal_is_an_error(self) -> None:
        states = [messages.touch_t.NO_CONTACT, messages.touch_t.REFUSED]
        self.answering(
            lambda count, request: self.touched(request, states[count], "why"), "TOUCH_REQUEST"
        )
        touch = self.daemon.touch([1, 0, 0], 0.2)
        self.assertEqual((touch.state, touch.reason, touch.point), ("no contact", "why", None))
        with self.assertRaisesRegex(palpate.Refused, "touch: why"):
            self.daemon.touch([1, 0, 0], 0.2)

    def test_an_interrupted_touch_is_cancelled(self) -> None:
        actions: list[int] = []

        def answer(_: int, request: messages.touch_request_t) -> None:
            actions.append(request.action)
            self.touched(request, messages.touch_t.APPROACHING)

        def interrupt(_: palpate.Touch) -> None:
            raise KeyboardInterrupt

        self.answering(answer, "TOUCH_REQUEST")
        with self.assertRaises(KeyboardInterrupt):
            self.daemon.touch([1, 0, 0], 0.2, progress=interrupt)
        end = time.monotonic() + 5
        while len(actions) < 2 and time.monotonic() < end:
            time.sleep(0.01)
        self.assertEqual(actions[-1], messages.touch_request_t.CANCEL)

    def test_a_timeout_names_the_url_without_an_answer(self) -> None:
        self.daemon.timeout = 0.3
        with self.assertRaisesRegex(palpate.NoAnswer, "is palpated running on udpm://"):
            self.daemon.start()
        with self.assertRaises(palpate.NoAnswer):
            self.daemon.health()

    def test_what_no_message_holds_is_refused_at_once(self) -> None:
        with self.assertRaisesRegex(ValueError, "parameters has 3000 bytes; at most 2047"):
            self.daemon.replace("control", "", "x" * 3000)
        with self.assertRaisesRegex(ValueError, "at most 1536 values and 512 points"):
            self.daemon.target("points", [0.0] * 1537)
        with self.assertRaisesRegex(ValueError, "three values each"):
            self.daemon.target("points", [0.0] * 3, [[0.0, 0.0, 0.0]] * 65)
        with self.assertRaises(ValueError):
            self.daemon.replace("control", "", {"gain": float("nan")})


if __name__ == "__main__":
    unittest.main()
