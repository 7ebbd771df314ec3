// What the libraries that Foxglove's application reads MCAP by find in a file, as JSON. Ends with 77
// where they are not installed (NODE_PATH names the folder node_modules).
//
// usage: read_by_foxglove.cjs FILE.mcap
const {readFile} = require('fs/promises');
const {load, checksOf} = require('../../support/foxglove/readers.cjs');

const {McapIndexedReader, loadDecompressHandlers} = load('@mcap/core', '@mcap/support');

// Of the message encodings, those of schemas that the application takes beside them.
const KNOWN = {json: ['jsonschema'], ros1: ['ros1msg'], cdr: ['ros2msg', 'ros2idl', 'omgidl'], protobuf: ['protobuf'], flatbuffer: ['flatbuffer']};

async function main(path) {
  const bytes = await readFile(path);
  const readable = {size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size)))};
  const reader = await McapIndexedReader.Initialize({readable, decompressHandlers: await loadDecompressHandlers()});
  const channels = {}, problems = [];
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    if (!schema) { problems.push(`${channel.topic}: no schema`); continue; }
    if (!(KNOWN[channel.messageEncoding] || []).includes(schema.encoding))
      problems.push(`${channel.topic}: ${channel.messageEncoding} with ${schema.encoding}`);
    const checks = checksOf(schema.name, new TextDecoder().decode(schema.data), problems);
    channels[channel.id] = {topic: channel.topic, schema: schema.name, messages: 0, checks};
  }
  let last = -1n;
  for await (const message of reader.readMessages()) {
    if (message.logTime < last) problems.push('messages are not in the order of their times');
    last = message.logTime;
    const channel = channels[message.channelId];
    ++channel.messages;
    const data = JSON.parse(new TextDecoder().decode(message.data));
    for (const check of channel.checks) {
      const problem = check(data);
      if (problem && problems.length < 20) problems.push(`${channel.topic}: ${problem}`);
    }
  }
  for (const [id, count] of reader.statistics.channelMessageCounts)
    if (Number(count) !== channels[id].messages) problems.push(`${channels[id].topic}: ${count} in the statistics, ${channels[id].messages} found`);
  console.log(JSON.stringify({problems, channels: Object.fromEntries(
      Object.values(channels).map(({topic, schema, messages}) => [topic, {schema, messages}]))}));
}

main(process.argv[2]).catch((error) => { console.error(error); process.exit(1); });
