// SPDX-License-Identifier: GPL-3.0-or-later
// A recording (schemas/recording.md): what it says of itself, and its rows by segment.
import { Damaged, Hdf5File } from './hdf5_file.js';
import { Keyframes } from './keyframes.js';

const text = new TextDecoder();
const statusBytes = 82;
const outcomes = ['running', 'completed', 'time limit', 'abandoned', 'stopped', 'technical failure'];
export const hands = ['left', 'right'];

const arrays = { f8: Float64Array, f4: Float32Array, i8: BigInt64Array, u8: BigUint64Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array };
export const sizes = { f8: 8, f4: 4, i8: 8, u8: 8, u4: 4, u2: 2, u1: 1 };
const ofHands = { position: ['f8', 3], orientation: ['f8', 4], instrument: ['u1', 1], jaw: ['f8', 1], buttons: ['u1', 1], valid: ['u1', 1], contact_set: ['i8', 1] };

function trimmed(bytes) {
  const end = bytes.indexOf(0);
  return text.decode(end < 0 ? bytes : bytes.subarray(0, end));
}

export class Recording {
  /** @param early called with what it is about and the scene's files, before the rest is looked at; false ends it */
  static async open(bytes, proof, early = () => true) {
    const file = await Hdf5File.open(bytes);
    try {
      return new Recording(file, proof, early);
    } catch (error) {
      file.close();
      throw error;
    }
  }

  constructor(file, proof, early) {
    this.file = file;
    const names = file.attributes('/');
    if (!names.includes('format') || this.string('/', 'format') !== 'calot-recording') throw new Damaged('it is an HDF5 file, but no recording of Calot');
    this.format = this.number('format_version');
    if (this.format !== 1 && this.format !== 2) throw new Damaged(`it is of format version ${this.format}: this page reads 1 and 2`);
    this.about = {};
    for (const name of ['attempt_uuid', 'start_utc', 'software', 'build', 'participant', 'operator_kind', 'performer_profile', 'performer_version', 'mode', 'purpose', 'scene_name'])
      this.about[name] = this.string('/', name);
    for (const name of ['simulation_version', 'step_result_version', 'scene_major', 'scene_minor']) this.about[name] = this.number(name);
    this.seed = this.attribute('seed', 'u8')[0];
    this.tick = this.attribute('tick_seconds', 'f8')[0];
    this.ticks = this.number('ticks_per_step');
    if (!(this.tick > 0 && this.tick <= 1) || !(this.ticks >= 1 && this.ticks <= 1000)) throw new Damaged('its ticks have no length that is possible');
    this.golden = this.about.purpose === 'golden';
    this.files = this.sceneFiles();
    if (!early(this.about, this.files)) throw new Damaged('it is of another simulation version');
    this.readStatus();
    this.components = this.strings('/steps/component_names');
    this.fields = this.strings('/steps/field_names');
    this.fieldComponent = this.fields.length > 0 ? new Uint32Array(file.rows('/steps/field_component').buffer) : [];
    this.organs = this.strings('/scene/organs');
    this.vessels = this.strings('/scene/vessels');
    this.fat = this.strings('/scene/fat');
    this.checkRows();
    const coded = this.format > 1;
    this.keyframes = new Keyframes(file, proof, this.counts.keyframes, this.counts.words, coded);
    this.segments = this.divide();
    this.readEvents();
  }

  string(path, name) {
    if (!this.file.attributes(path).includes(name)) throw new Damaged(`${path === '/' ? '/' : path}@${name} is missing`);
    return trimmed(this.file.attribute(path, name).bytes);
  }
  attribute(name, type) {
    if (!this.file.attributes('/').includes(name)) throw new Damaged(`/@${name} is missing`);
    const { bytes } = this.file.attribute('/', name);
    if (bytes.length !== sizes[type]) throw new Damaged(`/@${name} is not of type ${type}`);
    return new arrays[type](bytes.buffer);
  }
  number(name) { return Number(this.attribute(name, 'u4')[0]); }
  strings(path) {
    if (!this.file.has(path)) return [];
    const { size, shape } = this.file.describe(path);
    const bytes = this.file.rows(path);
    return Array.from({ length: shape[0] }, (_, i) => trimmed(bytes.subarray(i * size, (i + 1) * size)));
  }

  readStatus() {
    const { shape, size } = this.file.describe('/status');
    if (size !== statusBytes || shape[0] < 1) throw new Damaged('/status has not the rows that it must have');
    const bytes = this.file.rows('/status', shape[0] - 1, 1);
    const view = new DataView(bytes.buffer);
    const at = (n) => Number(view.getBigUint64(8 * n, true));
    this.counts = { ticks: at(0), steps: at(1), events: at(2), keyframes: at(3), words: at(4), flushes: shape[0] - 1 };
    this.completed = bytes[40] === 1;
    this.outcome = outcomes[bytes[41]] ?? 'unknown';
    if (this.counts.ticks !== this.counts.steps * this.ticks) throw new Damaged('/status: its counts do not fit one another');
    if (this.counts.steps === 0) throw new Damaged('it has no step');
  }

  sceneFiles() {
    const name = (path) => this.string(path, 'name');
    const files = [{ name: name('/scene/description'), content: this.file.rows('/scene/description') }];
    for (let i = 1; ; ++i) {
      const path = `/scene/assets/${String(i).padStart(3, '0')}`;
      if (!this.file.has(path)) return files;
      files.push({ name: name(path), content: this.file.rows(path) });
    }
  }

  /** Are there as many rows as the last row of /status says? */
  checkRows() {
    const check = (path, rows, row) => {
      const found = this.file.describe(path);
      if (found.row !== row) throw new Damaged(`${path} has not the type or shape that it must have`);
      if (found.shape[0] < rows) throw new Damaged(`${path} has ${found.shape[0]} rows: /status says ${rows}`);
    };
    for (const hand of hands) {
      for (const [name, [type, width]] of Object.entries(ofHands)) check(`/ticks/${hand}/${name}`, this.counts.ticks, sizes[type] * width);
      for (const name of this.golden ? [] : ['force', 'torque']) check(`/ticks/${hand}/${name}`, this.counts.ticks, 24);
    }
    check('/ticks/lateness', this.counts.ticks, 4);
    check('/camera/position', this.counts.ticks, 24);
    check('/camera/orientation', this.counts.ticks, 32);
    check('/steps/lateness', this.counts.steps, 4);
    check('/events', this.counts.events, 45);
    this.digests = [];
    const add = (name, size) => { check(`/steps/${name}`, this.counts.steps, size); this.digests.push(name); };
    if (this.golden || this.format === 1) {
      if (this.components.length > 0) add('component_digest', 8 * this.components.length);
    } else {
      add('state_digest', 8);
    }
    if (!this.golden && this.fields.length > 0) add('field_digest', (this.format === 1 ? 4 : 2) * this.fields.length);
    if (this.golden || this.format > 1) add('force_digest', 8);
  }

  /** Segments cover every step once: each ends with a keyframe, or with the recording. */
  divide() {
    const segments = [];
    let first = 0;
    for (let i = 0; i <= this.keyframes.index.length && first < this.counts.steps; ++i) {
      const end = i < this.keyframes.index.length ? this.keyframes.index[i].step + 1 : this.counts.steps;
      if (end > this.counts.steps) throw new Damaged('/keyframes/index: a keyframe is of no step that there is');
      segments.push({ index: i, first, end, from: i - 1, to: i < this.keyframes.index.length ? i : -1 });
      first = end;
    }
    return segments;
  }

  array(path, type, first, count) { return new arrays[type](this.file.rows(path, first, count).buffer); }

  /** All that a segment's proof needs. @param columns of the engine's results */
  segment(i, columns) {
    const { index, first, end, from, to } = this.segments[i];
    const steps = end - first;
    const at = first * this.ticks;
    const count = steps * this.ticks;
    const rows = { index, first, end, ticks: this.ticks, hands: [], digests: {}, columns: [] };
    for (const hand of hands) {
      const values = {};
      for (const [name, [type]] of Object.entries(ofHands)) values[name] = this.array(`/ticks/${hand}/${name}`, type, at, count);
      for (const name of this.golden ? [] : ['force', 'torque']) values[name] = this.array(`/ticks/${hand}/${name}`, 'f8', at, count);
      rows.hands.push(values);
    }
    rows.camera = { position: this.array('/camera/position', 'f8', at, count), orientation: this.array('/camera/orientation', 'f8', at, count) };
    rows.lateness = this.array('/ticks/lateness', 'f4', at, count);
    rows.stepLateness = this.array('/steps/lateness', 'f4', first, steps);
    for (const name of this.digests) rows.digests[name] = this.file.rows(`/steps/${name}`, first, steps);
    for (const { path, type, width } of this.golden ? [] : columns) {
      const set = this.pathOf(path);
      if (this.file.describe(set).row !== sizes[type] * width) throw new Damaged(`${set} has not the type or shape that it must have`);
      rows.columns.push(this.file.rows(set, first, steps));
    }
    const [begin, stop] = [this.firstEvent(first), this.firstEvent(end)];
    rows.events = this.events.slice(45 * begin, 45 * stop);
    rows.seed = this.seed;
    rows.start = from < 0 ? null : { keyframe: this.keyframes.read(from), named: hands.map((h) => this.array(`/ticks/${h}/contact_set`, 'i8', at - 1, 1)[0]) };
    rows.finish = to < 0 ? null : this.keyframes.read(to);
    return rows;
  }

  /** Data set of a column of an engine's results. */
  pathOf(column) { return `/observables/${column.replace(/^\/?(observables\/)?/, '')}`; }

  readEvents() {
    this.events = this.file.rows('/events', 0, this.counts.events);
    const view = new DataView(this.events.buffer);
    this.eventStep = Array.from({ length: this.counts.events }, (_, i) => Number(view.getBigUint64(45 * i, true)));
    for (let i = 1; i < this.eventStep.length; ++i)
      if (this.eventStep[i] < this.eventStep[i - 1]) throw new Damaged(`/events: row ${i} is out of order`);
  }

  /** The first event that is not before a step. */
  firstEvent(step) {
    let low = 0;
    for (let high = this.eventStep.length; low < high;) {
      const middle = (low + high) >> 1;
      if (this.eventStep[middle] < step) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
