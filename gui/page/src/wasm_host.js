// SPDX-License-Identifier: GPL-3.0-or-later
// What a WebAssembly module of Calot gets from its host: of WASI what ends it, and a refusal of all else.

const notSupported = 58; // WASI's ENOTSUP

/** @param given further imports by module and name @return the module's exports */
export function instantiate(module, given = {}) {
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] = given[from]?.[name] ?? (name === 'proc_exit' ? () => { throw new Error('the module has ended'); } : () => notSupported);
  }
  const { exports } = new WebAssembly.Instance(module, imports);
  exports._initialize();
  return exports;
}

/** The text at a place of a module's memory that ends with a zero byte. */
export function textAt(memory, place) {
  const bytes = new Uint8Array(memory.buffer, place);
  return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
}

/** Puts bytes, one part after the other, into a module that has calot_place(). */
export function place(exports, ...parts) {
  let length = 0;
  for (const part of parts) length += part.length;
  let at = exports.calot_place(length) >>> 0;
  for (const part of parts) {
    new Uint8Array(exports.memory.buffer, at, part.length).set(part);
    at += part.length;
  }
}
