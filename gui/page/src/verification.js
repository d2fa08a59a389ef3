// SPDX-License-Identifier: GPL-3.0-or-later
// Hands segments to engines, near the moment that is looked at first, and keeps what they found. Segments joined prove
// what one run from the start proves: only when all of them are consistent is the attempt verified.
import { listen } from './threads.js';
import { buffersOf, segmentOf } from './segment_rows.js';
import { Waypoints } from './waypoints.js';

const block = 8; // segments that one engine proves in a row

export const State = { open: 0, running: 1, consistent: 2, differs: 3 };

export class Verification {
  /**
   * @param segments of the recording @param start makes an engine's thread, told module and scene
   * @param read asks for a segment's rows: resolves with them @param changed called when anything did
   */
  constructor(segments, size, start, read, changed) {
    Object.assign(this, { segments, read, changed });
    this.state = new Uint8Array(segments.length);
    this.steps = new Uint32Array(segments.length); // done of each
    this.moment = 0;
    this.difference = null; // the first one
    this.again = null; // what its segment gave when it was run once more
    this.error = null;
    this.waypoints = new Waypoints();
    this.began = performance.now();
    this.finished = null;
    this.workers = Array.from({ length: Math.min(size, segments.length) }, () => ({ thread: start(), work: 0, last: -1, ready: false, held: false }));
    for (const worker of this.workers) this.attend(worker);
  }

  attend(worker) {
    listen(worker.thread, {
      ready: () => { worker.ready = true; this.feed(); },
      progress: ({ index, steps }) => { this.steps[index] = steps; this.changed(); },
      waypoint: (m) => this.waypoints.keep(m),
      proved: (m) => this.proved(worker, m),
      failed: ({ message }) => this.fail(message),
    }, (message) => this.fail(message));
  }

  get total() { return this.segments.at(-1).end; }
  get done() { return this.steps.reduce((a, b) => a + b, 0); }
  get verified() { return this.difference === null && this.error === null && this.state.every((s) => s === State.consistent); }
  /** Re-simulated seconds a second. */
  speed(stepSeconds) { return this.done * stepSeconds / (((this.finished ?? performance.now()) - this.began) / 1000); }

  /** Where whoever goes to a moment may begin instead of at the keyframe before it, or null: in consistent segments alone. */
  waypointBefore(moment) {
    const index = segmentOf(this.segments, moment);
    return this.state[index] === State.consistent ? this.waypoints.before(moment, index) : null;
  }

  end() { for (const { thread } of this.workers) thread.terminate(); }

  /** What is looked at, and what for: engines that prove give way to one that seeks, and one of them to one that plays. */
  attention(moment, doing) {
    this.moment = moment;
    const resting = { seek: this.workers.length, alone: this.workers.length, play: this.workers.length > 1 ? 1 : 0 }[doing] ?? 0;
    this.workers.forEach((worker, i) => {
      const held = i >= this.workers.length - resting;
      if (worker.held !== held) worker.thread.postMessage({ kind: 'hold', on: held });
      worker.held = held;
    });
    this.feed();
  }

  /** The next segment for an engine: the one behind its last, since it goes on from there at once; else one where none is at work. */
  next(worker) {
    const limit = this.difference?.index ?? this.segments.length; // what follows a difference is of no interest
    const isOpen = (i) => i < limit && this.state[i] === State.open;
    const after = worker.last + 1;
    if (worker.last >= 0 && after % block !== 0 && isOpen(after)) return after;
    const near = segmentOf(this.segments, this.moment);
    const others = new Set(this.workers.filter((w) => w !== worker && w.work > 0).map((w) => Math.floor(w.last / block)));
    for (const alone of [true, false])
      for (const [from, to] of [[near, limit], [0, near]])
        for (let i = from; i < to; ++i) if (isOpen(i) && !(alone && others.has(Math.floor(i / block)))) return i;
    return -1;
  }

  feed() {
    for (const depth of [1, 2]) // the second of each waits while the first is run
      for (const worker of this.workers) {
        if (!worker.ready || worker.held || worker.work >= depth || this.error) continue;
        const index = this.next(worker);
        if (index >= 0) this.give(worker, index);
      }
  }

  give(worker, index) {
    worker.work += 1;
    worker.last = index;
    this.state[index] = State.running;
    this.read(index).then((rows) => worker.thread.postMessage({ kind: 'prove', rows }, buffersOf(rows)), (error) => this.fail(error.message));
    this.changed();
  }

  /** @param worker that found it; null: it was played */
  proved(worker, { index, difference }) {
    if (worker !== null) worker.work -= 1;
    else if (difference !== null || this.state[index] >= State.consistent) return; // a difference is found, and run again, by those who prove
    this.steps[index] = this.segments[index].end - this.segments[index].first;
    if (difference === null) {
      this.state[index] = State.consistent;
      if (this.difference?.index === index) this.again = 'consistent';
    } else if (this.difference?.index === index) {
      this.again = sameDifference(this.difference, difference) ? 'same' : 'other';
    } else {
      this.state[index] = State.differs;
      if (this.difference === null || index < this.difference.index) {
        this.difference = { ...difference, index };
        this.again = null;
        this.give(worker, index); // once more: is it reproducible?
        this.state[index] = State.differs;
      }
    }
    if (this.finished === null && this.settled()) this.finished = performance.now();
    this.feed();
    this.changed();
  }

  /** Is there nothing left that could change the verdict? */
  settled() {
    if (this.error !== null) return true;
    if (this.difference === null) return this.verified;
    return this.again !== null && this.state.subarray(0, this.difference.index).every((s) => s === State.consistent);
  }

  fail(message) {
    this.error ??= message;
    this.changed();
  }
}

function sameDifference(a, b) {
  return ['step', 'tick', 'component', 'field', 'detail'].every((k) => a[k] === b[k]);
}
