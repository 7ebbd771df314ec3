"""Compares an MCAP file whose scenes are in Protobuf with one of the same run in JSON.

usage: read_protobuf.py JSON.mcap PROTOBUF.mcap

Both are read by the mcap package; messages in Protobuf by the descriptions in the file
(mcap-protobuf-support) and by the classes that Foxglove generates from its own schemas. Prints the
number of messages of each topic as JSON; ends with 77 without those packages.
"""

from __future__ import annotations

import collections
import importlib
import json
import sys
from typing import Any, Iterator

try:
    from google.protobuf.json_format import MessageToDict
    from google.protobuf.unknown_fields import UnknownFieldSet
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    importlib.import_module("foxglove_schemas_protobuf")
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/install-worlds installs what is needed")
    sys.exit(77)

TOPICS = ("/shape/estimate", "/shape/truth", "/flange", "/tf")
LINE_TYPES = ("LINE_STRIP", "LINE_LOOP", "LINE_LIST")


def same(path: str, ours: Any, theirs: Any) -> None:
    """Raises unless the JSON `ours` is the message `theirs`, in which default values are absent."""
    if isinstance(ours, dict) and set(ours) == {"sec", "nsec"}:
        return  # as text: compared by the generated classes
    if isinstance(ours, dict):
        for key, value in ours.items():
            if theirs is not None and key in theirs:
                same(f"{path}.{key}", value, theirs[key])
            elif isinstance(value, dict):
                same(f"{path}.{key}", value, {})
            elif value not in (0, False, "", []):
                raise AssertionError(f"{path}.{key}: {value} is missing")
    elif isinstance(ours, list):
        if len(ours) != len(theirs):
            raise AssertionError(f"{path}: {len(theirs)} in place of {len(ours)}")
        for index, (one, other) in enumerate(zip(ours, theirs)):
            same(f"{path}[{index}]", one, other)
    elif ours != (LINE_TYPES.index(theirs) if theirs in LINE_TYPES else theirs):
        raise AssertionError(f"{path}: {theirs} in place of {ours}")


def messages(path: str) -> Iterator[Any]:
    with open(path, "rb") as file:
        yield from make_reader(file).iter_messages(topics=TOPICS)


def main() -> None:
    in_json, in_protobuf = sys.argv[1:3]
    count: collections.Counter[str] = collections.Counter()
    decoders = DecoderFactory()
    for (_, channel, message), (schema, other, encoded) in zip(messages(in_json), messages(in_protobuf), strict=True):
        assert (channel.topic, message.log_time) == (other.topic, encoded.log_time)
        assert (other.message_encoding, schema.encoding) == ("protobuf", "protobuf")
        decoder = decoders.decoder_for("protobuf", schema)
        assert decoder is not None
        decoded = decoder(encoded.data)
        same(channel.topic, json.loads(message.data), MessageToDict(decoded, preserving_proto_field_name=True))
        name = schema.name.removeprefix("foxglove.")
        generated = getattr(importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name).FromString(encoded.data)
        assert len(UnknownFieldSet(generated)) == 0
        assert MessageToDict(generated) == MessageToDict(decoded)
        stamp = generated.entities[0].timestamp if name == "SceneUpdate" else generated.timestamp
        assert stamp.ToNanoseconds() == message.log_time, channel.topic
        count[channel.topic] += 1
    print(json.dumps(count))


if __name__ == "__main__":
    main()
