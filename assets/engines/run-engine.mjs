// SPDX-License-Identifier: GPL-3.0-or-later
// Runs an engine's module as a program: requests on standard input, answers on standard output (schemas/engine.md).
//   node run-engine.mjs engine-N.wasm
// The module is given no file, clock, environment or argument: of WASI it gets what ends it, and nothing else answers.
import { readFileSync, readSync, writeSync } from 'node:fs';

const headBytes = 12;
const notSupported = 58; // WASI's ENOTSUP
const maxPayload = 2 ** 30;

/** Fills a buffer from standard input; false at its end. */
function readAll(bytes) {
  for (let at = 0; at < bytes.length;) {
    let n = 0;
    try {
      n = readSync(0, bytes, at, bytes.length - at, null);
    } catch (error) {
      if (error.code === 'EAGAIN') continue;
      if (error.code === 'EOF') return false;
      throw error;
    }
    if (n === 0) return false;
    at += n;
  }
  return true;
}

function writeAll(bytes) {
  for (let at = 0; at < bytes.length;) {
    try {
      at += writeSync(1, bytes, at, bytes.length - at);
    } catch (error) {
      if (error.code !== 'EAGAIN') throw error;
    }
  }
}

const module = new WebAssembly.Module(readFileSync(process.argv[2]));
const refuse = () => notSupported;
const imports = {};
for (const { module: from, name } of WebAssembly.Module.imports(module)) {
  imports[from] ??= {};
  imports[from][name] = name === 'proc_exit' ? (code) => process.exit(code) : refuse;
}
const engine = new WebAssembly.Instance(module, imports).exports;
engine._initialize();

/** A copy of the message at a place of the module's memory. */
function messageAt(place) {
  const length = Number(new DataView(engine.memory.buffer, place, headBytes).getBigUint64(4, true));
  return new Uint8Array(engine.memory.buffer, place, headBytes + length);
}

const head = Buffer.alloc(headBytes);
while (readAll(head)) {
  const length = Number(head.readBigUInt64LE(4));
  if (length > maxPayload) process.exit(4);
  const request = new Uint8Array(headBytes + length);
  request.set(head);
  if (!readAll(request.subarray(headBytes))) process.exit(4);
  const place = engine.calot_request(request.length) >>> 0;
  new Uint8Array(engine.memory.buffer, place, request.length).set(request);
  let answer = 0;
  try {
    answer = engine.calot_answer() >>> 0;
  } catch (error) {
    const fault = engine.calot_fault() >>> 0;
    if (fault !== 0) writeAll(messageAt(fault));
    process.exit(4);
  }
  if (answer === 0) process.exit(4);
  writeAll(messageAt(answer));
  if (messageAt(answer)[0] === 199) process.exit(4);
}
