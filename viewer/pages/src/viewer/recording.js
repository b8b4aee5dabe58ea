// A map that is inside the page (kinloop share): the messages that a connection would bring, unpacked from a gzip
// archive.

import { decode, partsOf } from './messages.js';

export class Recording {
  /** `base64`: the archive. Calls onMessage and onChange like a Connection, onProblem(text) if it cannot be read. */
  constructor(base64, { onMessage, onChange, onProblem }) {
    this.run = '';
    this.bytes = 0;
    this.play(base64, onMessage, onChange).catch((error) => onProblem(`The map in this page cannot be read: ${error.message}`));
  }

  async play(base64, onMessage, onChange) {
    const messages = await unpacked(base64);
    this.bytes = messages.byteLength;
    onChange(true);
    for (const part of partsOf(messages)) {
      const message = decode(part);
      if (!message) continue;
      if (message.kind === 'hello') this.run = message.body.run;
      onMessage(message);
    }
  }

  /** Nobody hears commands. */
  get mayCommand() {
    return false;
  }

  send() {}
}

async function unpacked(base64) {
  if (!window.DecompressionStream) throw new Error('this browser is too old; use Chrome 80, Firefox 113, Safari 16.4 or newer');
  const text = atob(base64);
  const archive = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) archive[i] = text.charCodeAt(i);
  const stream = new Blob([archive]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}
