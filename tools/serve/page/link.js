// The connection to the program: its token, reopening whenever it ends, and decoding of its messages.

const FIRST_WAIT = 300, LONGEST_WAIT = 2000;  // ms

/** The token from the address, from which it is then removed. */
export function takeToken() {
  const found = /[#&]token=([0-9a-f]+)/i.exec(location.hash);
  if (found) {
    sessionStorage.setItem('token', found[1]);
    history.replaceState(null, '', location.pathname + location.search);
  }
  return sessionStorage.getItem('token');
}

/** Header of a binary message, with its arrays by name as views into it. */
export function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  for (const {name, type, count} of head.arrays) {
    head[name] = type === 'f32' ? new Float32Array(buffer, at, count) : new Int32Array(buffer, at, count);
    at += 4 * count;
  }
  return head;
}

export class Link {
  /** `handlers`: functions by type of message, and `open`, `close`. */
  constructor(handlers) {
    this.handlers = handlers;
    this.wait = FIRST_WAIT;
    this.connections = 0;
    this.connect();
  }

  connect() {
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = this.socket = new WebSocket(`${scheme}//${location.host}/live`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
      ++this.connections;
      this.handlers.open();
    };
    socket.onmessage = ({data}) => {
      const message = typeof data === 'string' ? JSON.parse(data) : unpack(data);
      const handler = this.handlers[message.type];
      if (handler) handler(message);
    };
    socket.onclose = () => {
      this.handlers.close();
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }

  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
