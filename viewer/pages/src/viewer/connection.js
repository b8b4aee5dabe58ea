// The connection to kinloop. It remembers what it has received, so that after an interruption only the rest is
// sent, also of a part in the middle.

import { addPiece, bodyBytesOf, decode } from './messages.js';

const POLICY_ERROR = 1008; // the close code of a command that is refused
const SHORTEST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

export class Connection {
  /**
   * Calls onMessage({ kind, index, body }) for every part, onChange(connected) on connection and disconnection,
   * onRefused(reason) if a command is refused.
   */
  constructor({ onMessage, onChange, onRefused }) {
    Object.assign(this, { onMessage, onChange, onRefused });
    this.run = '';
    this.version = 0;
    this.part = undefined; // the one that is coming
    this.bytes = 0;
    this.waitMs = SHORTEST_WAIT_MS;
    this.open();
  }

  open() {
    const query = new URLSearchParams(location.search);
    query.set('run', this.run);
    query.set('since', this.version);
    query.set('part', this.part?.version ?? 0);
    query.set('bytes', bodyBytesOf(this.part));
    this.socket = new WebSocket(`ws://${location.host}/feed?${query}`);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => {
      this.waitMs = SHORTEST_WAIT_MS;
      this.onChange(true);
    };
    this.socket.onmessage = ({ data }) => this.take(data);
    this.socket.onclose = ({ code, reason }) => {
      if (code === POLICY_ERROR) this.onRefused(reason);
      this.openLater();
    };
  }

  take(data) {
    this.bytes += data.byteLength;
    this.part = addPiece(this.part, data);
    if (!this.part.complete) return;
    const message = decode(this.part.buffer);
    this.part = undefined;
    if (!message) return;
    if (message.kind === 'hello') this.run = message.body.run;
    this.version = message.version;
    this.onMessage(message);
  }

  openLater() {
    this.onChange(false);
    setTimeout(() => this.open(), this.waitMs);
    this.waitMs = Math.min(2 * this.waitMs, LONGEST_WAIT_MS);
  }

  /** Whether kinloop takes commands of this page. */
  get mayCommand() {
    return new URLSearchParams(location.search).has('token');
  }

  /** Sends a command: 'pause', 'resume', 'step', 'save'; 'withdraw' with { loop: 'STAMP,STAMP' }. */
  send(command, what = {}) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ command, ...what }));
  }
}
