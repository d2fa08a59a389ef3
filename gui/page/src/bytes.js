// SPDX-License-Identifier: GPL-3.0-or-later
// Little-endian bytes, written and read in order (schemas/engine.md, "Messages").

const utf8 = new TextEncoder();
const text = new TextDecoder();

export class Writer {
  constructor(size = 1024) {
    this.bytes = new Uint8Array(size);
    this.view = new DataView(this.bytes.buffer);
    this.at = 0;
  }
  /** Makes room and returns where it is. */
  room(size) {
    const at = this.at;
    if (at + size > this.bytes.length) {
      const grown = new Uint8Array(Math.max(2 * this.bytes.length, at + size));
      grown.set(this.bytes);
      this.bytes = grown;
      this.view = new DataView(grown.buffer);
    }
    this.at += size;
    return at;
  }
  u1(value) { const at = this.room(1); this.view.setUint8(at, value); }
  u4(value) { const at = this.room(4); this.view.setUint32(at, value, true); }
  u8(value) { const at = this.room(8); this.view.setBigUint64(at, BigInt(value), true); }
  i8(value) { const at = this.room(8); this.view.setBigInt64(at, BigInt(value), true); }
  f4(value) { const at = this.room(4); this.view.setFloat32(at, value, true); }
  f8(value) { const at = this.room(8); this.view.setFloat64(at, value, true); }
  raw(bytes) { const at = this.room(bytes.length); this.bytes.set(bytes, at); }
  blob(bytes) { this.u8(bytes.length); this.raw(bytes); }
  str(value) { this.blob(utf8.encode(value)); }
  done() { return this.bytes.subarray(0, this.at); }
}

export class Reader {
  /** @param bytes what is read; never changed */
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }
  take(size) {
    if (size > this.bytes.length - this.at) throw new Error('a message ends too early');
    const at = this.at;
    this.at += size;
    return at;
  }
  u1() { return this.view.getUint8(this.take(1)); }
  u2() { return this.view.getUint16(this.take(2), true); }
  u4() { return this.view.getUint32(this.take(4), true); }
  u8() { return this.view.getBigUint64(this.take(8), true); }
  count() { return Number(this.u8()); }
  f8() { return this.view.getFloat64(this.take(8), true); }
  raw(size) { const at = this.take(size); return this.bytes.subarray(at, at + size); }
  blob() { return this.raw(this.count()); }
  str() { return text.decode(this.blob()); }
  list(read) {
    const out = [];
    for (let n = this.count(); n > 0; --n) out.push(read());
    return out;
  }
}

/** Are both the same bytes? */
export function same(a, b) {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}
