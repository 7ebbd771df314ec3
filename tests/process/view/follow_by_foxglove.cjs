// What Foxglove's own client of its WebSocket protocol receives from a server, as JSON: channels with
// their numbers of messages, and problems, among them messages that contradict their schemas. Reads
// for SECONDS after each TOPIC has had a message, for which it waits a minute. Ends with 77 where the
// client is not installed (NODE_PATH names the folder node_modules).
//
// usage: follow_by_foxglove.cjs URL SECONDS TOPIC...
const {load, checksOf} = require('../../support/foxglove/readers.cjs');

const {FoxgloveClient, WebSocket} = load('@foxglove/ws-protocol', 'ws');

function main([url, seconds, ...topics]) {
  const problems = [], channels = {}, subscribed = {}, missing = new Set(topics);
  let server = null;
  const finish = () => {
    console.log(JSON.stringify({server, problems, channels}));
    process.exit(0);
  };
  const client = new FoxgloveClient({ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL])});
  client.on('serverInfo', (info) => { server = info.name; });
  client.on('error', (error) => problems.push(String(error.message || error)));
  client.on('status', (status) => problems.push(status.message));
  client.on('advertise', (advertised) => {
    for (const {id, topic, encoding, schemaName, schema, schemaEncoding} of advertised) {
      if (encoding !== 'json' || schemaEncoding !== 'jsonschema') problems.push(`${topic}: ${encoding} with ${schemaEncoding}`);
      channels[topic] = {schema: schemaName, messages: 0, age: null, last: null};
      subscribed[client.subscribe(id)] = {topic, checks: checksOf(schemaName, schema, problems)};
    }
  });
  client.on('message', ({subscriptionId, timestamp, data}) => {
    const {topic, checks} = subscribed[subscriptionId];
    const message = JSON.parse(new TextDecoder().decode(new Uint8Array(data.buffer, data.byteOffset, data.byteLength)));
    for (const check of checks) {
      const problem = check(message);
      if (problem && problems.length < 20) problems.push(`${topic}: ${problem}`);
    }
    ++channels[topic].messages;
    channels[topic].age = Date.now() / 1000 - Number(timestamp) / 1e9;
    if (topic === 'FT_WRENCH') channels[topic].last = message;
    if (missing.delete(topic) && missing.size === 0) setTimeout(finish, 1000 * seconds);
  });
  setTimeout(finish, 60000);
}

main(process.argv.slice(2));
