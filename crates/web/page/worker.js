// Draws in a worker of the browser: messages as those of `shiftvox view`, and files that were dropped on the page.
"use strict";

const program = WebAssembly.instantiateStreaming(fetch("shiftvox.wasm"), { page: { now: () => performance.now() } });

onmessage = async ({ data }) => {
  let shiftvox, length;
  const put = (bytes) => {
    // Memory may grow, which makes a new buffer.
    const at = shiftvox.room(bytes.length);
    new Uint8Array(shiftvox.memory.buffer, at, bytes.length).set(bytes);
  };
  try {
    shiftvox = (await program).instance.exports;
    if (typeof data === "string") {
      put(new TextEncoder().encode(data));
      length = shiftvox.ask();
    } else {
      const name = new TextEncoder().encode(data.name), input = new Uint8Array(name.length + data.bytes.byteLength);
      input.set(name);
      input.set(new Uint8Array(data.bytes), name.length);
      put(input);
      length = shiftvox.open(name.length);
    }
  } catch (error) {
    // No program, no memory left, or a fault of the program: this worker cannot go on.
    return close(postMessage(String(error)));
  }
  const answer = new Uint8Array(shiftvox.memory.buffer, shiftvox.answer(), length).slice().buffer;
  postMessage(answer, [answer]);
};
