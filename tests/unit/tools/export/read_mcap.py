"""Reads an MCAP file as specified, trusting nothing, and prints its contents as JSON.

usage: read_mcap.py FILE

Implements the file format from the specification alone (mcap.dev/spec), independently of the
writer. Every violation ends with exit code 1: magic, lengths, CRCs of chunks, data section and
summary, indices that do not lead to the named messages, wrong statistics, misplaced records,
messages that are not JSON or do not match their schema.
"""
import collections
import json
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 11, 12, 13, 14, 15


class Broken(Exception):
    pass


def check(holds, what):
    if not holds:
        raise Broken(what)


class Fields:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        check(self.at + count <= len(self.data), "a record ends within a field")
        self.at += count
        return self.data[self.at - count:self.at]

    def number(self, size):
        return int.from_bytes(self.take(size), "little")

    def text(self):
        return self.take(self.number(4)).decode("utf-8")

    def texts(self):
        inner, result = Fields(self.take(self.number(4))), {}
        while inner.at < len(inner.data):
            key = inner.text()
            check(key not in result, "a map with the same key twice")
            result[key] = inner.text()
        return result

    def pairs(self, first, second):
        inner, result = Fields(self.take(self.number(4))), []
        while inner.at < len(inner.data):
            result.append((inner.number(first), inner.number(second)))
        return result

    def end(self):
        check(self.at == len(self.data), "a record is longer than its fields")


def records(data, at, end):
    while at < end:
        check(at + 9 <= end, "a record's head is cut")
        opcode, length = data[at], int.from_bytes(data[at + 1:at + 9], "little")
        check(at + 9 + length <= end, f"a record of opcode {opcode} reaches beyond its section")
        yield at, opcode, Fields(data[at + 9:at + 9 + length]), 9 + length
        at += 9 + length


def unpack(kind, data, size):
    if kind == "":
        return data
    if kind == "zstd":
        import zstandard
        return zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
    if kind == "lz4":
        import lz4.frame
        return lz4.frame.decompress(data)
    raise Broken(f"compression '{kind}'")


def fits(value, schema, where):
    kind = schema["type"]
    if value is None and kind in ("number", "integer"):
        return
    types = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool}
    check(isinstance(value, types[kind]) and (kind == "boolean" or not isinstance(value, bool)),
          f"{where} is no {kind}")
    if kind == "object":
        check(set(schema.get("required", [])) <= value.keys(), f"{where} lacks what is required")
        check(value.keys() <= schema["properties"].keys(), f"{where} has what the schema has not")
        for name, inner in value.items():
            fits(inner, schema["properties"][name], f"{where}.{name}")
    if kind == "array":
        check(schema["items"]["type"] != "array", f"{where}: Foxglove takes no arrays of arrays")
        for inner in value:
            fits(inner, schema["items"], where)


class Reader:
    def __init__(self, data):
        self.data = data
        self.schemas, self.channels, self.chunks, self.metadata = {}, {}, {}, {}
        self.counts, self.times, self.samples = collections.Counter(), [], {}
        self.indexed = self.messages = 0

    def definition(self, opcode, fields, seen):
        number = fields.number(2)
        if opcode == SCHEMA:
            check(number > 0, "schema 0")
            value = (fields.text(), fields.text(), json.loads(fields.text()))
            check(value[1] == "jsonschema", "a schema that is not JSON's")
            into = self.schemas
        else:
            value = (fields.number(2), fields.text(), fields.text(), fields.texts())
            check(value[0] in self.schemas, "a channel before its schema")
            check(value[2] == "json", "messages that are not JSON")
            into = self.channels
        fields.end()
        check(into.setdefault(number, value) == value, "a definition that changes")
        seen.add((opcode, number))

    def message(self, fields):
        channel, sequence = fields.number(2), fields.number(4)
        log_time, publish_time = fields.number(8), fields.number(8)
        check(channel in self.channels, "a message before its channel")
        value = json.loads(fields.data[fields.at:])
        schema, topic = self.schemas[self.channels[channel][0]], self.channels[channel][1]
        fits(value, schema[2], topic)
        self.counts[topic] += 1
        self.messages += 1
        self.times.append(log_time)
        self.samples[topic] = {"sequence": sequence, "log_time": log_time, "publish_time": publish_time,
                               "schema": schema[0], "data": value}
        return channel, log_time

    def chunk(self, at, fields, length, defined):
        first, last, size, crc = (fields.number(n) for n in (8, 8, 8, 4))
        kind = fields.text()
        inner = unpack(kind, fields.take(fields.number(8)), size)
        fields.end()
        check(len(inner) == size, "a chunk of another size than it says")
        check(zlib.crc32(inner) == crc, "a chunk with a wrong CRC")
        found = collections.defaultdict(list)
        for place, opcode, record, _ in records(inner, 0, len(inner)):
            if opcode == MESSAGE:
                channel, time = self.message(record)
                found[channel].append((time, place))
            else:
                check(opcode in (SCHEMA, CHANNEL), f"opcode {opcode} in a chunk")
                self.definition(opcode, record, defined)
        times = [time for entries in found.values() for time, _ in entries] or [0]
        check((min(times), max(times)) == (first, last), "a chunk with wrong times")
        self.chunks[at] = {"length": length, "first": first, "last": last, "kind": kind, "size": size,
                           "messages": found, "index": {}, "index_length": 0}
        return self.chunks[at]

    def data_section(self):
        check(self.data.startswith(MAGIC) and self.data.endswith(MAGIC), "no magic")
        footer_at = len(self.data) - len(MAGIC) - 29
        at, opcode, footer, _ = next(records(self.data, footer_at, len(self.data) - len(MAGIC)))
        check(opcode == FOOTER, "no footer")
        self.summary, self.offsets, summary_crc = footer.number(8), footer.number(8), footer.number(4)
        check(zlib.crc32(self.data[self.summary:footer_at + 25]) == summary_crc, "a summary with a wrong CRC")
        self.footer = footer_at
        defined, last_chunk, ended, is_first = set(), None, False, True
        for at, opcode, fields, length in records(self.data, len(MAGIC), self.summary):
            check(not ended, "records after the end of data")
            check(is_first == (opcode == HEADER), "the header is not the first record")
            is_first = False
            if opcode == HEADER:
                fields.text(), fields.text()
            elif opcode == CHUNK:
                last_chunk = self.chunk(at, fields, length, defined)
            elif opcode == MESSAGE_INDEX:
                channel, entries = fields.number(2), fields.pairs(8, 8)
                check(sorted(entries) == sorted(last_chunk["messages"][channel]), "an index with a wrong offset")
                check(entries == sorted(entries, key=lambda e: e[0]), "an index out of order")
                last_chunk["index"][channel] = at
                last_chunk["index_length"] += length
                self.indexed += len(entries)
            elif opcode == METADATA:
                self.metadata[at] = (fields.text(), fields.texts(), length)
            elif opcode == DATA_END:
                check(zlib.crc32(self.data[:at]) == fields.number(4), "data with a wrong CRC")
                ended = True
            else:
                raise Broken(f"opcode {opcode} in the data section")
            fields.end()
        check(ended, "no end of data")
        check(self.indexed == self.messages, "messages without an index")
        return defined

    def summary_section(self, defined):
        groups, seen, indexed, order = {}, set(), set(), []
        for at, opcode, fields, length in records(self.data, self.summary, self.offsets):
            if not order or order[-1] != opcode:
                check(opcode not in order, "a summary that is not grouped")
                order.append(opcode)
                groups[opcode] = [at, 0]
            groups[opcode][1] += length
            if opcode in (SCHEMA, CHANNEL):
                self.definition(opcode, fields, seen)
            elif opcode == CHUNK_INDEX:
                first, last, start, size = (fields.number(8) for _ in range(4))
                places, index_length, kind = dict(fields.pairs(2, 8)), fields.number(8), fields.text()
                packed, unpacked = fields.number(8), fields.number(8)
                chunk = self.chunks.get(start)
                check(chunk is not None, "an index of no chunk")
                head = 9 + 8 + 8 + 8 + 4 + 4 + len(kind) + 8
                check((first, last, size, kind, unpacked, places, index_length, packed) ==
                      (chunk["first"], chunk["last"], chunk["length"], chunk["kind"], chunk["size"],
                       chunk["index"], chunk["index_length"], chunk["length"] - head), "a wrong chunk index")
                indexed.add(start)
            elif opcode == STATISTICS:
                reported = [fields.number(n) for n in (8, 2, 4, 4, 4, 4, 8, 8)]
                times = self.times or [0]
                check(reported == [self.messages, len(self.schemas), len(self.channels), 0, len(self.metadata),
                               len(self.chunks), min(times), max(times)], f"wrong statistics {reported}")
                counts = {self.channels[c][1]: n for c, n in fields.pairs(2, 8) if n}
                check(counts == dict(self.counts), "wrong counts of messages")
            elif opcode == METADATA_INDEX:
                start, size, name = fields.number(8), fields.number(8), fields.text()
                check(start in self.metadata, "an index of no metadata")
                check((name, size) == (self.metadata[start][0], self.metadata[start][2]), "a wrong metadata index")
            else:
                raise Broken(f"opcode {opcode} in the summary")
            fields.end()
        check(seen == defined, "a summary that lacks schemas or channels")
        check(indexed == self.chunks.keys(), "chunks without an index")
        for _, opcode, fields, _ in records(self.data, self.offsets, self.footer):
            check(opcode == SUMMARY_OFFSET, "a stranger among the summary's offsets")
            group, start, length = fields.number(1), fields.number(8), fields.number(8)
            check(groups.pop(group, None) == [start, length], "a wrong offset of the summary")
        check(not groups, "a group without an offset")


def main():
    try:
        reader = Reader(open(sys.argv[1], "rb").read())
        reader.summary_section(reader.data_section())
    except (Broken, struct.error, ValueError) as error:
        print(f"broken: {error}")
        return 1
    print(json.dumps({"counts": reader.counts, "chunks": len(reader.chunks), "last": reader.samples,
                      "schemas": sorted(schema[0] for schema in reader.schemas.values()),
                      "metadata": [entry[:2] for entry in reader.metadata.values()]}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
