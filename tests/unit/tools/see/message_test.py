"""The decoder of Drake's point cloud: layouts, colours, malformed bytes, the fingerprint."""
import struct
import unittest

import support

import numpy as np

from palpate_see.point_cloud_message import FINGERPRINT, MalformedCloud, decode_point_cloud

POINTS = np.random.default_rng(1).normal(size=(12, 3)).astype(np.float32)
RGB = np.random.default_rng(2).integers(0, 256, (12, 3)).tolist()

# Two points, published by PointCloudToLcm of Drake 1.51 at 1.5 s.
OF_DRAKE = bytes.fromhex(
    "17f2c128b5d25a95000000000016e36000000002430000000000000000020000000000000001000000040000000278000000000007000000"
    "01000000027900000000040700000001000000027a0000000008070000000100000004726762000000000c06000000010000000000000002"
    "000000100000000000000020000a000000000000000000000000000000000020"
    "0000003f000080be0000803fff0033000000803f000000400000404001020300")

CLOUD = (("utime", "int64_t", ()), ("frame_name", "string", ()), ("width", "int64_t", ()), ("height", "int64_t", ()),
         ("num_fields", "int32_t", ()), ("fields", None, ("num_fields",)), ("flags", "int64_t", ()),
         ("point_step", "int32_t", ()), ("row_step", "int64_t", ()), ("filler_size", "int16_t", ()),
         ("filler", "byte", ("filler_size",)), ("data_size", "int64_t", ()), ("data", "byte", ("data_size",)))  # fmt: skip
FIELD = (("name", "string", ()), ("byte_offset", "int32_t", ()), ("datatype", "int8_t", ()), ("count", "int32_t", ()))


def signed(value):
    value &= (1 << 64) - 1
    return value - (1 << 64) if value >> 63 else value


def lcm_hash(members):
    """Of a struct by its members, as LCM's documentation defines it."""

    def update(value, byte):
        return signed((value << 8) ^ (value >> 55)) + byte

    def update_text(value, text):
        value = update(value, len(text))
        for byte in text.encode():
            value = update(value, byte)
        return value

    value = 0x12345678
    for name, kind, dimensions in members:
        value = update_text(value, name)
        value = update_text(value, kind) if kind else value
        value = update(value, len(dimensions))
        for dimension in dimensions:  # of variable size
            value = update_text(update(value, 1), dimension)
    return value & ((1 << 64) - 1)


def rotated(value):
    value &= (1 << 64) - 1
    return ((value << 1) & ((1 << 64) - 1)) + (value >> 63)


class Layouts(unittest.TestCase):
    def test_points_of_either_order_with_rows_padding_and_filler(self):
        for words in ({}, {"big_endian": True}, {"height": 3, "padding": 5}, {"filler": b"123"}, {"padding": 4, "rgb": RGB}):
            cloud = decode_point_cloud(support.encoded_cloud(POINTS, utime=77, **words))
            self.assertEqual(cloud.utime, 77)
            np.testing.assert_array_equal(cloud.points, POINTS, err_msg=str(words))

    def test_colours_are_red_green_blue_bytes(self):
        for big_endian in (False, True):
            cloud = decode_point_cloud(support.encoded_cloud(POINTS, rgb=RGB, big_endian=big_endian))
            np.testing.assert_allclose(cloud.colours, np.array(RGB) / 255)
        self.assertIsNone(decode_point_cloud(support.encoded_cloud(POINTS)).colours)

    def test_what_drake_publishes(self):
        cloud = decode_point_cloud(OF_DRAKE)
        self.assertEqual(cloud.utime, 1_500_000)
        np.testing.assert_array_equal(cloud.points, [[0.5, -0.25, 1], [1, 2, 3]])
        np.testing.assert_allclose(cloud.colours, np.array([[255, 0, 51], [1, 2, 3]]) / 255)

    def test_an_empty_cloud(self):
        self.assertEqual(decode_point_cloud(support.encoded_cloud(np.zeros((0, 3)))).points.shape, (0, 3))

    def test_the_fingerprint_is_that_of_the_documented_members(self):
        # LCM adds the hashes of the members' structs, and rotates each sum by one bit.
        self.assertEqual(FINGERPRINT, struct.pack(">Q", rotated(lcm_hash(CLOUD) + rotated(lcm_hash(FIELD)))))


class Malformed(unittest.TestCase):
    def refused(self, data, *parts):
        with self.assertRaises(MalformedCloud) as caught:
            decode_point_cloud(data)
        for part in parts:
            self.assertIn(part, str(caught.exception))

    def test_every_truncation_is_refused(self):
        data = support.encoded_cloud(POINTS, rgb=RGB, filler=b"12")
        for size in range(len(data)):
            self.refused(data[:size])

    def test_another_type(self):
        self.refused(bytes(8) + support.encoded_cloud(POINTS)[8:], "fingerprint", FINGERPRINT.hex())

    def test_any_changed_byte_gives_a_cloud_or_an_error(self):
        data = bytearray(support.encoded_cloud(POINTS, rgb=RGB, height=2))
        for place in range(8, len(data)):
            for value in (0, 127, 255):
                changed = bytes(data[:place]) + bytes([value]) + bytes(data[place + 1 :])
                try:
                    decode_point_cloud(changed)
                except MalformedCloud:
                    pass

    def test_fields_beyond_the_point_and_absent_ones(self):
        def of(*fields):
            return support.encoded_cloud(POINTS, fields=fields)

        self.refused(of(("x", 0, 7), ("y", 4, 7), ("w", 8, 7)), "x, y, w", "z are needed")
        self.refused(of(("x", 0, 7), ("y", 4, 7), ("z", 10, 7)), "field z: 4 bytes at 10 of 12")
        self.refused(of(("x", 0, 9), ("y", 4, 7), ("z", 8, 7)), "datatype 9", "1 to 8")


if __name__ == "__main__":
    unittest.main(verbosity=2)
