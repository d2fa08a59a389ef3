// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that reads the recording.
import { Chain } from './chain.js';
import { Damaged, prepare } from './hdf5_file.js';
import { hands, Recording } from './recording.js';
import { Judging } from './judging.js';
import { buffersOf } from './segment_rows.js';
import { instantiate } from './wasm_host.js';

let proof = null;
let recording = null;
let columns = []; // of the engine's results
let resultVersion = 0;
let judge = null; // compiled module
let judging = null;
let chain = null;

const lineOf = (error) => (error instanceof Damaged ? error.message : `it cannot be read: ${error?.message ?? error}`);

/** What the time line shows, step by step. */
function tracks() {
  const { counts, ticks, tick } = recording;
  const stepSeconds = ticks * tick;
  const out = { stepSeconds, force: [], speed: [], instrument: [] };
  for (const hand of hands) {
    const position = recording.array(`/ticks/${hand}/position`, 'f8', 0, counts.ticks);
    const speed = new Float32Array(counts.steps);
    const force = new Float32Array(counts.steps);
    const instrument = new Uint8Array(counts.steps);
    const numbers = recording.array(`/ticks/${hand}/instrument`, 'u1', 0, counts.ticks);
    const contact = recording.golden ? null : recording.array(`/observables/${hand}/contact_force`, 'f8', 0, counts.steps);
    for (let n = 0; n < counts.steps; ++n) {
      const [a, b] = [3 * n * ticks, 3 * Math.min(counts.ticks - 1, (n + 1) * ticks)];
      speed[n] = Math.hypot(position[b] - position[a], position[b + 1] - position[a + 1], position[b + 2] - position[a + 2]) / stepSeconds;
      if (contact) force[n] = Math.hypot(contact[3 * n], contact[3 * n + 1], contact[3 * n + 2]);
      instrument[n] = numbers[n * ticks];
    }
    out.force.push(force);
    out.speed.push(speed);
    out.instrument.push(instrument);
  }
  return out;
}

const on = {
  async start(m) {
    proof = instantiate(m.proof);
    judge = m.judge;
    await prepare();
    postMessage({ kind: 'prepared' });
  },
  async open(m) {
    try {
      const bytes = new Uint8Array(m.bytes ?? await m.file.arrayBuffer());
      await prepare();
      let other = null;
      const early = (about, files) => {
        if (about.simulation_version !== m.simulation) other = about.simulation_version;
        else postMessage({ kind: 'scene', files });
        return other === null;
      };
      try {
        const next = await Recording.open(bytes, proof, early);
        recording?.file.close();
        recording = next;
        judging = chain = null;
      } catch (error) {
        if (other === null) throw error;
        postMessage({ kind: 'undecided', simulation: other });
        return;
      }
      const { about, format, golden, components, fields, fieldComponent, counts, segments, files, completed, outcome } = recording;
      postMessage({
        kind: 'opened', about, counts, segments, files, completed, outcome, tick: recording.tick, ticks: recording.ticks,
        events: recording.events, comparison: { format, golden, components, fields, fieldComponent },
      });
    } catch (error) {
      postMessage({ kind: 'refused', message: lineOf(error) });
    }
  },
  columns(m) {
    columns = m.columns;
    resultVersion = m.result;
  },
  segment(m) {
    try {
      const rows = recording.segment(m.index, columns);
      postMessage({ kind: 'segment', index: m.index, asker: m.asker, rows }, buffersOf(rows));
    } catch (error) {
      postMessage({ kind: 'segment', index: m.index, asker: m.asker, message: lineOf(error) });
    }
  },
  tracks() {
    try {
      postMessage({ kind: 'tracks', ...tracks() });
      chain = new Chain(recording, columns, proof);
      setTimeout(on.chain);
      if (recording.golden || recording.about.step_result_version !== resultVersion) return;
      judging = new Judging(recording, columns, judge);
      on.judge();
    } catch (error) {
      postMessage({ kind: 'unjudged', message: lineOf(error) });
    }
  },
  chain() {
    if (chain === null) return;
    try {
      const told = chain.next();
      if (told.done) chain = null;
      else setTimeout(on.chain);
      postMessage({ kind: 'chain', ...told });
    } catch (error) {
      chain = null;
      postMessage({ kind: 'chain', row: 0, of: 0, broken: 0, step: -1, done: true, message: lineOf(error) });
    }
  },
  /** A piece at a time, so that requests for segments come between. */
  judge() {
    if (judging === null) return;
    try {
      const judged = judging.next();
      postMessage({ kind: 'judged', ...judged });
      if (judged.done) judging = null;
      else setTimeout(on.judge);
    } catch (error) {
      judging = null;
      postMessage({ kind: 'unjudged', message: lineOf(error) });
    }
  },
};
onmessage = ({ data }) => on[data.kind](data);
