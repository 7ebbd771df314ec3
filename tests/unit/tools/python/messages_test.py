"""The generated messages: bytes, type hints, and matching versions."""

import os
import re
import unittest
from pathlib import Path

import palpate
from palpate import messages
from palpate.channels import DecodeError, decode, field_of, text_of, type_of

from support import SOURCE


class Messages(unittest.TestCase):
    def test_decode_after_encode_is_identity(self) -> None:
        for channel in palpate.channel_names():
            kind = type_of(channel)
            message = kind()
            for field in kind.__slots__:  # a byte array is empty text at first
                if getattr(message, field) == "":
                    size = {"parameters": 2048, "authentication": 32, "event": 32}.get(field, 32)
                    setattr(message, field, b"x" * size)
                elif isinstance(getattr(message, field), list) and "" in getattr(message, field):
                    setattr(message, field, [b"x" * 24] * len(getattr(message, field)))
            if channel == "SHAPE":
                message.node_count, message.xyz_count, message.xyz = 1, 3, [1.0, 2.0, 3.0]
            if channel == "COMPONENT_COMMAND":
                message.event = field_of("start", 16)
            if channel == "HEALTH":
                message.model_executor = [b"x" * 12] * 12
            if channel in ("COMPONENT_EVENT", "HEALTH"):
                message.reason = field_of("why", 256 if channel == "COMPONENT_EVENT" else 128)
            message.utime, message.seq, message.session = 1 << 40, 77, -5
            data = message.encode()
            again = decode(channel, data)
            self.assertEqual(again.utime, 1 << 40)
            self.assertEqual(again.seq, 77)
            self.assertEqual(again.session, -5)
            self.assertEqual(again.encode(), data, channel)

    def test_second_arms_and_fingers_have_the_same_types(self) -> None:
        self.assertIs(type_of("BIOTAC_3"), messages.biotac_t)
        self.assertIs(type_of("TWIST_COMMAND_1"), messages.twist_command_t)
        self.assertIsNone(type_of("NONSENSE"))
        self.assertIsNone(type_of("SHAPE_"))

    def test_what_is_no_message_is_said_so(self) -> None:
        data = messages.imu_t().encode()
        for channel, wrong in (
            ("IMU", data[:-1]),
            ("IMU", b""),
            ("IMU", b"\0" * len(data)),
            ("FT_WRENCH", data),
            ("NONSENSE", data),
        ):
            with self.assertRaises(DecodeError):
                decode(channel, wrong)

    def test_counts_that_lie_are_refused(self) -> None:
        shape = messages.shape_t()
        data = shape.encode()
        for count in (-1, 1, 1 << 30):
            forged = data[:56] + count.to_bytes(4, "big", signed=True) + data[60:]
            with self.assertRaises(DecodeError, msg=str(count)):
                decode("SHAPE", forged)

    def test_texts(self) -> None:
        self.assertEqual(text_of(field_of("start", 16)), "start")
        self.assertEqual(text_of(b"abc\0def"), "abc")
        with self.assertRaisesRegex(ValueError, "at most 15"):
            field_of("x" * 16, 16)

    def test_every_type_has_a_hint_of_every_field(self) -> None:
        folder = Path(messages.__file__).parent
        types = sorted(Path(SOURCE, "lcmtypes").glob("*.lcm"))
        self.assertGreater(len(types), 20)
        for file in types:
            stub = (folder / f"{file.stem}.pyi").read_text()
            hinted = set(re.findall(r"^    (\w+): ", stub, re.MULTILINE))
            slots = set(getattr(messages, file.stem).__slots__)
            self.assertLessEqual(slots, hinted, file.stem)

    def test_the_package_is_of_this_version(self) -> None:
        self.assertEqual(palpate.__version__, os.environ["PALPATE_VERSION"])


if __name__ == "__main__":
    unittest.main()
