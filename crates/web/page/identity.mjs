// Draws the golden pictures in WebAssembly, and compares their identity with the published one:
// node crates/web/page/identity.mjs SHIFTVOX.wasm IDENTITY
import { readFileSync } from "node:fs";

const [file, published] = process.argv.slice(2);
const page = { now: () => performance.now() };
const { exports: shiftvox } = (await WebAssembly.instantiate(readFileSync(file), { page })).instance;
const length = shiftvox.identity();
const report = new TextDecoder().decode(new Uint8Array(shiftvox.memory.buffer, shiftvox.answer(), length));
console.log(report);
process.exit(report === published ? 0 : 1);
