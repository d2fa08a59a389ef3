// SPDX-License-Identifier: GPL-3.0-or-later
// The content chain (schemas/recording.md, "Content chain"), followed flush by flush, some at a time.
import { same, Writer } from './bytes.js';
import { hands } from './recording.js';
import { place } from './wasm_host.js';

const label = new TextEncoder().encode('calot-recording-chain-1');
const statusBytes = 82;
const atOnce = 8; // flushes
const attributes = ['format', 'format_version', 'attempt_uuid', 'parent_uuid', 'fork_step', 'start_utc', 'software', 'build', 'simulation_version',
  'step_result_version', 'participant', 'operator_kind', 'performer_profile', 'performer_version', 'source_file', 'source_sha256', 'device', 'calibration',
  'station', 'mode', 'purpose', 'handedness', 'seed', 'tick_seconds', 'ticks_per_step', 'scene_name', 'scene_major', 'scene_minor'];
const ofHand = ['position', 'orientation', 'instrument', 'jaw', 'buttons', 'valid', 'contact_set', 'force', 'torque'];
const counts = ['ticks', 'steps', 'events', 'keyframes', 'words'];

export class Chain {
  /** @param columns of the results, in their order */
  constructor(recording, columns, proof) {
    Object.assign(this, { recording, proof, row: 0 });
    this.rows = recording.file.rows('/status');
    this.count = this.rows.length / statusBytes;
    const { file } = recording;
    this.sets = [];
    const add = (stream, path) => { if (file.has(path)) this.sets.push({ stream, path, size: file.describe(path).row }); };
    for (const hand of hands) for (const name of ofHand) add('ticks', `/ticks/${hand}/${name}`);
    for (const name of ['position', 'orientation']) add('ticks', `/camera/${name}`);
    for (const name of ['component_digest', 'state_digest', 'field_digest', 'force_digest']) add('steps', `/steps/${name}`);
    for (const { path } of recording.golden ? [] : columns) add('steps', recording.pathOf(path));
    add('events', '/events');
    if (!recording.golden) {
      add('keyframes', '/keyframes/index');
      add('words', '/keyframes/bytes');
    }
  }

  status(k) {
    const row = this.rows.subarray(k * statusBytes, (k + 1) * statusBytes);
    const view = new DataView(row.buffer, row.byteOffset, row.byteLength);
    return { ...Object.fromEntries(counts.map((name, i) => [name, Number(view.getBigUint64(8 * i, true))])), ends: row.subarray(40, 42), chain: row.subarray(50) };
  }

  append(bytes) {
    place(this.proof, bytes);
    this.proof.calot_chain_append(bytes.length);
  }
  head() { return new Uint8Array(this.proof.memory.buffer, this.proof.calot_chain_head() >>> 0, 32).slice(); }

  start() {
    const { recording } = this;
    const w = new Writer(1 << 16);
    const string = (text) => {
      const bytes = new TextEncoder().encode(text);
      w.u4(bytes.length);
      w.raw(bytes);
    };
    const names = (list) => {
      w.u8(list.length);
      list.forEach(string);
    };
    w.raw(label);
    for (const name of attributes) {
      string(name);
      const { bytes, metadata } = recording.file.attribute('/', name);
      if (metadata.type === 3) string(recording.string('/', name)); // H5T_STRING
      else w.raw(bytes);
    }
    w.u8(recording.files.length);
    for (const { name, content } of recording.files) {
      string(name);
      w.blob(content);
    }
    names(recording.organs);
    if (recording.about.step_result_version >= 3) {
      names(recording.vessels);
      names(recording.fat);
    }
    names(recording.components);
    w.u8(recording.fields.length);
    recording.fields.forEach((field, i) => {
      w.u4(recording.fieldComponent[i]);
      string(field);
    });
    this.writeCounts(w, this.status(0));
    this.proof.calot_chain_begin();
    this.append(w.done());
  }

  writeCounts(w, status) {
    for (const name of counts) w.u8(status[name]);
    w.raw(status.ends);
  }

  /** Follows the next flushes. @return {row: of /status that is done, of: how many, broken: first row that does not fit, or null, done} */
  next() {
    if (this.row === 0) {
      this.start();
      if (!same(this.head(), this.status(0).chain)) return this.told(0);
      this.row = 1;
    }
    const end = Math.min(this.count, this.row + atOnce);
    const [from, to] = [this.status(this.row - 1), this.status(end - 1)];
    const bytes = this.sets.map(({ stream, path }) => this.recording.file.rows(path, from[stream], to[stream] - from[stream]));
    for (; this.row < end; this.row += 1) {
      const [before, after] = [this.status(this.row - 1), this.status(this.row)];
      const w = new Writer(1 << 17);
      w.raw(before.chain);
      this.sets.forEach(({ stream, path, size }, i) => {
        const name = new TextEncoder().encode(path);
        w.u4(name.length);
        w.raw(name);
        w.u8(before[stream]);
        w.u8(after[stream] - before[stream]);
        w.raw(bytes[i].subarray((before[stream] - from[stream]) * size, (after[stream] - from[stream]) * size));
      });
      this.writeCounts(w, after);
      this.proof.calot_chain_begin();
      this.append(w.done());
      if (!same(this.head(), after.chain)) return this.told(this.row);
    }
    return this.told(null);
  }

  told(broken) {
    const step = broken === null ? null : broken === 0 ? -1 : this.status(broken - 1).steps;
    return { row: this.row, of: this.count, broken, step, done: broken !== null || this.row >= this.count };
  }
}
