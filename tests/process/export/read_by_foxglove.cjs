// What the libraries that Foxglove's application reads MCAP by find in a file, as JSON. Ends with 77
// where they are not installed (npm install @mcap/core @mcap/support @foxglove/schemas ajv; NODE_PATH
// names the folder node_modules).
//
// usage: read_by_foxglove.cjs FILE.mcap
const {readFile} = require('fs/promises');

let libraries;
try {
  libraries = {...require('@mcap/core'), ...require('@mcap/support'),
    known: require('@foxglove/schemas/jsonschema'), Ajv: require('ajv')};
} catch (error) {
  console.error(`skipped: ${error.message.split('\n')[0]}`);
  process.exit(77);
}

// Of the message encodings, those of schemas that the application takes beside them.
const KNOWN = {json: ['jsonschema'], ros1: ['ros1msg'], cdr: ['ros2msg', 'ros2idl', 'omgidl'], protobuf: ['protobuf'], flatbuffer: ['flatbuffer']};

async function main(path) {
  const {McapIndexedReader, loadDecompressHandlers, known, Ajv} = libraries;
  const bytes = await readFile(path);
  const readable = {size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size)))};
  const reader = await McapIndexedReader.Initialize({readable, decompressHandlers: await loadDecompressHandlers()});
  const ajv = new (Ajv.default || Ajv)({strict: false, allErrors: true, logger: false});
  const channels = {}, problems = [];
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    if (!schema) { problems.push(`${channel.topic}: no schema`); continue; }
    if (!(KNOWN[channel.messageEncoding] || []).includes(schema.encoding))
      problems.push(`${channel.topic}: ${channel.messageEncoding} with ${schema.encoding}`);
    const own = JSON.parse(new TextDecoder().decode(schema.data));
    if (own.type !== 'object') problems.push(`${channel.topic}: its schema is of a ${own.type}`);
    const validators = [ajv.compile({...own, $schema: undefined})];
    if (schema.name.startsWith('foxglove.')) {
      const theirs = Object.values(known).find((k) => k && k.title === schema.name);
      if (!theirs) problems.push(`${schema.name} is not among Foxglove's`);
      else validators.push(ajv.compile({...theirs, $schema: undefined, $comment: undefined}));
    }
    channels[channel.id] = {topic: channel.topic, schema: schema.name, messages: 0, validators};
  }
  let last = -1n;
  for await (const message of reader.readMessages()) {
    if (message.logTime < last) problems.push('messages are not in the order of their times');
    last = message.logTime;
    const channel = channels[message.channelId];
    ++channel.messages;
    const data = JSON.parse(new TextDecoder().decode(message.data));
    for (const valid of channel.validators)
      if (!valid(data) && problems.length < 20)
        problems.push(`${channel.topic}: ${ajv.errorsText(valid.errors)}`);
  }
  for (const [id, count] of reader.statistics.channelMessageCounts)
    if (Number(count) !== channels[id].messages) problems.push(`${channels[id].topic}: ${count} in the statistics, ${channels[id].messages} found`);
  console.log(JSON.stringify({problems, channels: Object.fromEntries(
      Object.values(channels).map(({topic, schema, messages}) => [topic, {schema, messages}]))}));
}

main(process.argv[2]).catch((error) => { console.error(error); process.exit(1); });
