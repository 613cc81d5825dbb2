// Draws in a worker of the browser: messages as those of `shiftvox view`, and files that were dropped on the page.
"use strict";

const program = WebAssembly.instantiateStreaming(fetch("shiftvox.wasm"), { page: { now: () => performance.now() } });

onmessage = async ({ data }) => {
  const { exports: shiftvox } = (await program).instance;
  const put = (bytes) => new Uint8Array(shiftvox.memory.buffer, shiftvox.room(bytes.length), bytes.length).set(bytes);
  let length;
  try {
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
    // A panic, or memory that is refused: the instance cannot go on.
    return close(postMessage(String(error)));
  }
  const answer = new Uint8Array(shiftvox.memory.buffer, shiftvox.answer(), length).slice().buffer;
  postMessage(answer, [answer]);
};
