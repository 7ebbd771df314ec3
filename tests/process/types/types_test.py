#!/usr/bin/env python3
"""Messages of any LCM type, as palpate's programs decode them by .lcm descriptions and as LCM's own Python code does.

usage: types_test.py BINARIES SOURCE [--messages N] [--drake] [UNITTEST-OPTIONS]

The types are random ones, drawn here, whose Python code lcm-gen writes; with --drake those of Drake's Python package,
whose descriptions are written from what its modules say of themselves. N: random messages of each type (200).
"""
import argparse
import base64
import csv
import importlib
import json
import os
import pathlib
import random
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from random_types import Draw, Type, values_of

INTEGERS = {"int8_t": "b", "int16_t": "h", "int32_t": "i", "int64_t": "q", "byte": "B"}
SOURCE, BINARIES = None, None


def write_log(path, events):
    """`events`: channel and data, one millisecond apart."""
    with open(path, "wb") as log:
        for number, (channel, data) in enumerate(events):
            log.write(struct.pack(">IqqII", 0xEDA1DA01, number, 1_700_000_000_000_000 + 1000 * number, len(channel),
                                  len(data)) + channel.encode() + data)


def run(program, *words, code=0):
    done = subprocess.run([BINARIES / program, *map(str, words)], capture_output=True, text=True, timeout=600)
    if done.returncode != code:
        raise AssertionError(f"{program} ended with {done.returncode}:\n{done.stderr[-2000:]}")
    return done


def number_keeping(text):
    """JSON, where Python would take -0 as an integer without a sign."""
    return json.loads(text, parse_int=lambda digits: -0.0 if digits == "-0" else int(digits))


def messages_of_mcap(path):
    """Topic, time in ms since the first event of write_log, and JSON value of each message, without compression."""
    data = path.read_bytes()
    topics = {}

    def records(at, end):
        while at < end:
            length = int.from_bytes(data[at + 1:at + 9], "little")
            yield data[at], at + 9, at + 9 + length
            at += 9 + length

    def text(at):
        length = int.from_bytes(data[at:at + 4], "little")
        return data[at + 4:at + 4 + length].decode(), at + 4 + length

    for kind, at, end in records(8, len(data) - 8):
        if kind != 6:  # chunk: times, size, CRC, compression, records
            continue
        compression, inner = text(at + 28)
        assert compression == ""
        for record, begin, stop in records(inner + 8, end):
            if record == 4:
                topics[data[begin:begin + 2]] = text(begin + 4)[0]
            elif record == 5:
                time_ns = int.from_bytes(data[begin + 6:begin + 14], "little")
                yield topics[data[begin:begin + 2]], time_ns // 1_000_000 - 1_700_000_000_000, number_keeping(data[begin + 22:stop])


def is_equal(kind, found, expected):
    """A value of JSON, and LCM's own; null stands for what JSON has no number for."""
    if kind in ("float", "double"):
        if found is None:
            return expected != expected or expected in (float("inf"), float("-inf"))
        code = ">f" if kind == "float" else ">d"
        return struct.pack(code, found) == struct.pack(code, expected)
    if kind == "bytes":
        return base64.b64decode(found) == bytes(expected)
    if kind == "boolean":
        return found is bool(expected)
    return type(found) is type(expected) and found == expected


def flat(value, path=""):
    """Paths and values of JSON."""
    if isinstance(value, list):
        for i, item in enumerate(value):
            yield from flat(item["values"] if isinstance(item, dict) and list(item) == ["values"] else item, f"{path}[{i}]")
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from flat(item, f"{path}.{name}" if path else name)
    else:
        yield path, value


class Cases(unittest.TestCase):
    messages, drake = 200, False

    @classmethod
    def setUpClass(cls):
        cls.random = random.Random(5)
        cls.scratch = tempfile.TemporaryDirectory(prefix="palpate_types_")
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.descriptions = cls.folder / "lcm"
        if cls.drake:
            cls.types = Type.of_package(importlib.import_module("drake"))
            Type.write(cls.types, cls.descriptions)
        else:
            cls.types = Draw(cls.random).types(cls.descriptions)
            subprocess.run(["lcm-gen", "-p", "--ppath", cls.folder / "python", *cls.descriptions.rglob("*.lcm")], check=True,
                           stdout=subprocess.DEVNULL)
            sys.path.insert(0, str(cls.folder / "python"))
            for kind in cls.types.values():
                kind.load()
        # Some types have no message of their own: those with the members of another one.
        cls.sent = {}
        for name, kind in sorted(cls.types.items()):
            cls.sent.setdefault(kind.python._get_packed_fingerprint(), name)
        cls.sent = sorted(cls.sent.values())

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def draw(self, name):
        return self.types[name].draw(self.types, self.random).encode()

    def compare(self, name, found, data):
        decoded = self.types[name].python.decode(data)
        expected = list(values_of(self.types, name, decoded))
        found = [(path, value) for path, value in flat(found)]
        self.assertEqual([path for path, _ in found], [path for path, _, _ in expected], name)
        for (path, value), (_, kind, own) in zip(found, expected):
            self.assertTrue(is_equal(kind, value, own), f"{name}: {path} ({kind}): {value!r}, but lcm has {own!r}")
        return len(found)

    def test_mcap_has_the_values_that_lcm_decodes(self):
        values = 0
        for name in self.sent:
            log, mcap = self.folder / "run.log", self.folder / "run.mcap"
            events = [(f"CHANNEL_{i % 2}", self.draw(name)) for i in range(self.messages)]
            write_log(log, events)
            run("palpate-export", "mcap", log, "--types", self.descriptions, "--compression", "none", "--quiet", "-o", mcap)
            seen = 0
            for topic, number, value in messages_of_mcap(mcap):
                self.assertEqual(topic, events[number][0])
                values += self.compare(name, value, events[number][1])
                seen += 1
            self.assertEqual(seen, len(events), name)
        print(f"{len(self.sent)} types, {self.messages} messages of each, {values} equal values")

    def test_csv_has_them_too(self):
        log, out = self.folder / "run.log", self.folder / "out"
        events = [(f"CHANNEL_{i:03d}", self.draw(name)) for i, name in enumerate(self.sent) for _ in range(5)]
        write_log(log, events)
        run("palpate-export", "csv", log, "--types", self.descriptions, "--quiet", "-o", out)
        csv.field_size_limit(1 << 24)
        for i, name in enumerate(self.sent):
            with open(out / f"CHANNEL_{i:03d}.csv", newline="") as file:
                rows = list(csv.DictReader(file))
            for row, (_, data) in zip(rows, events[5 * i:5 * i + 5]):
                for path, kind, own in values_of(self.types, name, self.types[name].python.decode(data)):
                    if kind == "bytes" and path not in row:
                        self.assertEqual(int(row[path + ".length"]), len(own))
                    elif kind == "bytes":
                        self.assertEqual(bytes.fromhex(row[path]), bytes(own))
                    elif kind in ("float", "double"):
                        code = ">f" if kind == "float" else ">d"
                        found = float(row[path])
                        self.assertTrue(found != found and own != own or struct.pack(code, found) == struct.pack(code, own))
                    elif kind == "string":
                        self.assertEqual(row[path].replace("\r\n", "\n"), own.replace("\r\n", "\n"))
                    else:
                        self.assertEqual(int(row[path]), int(own))

    def test_damaged_messages_are_counted(self):
        accepted = rejected = 0
        for name in self.sent[:10]:
            events = []
            for _ in range(self.messages):
                data = bytearray(self.draw(name))
                for _ in range(self.random.randint(1, 4)):
                    if len(data) > 8:
                        data[self.random.randrange(8, len(data))] = self.random.choice([0, 1, 0x7f, 0x80, 0xff])
                cut = self.random.random()
                data = data[:self.random.randint(8, len(data))] if cut < 0.2 else data + b"\0" if cut < 0.3 else data
                events.append(("DAMAGED", bytes(data)))
            log, mcap, info = self.folder / "run.log", self.folder / "run.mcap", self.folder / "info.json"
            write_log(log, events)
            run("palpate-export", "info", log, "--types", self.descriptions, "--quiet", "--json", info)
            (channel,) = json.loads(info.read_text())["channels"]
            self.assertEqual(channel["messages"], len(events))
            done = run("palpate-export", "mcap", log, "--types", self.descriptions, "--compression", "none", "--quiet", "-o", mcap)
            good = list(messages_of_mcap(mcap))
            self.assertEqual(len(good) + channel["broken"], len(events), name)
            if channel["broken"]:
                self.assertIn(f"{channel['broken']} broken messages on DAMAGED", done.stderr)
            for _, number, value in good:
                if b"\xef\xbf\xbd" in json.dumps(value).encode() or "?" in json.dumps(value):
                    continue  # text that is no UTF-8 any more
                self.compare(name, value, events[number][1])
            accepted, rejected = accepted + len(good), rejected + channel["broken"]
        print(f"{rejected} damaged messages counted, {accepted} still whole")
        self.assertGreater(rejected, 50)

    def test_top_and_record_know_them(self):
        own = self.own_message()
        chosen = {f"TYPE_{i}": name for i, name in enumerate(self.sent[:6])}
        messages = {channel: self.draw(name) for channel, name in chosen.items()}
        number = os.getpid() % 20000
        group, port = f"239.255.{90 + number // 250}.{1 + number % 250}", 11000 + number
        urls = ["--url", f"control=udpm://{group}:{port}?ttl=0", "--url", f"housekeeping=udpm://{group}:{port + 1}?ttl=0",
                "--url", f"pictures=udpm://{group}:{port + 2}?ttl=0"]
        shown = [word for channel in [*chosen, "OWN"] for word in ("--show", channel)]
        out = self.folder / "top.json"
        top = subprocess.Popen([BINARIES / "palpate-top", *urls, "--types", self.descriptions, *shown, "--once", "--json", out,
                                "--seconds", "4"], stdout=subprocess.PIPE, text=True)
        record = subprocess.Popen([BINARIES / "palpate-record", *urls, "--types", self.descriptions, "--only", "control",
                                   "--known-only", "--seconds", "4", "--min-free-mb", "0", "-q", "--json",
                                   self.folder / "record.json", self.folder / "record.lcmlog"])
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        while top.poll() is None or record.poll() is None:
            for channel, data in [*messages.items(), ("OWN", own), ("TYPE_0", messages["TYPE_0"] + b"\0"),
                                  ("TYPE_0", messages["TYPE_0"]), ("STRANGE", b"12345678")]:
                sender.sendto(b"LC02\0\0\0\0" + channel.encode() + b"\0" + data, (group, port))
            time.sleep(0.05)
        sender.close()
        text = top.communicate()[0]
        self.assertEqual((top.returncode, record.wait()), (0, 0))
        found = json.loads(out.read_text())
        rows = {row["channel"]: row for row in found["channels"]}
        values = {entry["channel"]: entry for entry in found["values"]}
        for channel, name in chosen.items():
            self.assertEqual(rows[channel]["type"], name)
            self.assertIn(name, text)
            self.assertEqual(values[channel]["type"], name)
            fields = values[channel]["fields"]
            for path, kind, own_value in values_of(self.types, name, self.types[name].python.decode(messages[channel])):
                if kind in INTEGERS or kind == "boolean":
                    self.assertEqual(fields[path], int(own_value))
                elif kind in ("float", "double") and own_value == own_value and abs(own_value) != float("inf"):
                    self.assertTrue(is_equal(kind, fields[path] + 0.0, own_value + 0.0), path)  # JSON's 0 has no sign
        self.assertGreater(rows["TYPE_0"]["misfits"], 5)
        self.assertEqual(rows["TYPE_1"]["misfits"], 0)
        self.assertFalse(rows["STRANGE"]["known"])
        self.assertEqual(values["OWN"]["fields"]["wrench[2]"], -2.5)
        summary = json.loads((self.folder / "record.json").read_text())
        recorded = {row["channel"]: row for row in summary["channels"]}
        self.assertEqual({channel: recorded[channel]["type"] for channel in chosen}, chosen)
        self.assertGreater(recorded["TYPE_0"]["misfits"], 5)
        self.assertEqual(recorded["STRANGE"]["messages"], 0)  # left out by --known-only

    @staticmethod
    def own_message():
        """FT_WRENCH, whose fingerprint the info of a log with a header of zeros would not know."""
        text = (SOURCE / "lcmtypes/ft_wrench_t.lcm").read_text()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            (path / "ft_wrench_t.lcm").write_text(text)
            subprocess.run(["lcm-gen", "-p", "--ppath", path, path / "ft_wrench_t.lcm"], check=True, stdout=subprocess.DEVNULL)
            sys.path.insert(0, folder)
            message = importlib.import_module("palpate.ft_wrench_t").ft_wrench_t()
            sys.path.remove(folder)
        message.utime, message.session, message.wrench = 1, 3, [0.5, 0, -2.5, 0, 0, 0]
        return message.encode()

    def test_wrong_descriptions_are_one_clear_error(self):
        wrong = self.folder / "wrong"
        wrong.mkdir(exist_ok=True)
        (wrong / "a.lcm").write_text("package p;\nstruct a {\n  double x[n];\n}\n")
        write_log(self.folder / "one.log", [("A", b"12345678")])
        done = run("palpate-export", "info", self.folder / "one.log", "--types", wrong, "--quiet", code=1)
        self.assertIn(f"{wrong}/a.lcm:3: the array's size 'n' is neither", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_plot_and_fields_name_nested_values(self):
        name = next(name for name in self.sent if any(
            kind == "double" and "." in path for path, kind, _ in
            values_of(self.types, name, self.types[name].draw(self.types, random.Random(1)))))
        write_log(self.folder / "run.log", [("NESTED", self.draw(name)) for _ in range(20)])
        text = run("palpate-export", "info", self.folder / "run.log", "--types", self.descriptions, "--fields", "--quiet").stdout
        self.assertIn(f"NESTED  ({name}", text)
        done = run("palpate-export", "plot", self.folder / "run.log", "--types", self.descriptions, "--quiet", "--field",
                   "NESTED.none", "-o", self.folder / "a.svg", code=1)
        self.assertIn("has this name", done.stderr)


def main():
    global SOURCE, BINARIES
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--messages", type=int, default=200)
    parser.add_argument("--drake", action="store_true")
    options, rest = parser.parse_known_args()
    BINARIES, SOURCE = options.binaries.resolve(), options.source.resolve()
    Cases.messages, Cases.drake = options.messages, options.drake
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
