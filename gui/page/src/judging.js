// SPDX-License-Identifier: GPL-3.0-or-later
// Judges recorded results, a piece at a time, with the module of the judge that all of Calot's programs use.
import { Reader, Writer } from './bytes.js';
import { sizes } from './recording.js';
import { instantiate, place, textAt } from './wasm_host.js';

const piece = 200; // steps

export class Judging {
  constructor(recording, columns, module) {
    Object.assign(this, { recording, columns, step: 0 });
    this.judge = instantiate(module);
    const w = new Writer(1 << 20);
    w.u8(recording.files.length);
    for (const { name, content } of recording.files) {
      w.str(name);
      w.blob(content);
    }
    w.u8(columns.length);
    for (const { path, type, width } of columns) {
      w.str(path);
      w.str(type);
      w.u4(width);
    }
    place(this.judge, w.done());
    if (this.call('calot_begin') !== 1) throw new Error('its scene is no scene');
  }

  call(name) {
    try {
      return this.judge[name]();
    } catch {
      throw new Error(textAt(this.judge.memory, this.judge.calot_thrown() >>> 0) || 'judging failed');
    }
  }

  /** {first, phases, told: [{step, fault, text}], criticalView, verdict, done} of the next steps. */
  next() {
    const { recording, columns } = this;
    const first = this.step;
    const count = Math.min(piece, recording.counts.steps - first);
    const rows = columns.map(({ path, type, width }) => ({ size: sizes[type] * width, bytes: recording.file.rows(recording.pathOf(path), first, count) }));
    const size = rows.reduce((sum, r) => sum + r.size, 0);
    const w = new Writer(count * (size + 64));
    w.u8(count);
    let e = recording.firstEvent(first);
    for (let k = 0; k < count; ++k) {
      w.u8(first + k);
      w.u8(size);
      for (const r of rows) w.raw(r.bytes.subarray(k * r.size, (k + 1) * r.size));
      const from = e;
      while (recording.eventStep[e] === first + k) e += 1;
      w.u8(e - from);
      for (let i = from; i < e; ++i) {
        w.raw(recording.events.subarray(45 * i, 45 * i + 9)); // its kind has one byte here
        w.raw(recording.events.subarray(45 * i + 10, 45 * i + 45));
      }
    }
    place(this.judge, w.done());
    const length = this.call('calot_judge') >>> 0;
    if (length === 0) throw new Error('its results are no rows');
    const r = new Reader(new Uint8Array(this.judge.memory.buffer, this.judge.calot_judged() >>> 0, length).slice());
    this.step += count;
    return {
      first,
      phases: r.blob(),
      told: r.list(() => ({ step: r.count(), fault: r.u1() === 1, text: r.str() })),
      criticalView: r.u1(),
      verdict: r.list(() => r.str()),
      done: this.step === recording.counts.steps,
    };
  }
}
