// SPDX-License-Identifier: GPL-3.0-or-later
// Keyframes of a recording (schemas/recording.md, "Keyframes"): in format 2 differences from earlier ones.
import { Damaged } from './hdf5_file.js';
import { place, textAt } from './wasm_host.js';

const longestWay = 64;
const mostKept = 192 << 20; // bytes

export class Keyframes {
  /** @param proof exports of the proof module @param words how many /keyframes/bytes has that count */
  constructor(file, proof, count, words, coded) {
    this.file = file;
    this.proof = proof;
    this.coded = coded;
    this.words = words;
    this.index = [];
    this.known = new Map(); // by index: bytes, newest use last
    this.kept = 0;
    if (count === 0) return;
    const rows = file.rows('/keyframes/index', 0, count);
    const view = new DataView(rows.buffer);
    for (let i = 0; i < count; ++i) {
      const at = (n) => Number(view.getBigUint64(32 * i + 8 * n, true));
      this.index.push({ step: at(0), offset: at(1), state: at(2), haptics: at(3) });
      if (i > 0 && this.index[i].step <= this.index[i - 1].step) throw new Damaged(`/keyframes/index: row ${i} is out of order`);
    }
  }

  /** Keyframe i: {step, state, haptics}. @throws Damaged */
  read(i) {
    const { step, state } = this.index[i];
    const bytes = this.coded ? this.decoded(i) : this.plain(i);
    return { step, state: bytes.slice(0, state), haptics: bytes.slice(state) };
  }

  plain(i) {
    const { offset, state, haptics } = this.index[i];
    const first = Math.floor(offset / 8);
    const end = Math.ceil((offset + state + haptics) / 8);
    return this.file.rows('/keyframes/bytes', first, end - first).slice(offset - 8 * first, offset - 8 * first + state + haptics);
  }

  code(i) {
    const first = this.index[i].offset / 8;
    const end = i + 1 < this.index.length ? this.index[i + 1].offset / 8 : this.words;
    if (!(end > first)) throw new Damaged(`/keyframes/index: row ${i} has no words`);
    return this.file.rows('/keyframes/bytes', first, end - first);
  }

  decoded(wanted) {
    const way = [];
    for (let i = wanted; !this.known.has(i);) {
      if (way.length === longestWay) throw this.refused(wanted, 'lies too many others away from one that stands alone');
      const code = this.code(i);
      const base = Number(new DataView(code.buffer).getBigUint64(0, true));
      if (base > i) throw this.refused(i, 'is compared with one that is not before it');
      way.push({ i, code, base: base - 1 });
      if (base === 0) break;
      i = base - 1;
    }
    for (const { i, code, base } of way.reverse()) {
      const size = this.index[i].state + this.index[i].haptics;
      const other = base < 0 ? new Uint8Array(0) : this.known.get(base);
      place(this.proof, code, other);
      if (this.proof.calot_keyframe(i, code.length / 8, other.length, size) !== 1)
        throw this.refused(i, textAt(this.proof.memory, this.proof.calot_fault() >>> 0));
      this.keep(i, new Uint8Array(this.proof.memory.buffer, this.proof.calot_decoded() >>> 0, size).slice());
    }
    const bytes = this.known.get(wanted);
    this.known.delete(wanted);
    this.known.set(wanted, bytes); // used last
    this.forget();
    return bytes;
  }

  keep(i, bytes) {
    this.known.set(i, bytes);
    this.kept += bytes.length;
  }

  /** Forgets what was used longest ago. */
  forget() {
    for (const [i, bytes] of this.known) {
      if (this.kept <= mostKept || this.known.size === 1) return;
      this.known.delete(i);
      this.kept -= bytes.length;
    }
  }

  refused(i, why) { return new Damaged(`/keyframes/bytes: the keyframe of step ${this.index[i].step} ${why}`); }
}
