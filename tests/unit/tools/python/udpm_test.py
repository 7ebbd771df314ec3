"""Framing, fragments and URLs of the Python transport."""

import random
import struct
import unittest

from palpate.udpm import (
    FRAGMENT_SIZE,
    LARGEST_DATAGRAM,
    Decoder,
    Packet,
    Url,
    encode_packet,
    parse_url,
)


class Urls(unittest.TestCase):
    def test_what_is_left_out_is_as_of_lcm(self) -> None:
        self.assertEqual(parse_url("udpm://"), Url("239.255.76.67", 7667, 0))
        self.assertEqual(parse_url("udpm://239.1.2.3"), Url("239.1.2.3", 7667, 0))
        self.assertEqual(
            parse_url("udpm://239.1.2.3:9?ttl=1&recv_buf_size=4096"), Url("239.1.2.3", 9, 1, 4096)
        )

    def test_what_is_wrong_is_named(self) -> None:
        for url, word in (
            ("tcpq://", "udpm"),
            ("udpm:/x", "udpm"),
            ("udpm://1.2.3:1", "IPv4"),
            ("udpm://127.0.0.1:7667", "multicast"),
            ("udpm://239.1.2.3:0", "port"),
            ("udpm://239.1.2.3:70000", "65535"),
            ("udpm://239.1.2.3:", "port"),
            ("udpm://239.1.2.3:1?ttl=256", "ttl"),
            ("udpm://239.1.2.3:1?ttl=-1", "ttl"),
            ("udpm://239.1.2.3:1?tll=1", "tll"),
        ):
            with self.assertRaisesRegex(ValueError, word, msg=url):
                parse_url(url)


class Framing(unittest.TestCase):
    def test_a_short_message_is_what_lcm_documents(self) -> None:
        (datagram,) = encode_packet("IMU", b"abc", 5)
        self.assertEqual(datagram, b"LC02" + struct.pack(">I", 5) + b"IMU\0abc")
        self.assertEqual(Decoder().take(datagram), Packet("IMU", b"abc"))

    def test_names_have_their_bounds(self) -> None:
        for name in ("", "A" * 64, "A\0B"):
            with self.assertRaises(ValueError):
                encode_packet(name, b"", 0)
        (datagram,) = encode_packet("A" * 63, b"", 0)
        self.assertEqual(Decoder().take(datagram), Packet("A" * 63, b""))

    def test_what_is_no_message_is_counted(self) -> None:
        decoder = Decoder()
        for datagram in (
            b"",
            b"LC02",
            b"LC02\0\0\0\1",
            b"LC02\0\0\0\1\0abc",
            b"LC02\0\0\0\1" + b"A" * 64 + b"\0",
            b"LC02\0\0\0\1ABC",
            b"LC02\0\0\0\1\xff\xfe\0",
            b"LC99\0\0\0\1ABC\0",
            b"LC03\0\0\0\1",
        ):
            self.assertIsNone(decoder.take(datagram), datagram)
        self.assertEqual(decoder.malformed, 9)

    def test_any_bytes_leave_it_alive(self) -> None:
        generator = random.Random(3)
        decoder = Decoder()
        good = encode_packet("SHAPE", bytes(200_000), 9) + encode_packet("IMU", bytes(50), 1)
        for _ in range(20_000):
            datagram = bytearray(generator.choice(good)[: generator.randint(0, 300)])
            for _ in range(generator.randint(0, 4)):
                if datagram:
                    datagram[generator.randrange(len(datagram))] = generator.randrange(256)
            decoder.take(bytes(datagram), generator.randrange(20))
        self.assertLessEqual(len(decoder._partial), Decoder.MOST_PARTIAL)


class Fragments(unittest.TestCase):
    def setUp(self) -> None:
        self.data = random.Random(1).randbytes(3 * FRAGMENT_SIZE + 17)
        self.parts = encode_packet("PICTURE", self.data, 77)

    def test_a_long_message_goes_in_parts_that_fit(self) -> None:
        self.assertEqual(len(self.parts), 4)
        self.assertLessEqual(max(map(len, self.parts)), LARGEST_DATAGRAM)

    def test_parts_in_any_order_make_it_whole(self) -> None:
        for seed in range(20):
            parts = list(self.parts)
            random.Random(seed).shuffle(parts)
            decoder = Decoder()
            taken = [decoder.take(part) for part in parts]
            self.assertEqual(taken[:-1], [None] * 3)
            self.assertEqual(taken[-1], Packet("PICTURE", self.data))

    def test_parts_of_two_senders_do_not_mix(self) -> None:
        decoder = Decoder()
        for part in self.parts[:-1]:
            self.assertIsNone(decoder.take(part, "a"))
        self.assertIsNone(decoder.take(self.parts[-1], "b"))
        self.assertEqual(decoder.take(self.parts[-1], "a"), Packet("PICTURE", self.data))

    def test_a_lost_part_is_no_message_and_others_go_on(self) -> None:
        decoder = Decoder()
        for part in self.parts[1:]:
            self.assertIsNone(decoder.take(part))
        following = encode_packet("PICTURE", self.data, 78)
        self.assertEqual([decoder.take(part) for part in following][-1].data, self.data)

    def test_overlapping_parts_are_refused(self) -> None:
        header = struct.Struct(">4sIIIHH")
        decoder = Decoder()
        first = header.pack(b"LC03", 1, 8, 0, 0, 2) + b"IMU\0" + b"abcd"
        second = header.pack(b"LC03", 1, 8, 2, 1, 2) + b"abcd"
        self.assertIsNone(decoder.take(first))
        self.assertIsNone(decoder.take(second))
        self.assertEqual(decoder.malformed, 1)

    def test_parts_that_overlap_do_not_pile_up(self) -> None:
        header = struct.Struct(">4sIIIHH")
        decoder = Decoder()
        for index in range(1, 1000):
            decoder.take(header.pack(b"LC03", 1, 60_000, 0, index, 2000) + bytes(60_000))
            self.assertLessEqual(decoder.held, 60_000)

    def test_promises_of_large_messages_take_no_endless_memory(self) -> None:
        header = struct.Struct(">4sIIIHH")
        decoder = Decoder()
        part = bytes(60_000)
        for number in range(200):
            decoder.take(header.pack(b"LC03", number, 64 << 20, 0, 1, 2) + part, number)
        self.assertLessEqual(decoder.held, Decoder.MOST_PARTIAL * len(part))
        decoder.MOST_BYTES = 1_000_000
        for number in range(1, 5):
            for index in range(1, 17):
                at = 60_000 * index
                datagram = header.pack(b"LC03", number, 64 << 20, at, index, 1000) + part
                self.assertIsNone(decoder.take(datagram, "a"))
        self.assertLessEqual(decoder.held, 1_000_000)


if __name__ == "__main__":
    unittest.main()
