// SPDX-License-Identifier: GPL-3.0-or-later
// Proves one segment after the other (docs/explanation/determinism.md, "In segments").
import { breath } from './breath.js';
import { same } from './bytes.js';
import { compareStep } from './compare.js';
import { EngineFault, want } from './engine.js';
import { sizes } from './recording.js';
import { withEvents } from './segment_rows.js';
import { encodeTicks } from './ticks.js';
import { isWaypoint } from './waypoints.js';

const slice = 30; // ms of stepping before messages are looked at

/** What a comparison has to know beside the rows. */
export function comparison(about, engine, proof) {
  return { ...about, proof, columns: engine.columns, columnSizes: engine.columns.map(({ type, width }) => sizes[type] * width) };
}

/** Step k of a segment, re-simulated and compared; at the segment's end its keyframe too, byte for byte. @param wanted what the answer is to come with */
export function provenStep(what, engine, rows, k, wanted = 0) {
  const { ticks, finish } = rows;
  const last = k + 1 === rows.end - rows.first && finish !== null;
  const answer = engine.step(last ? want.keyframe : wanted, rows.stepLateness[k], encodeTicks(rows, k * ticks, ticks));
  const difference = compareStep(what, rows, k, answer);
  if (difference !== null || !last || (same(answer.keyframe.state, finish.state) && same(answer.keyframe.haptics, finish.haptics))) return { answer, difference };
  const { field, detail } = engine.explain(finish) ?? { field: 'bytes', detail: '' };
  return { answer, difference: { step: answer.step, component: 'keyframe', field, detail } };
}

export class Verifier {
  constructor(about, engine, proof) {
    this.engine = engine;
    this.what = comparison(about, engine, proof);
    this.at = -1; // segment at whose end the engine is, with that keyframe byte for byte; -1: elsewhere
    this.held = false;
  }

  /** Lets others have the processor, until it is called with false. */
  hold(on) {
    this.held = on;
    if (!on) this.goOn?.();
  }

  /** @param progress called with the number of steps done @param passed called with a waypoint @return the first difference, or null */
  async run(rows, progress, passed) {
    withEvents(rows);
    const { engine } = this;
    const { index, first, end, start } = rows;
    const goesOn = start !== null && this.at === index - 1;
    this.at = -1;
    let k = 0;
    try {
      if (start === null) {
        engine.start(rows.seed);
      } else if (!goesOn) {
        const why = engine.restore(start.keyframe, start.named);
        if (why !== null) return { step: first - 1, component: 'keyframe', field: 'state', detail: why };
      }
      for (let rested = performance.now(); k < end - first; ++k) {
        const leaves = isWaypoint(k, end - first);
        const { answer, difference } = provenStep(this.what, engine, rows, k, leaves ? want.keyframe : 0);
        if (difference !== null) return difference;
        if (leaves) passed({ moment: first + k + 1, index, keyframe: answer.keyframe, named: rows.hands.map((hand) => hand.contact_set[(k + 1) * rows.ticks - 1]) });
        progress(k + 1);
        if (performance.now() - rested < slice) continue;
        do {
          await breath();
          if (this.held) await new Promise((resolve) => { this.goOn = resolve; });
        } while (this.held);
        rested = performance.now();
      }
      this.at = rows.finish === null ? -1 : index;
      return null;
    } catch (error) {
      if (!(error instanceof EngineFault)) throw error;
      return { step: first + k, component: 'engine', field: 'step', detail: error.message, ended: true };
    }
  }
}
