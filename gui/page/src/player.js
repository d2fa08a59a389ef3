// SPDX-License-Identifier: GPL-3.0-or-later
// Re-simulates for the eye: goes to a moment, and on from it in time. A moment is a number of steps done.
import { breath } from './breath.js';
import { withEvents } from './segment_rows.js';
import { comparison, provenStep } from './verifier.js';

const slice = 40; // ms of stepping before messages are looked at
const near = 12; // steps that are taken before anything could be seen

export class Player {
  /** @param host fetch(i): rows of segment i; show(view, moment, difference): a picture, resolves when it is drawn; tell(state); proved(i, difference) */
  constructor(about, segments, engine, proof, host) {
    Object.assign(this, { engine, host, segments });
    this.what = comparison(about, engine, proof);
    this.stepSeconds = engine.ticks * engine.tick;
    this.steps = segments.at(-1).end;
    this.done = -1; // nothing is begun
    this.rows = null;
    this.order = 0; // of the newest wish: older ones end where they are
    this.difference = null;
  }

  async load(i) {
    if (this.rows?.index !== i) this.rows = withEvents(await this.host.fetch(i));
    return this.rows;
  }

  /** Starts at the beginning, or at the keyframe before a moment. */
  async begin(moment) {
    const found = this.segments.findIndex((s) => moment < s.end);
    const i = found < 0 ? this.segments.length - 1 : found; // the end is reached from the last keyframe before it
    const rows = await this.load(i);
    if (this.done >= rows.first && this.done <= moment && this.rowsOfDone === i) return;
    this.difference = null;
    if (rows.start === null) {
      this.engine.start(rows.seed);
    } else {
      const why = this.engine.restore(rows.start.keyframe, rows.start.named);
      if (why !== null) throw new Error(why);
    }
    this.done = rows.first;
    this.rowsOfDone = i;
  }

  /** One step on; what is recorded of it is compared here too. */
  async step() {
    if (this.done >= this.segments[this.rowsOfDone].end) this.rowsOfDone += 1;
    const rows = this.rows.index === this.rowsOfDone ? this.rows : await this.load(this.rowsOfDone);
    const k = this.done - rows.first;
    const { difference } = provenStep(this.what, this.engine, rows, k);
    this.difference ??= difference;
    this.done += 1;
    // What was played from a keyframe or the start on is proven as by any other engine.
    if (this.done === rows.end || difference !== null) this.host.proved(rows.index, this.difference);
  }

  show() { return this.host.show(this.engine.view(), this.done, this.difference); }

  /** Goes to a moment; shows the keyframe on the way there first. */
  async seek(moment) {
    const order = ++this.order;
    const wanted = Math.min(Math.max(0, moment), this.steps);
    await this.begin(wanted);
    if (order !== this.order) return;
    let shown = performance.now();
    if (wanted - this.done > near) this.show();
    while (this.done < wanted) {
      await this.step();
      if (performance.now() - shown < slice) continue;
      await breath();
      if (order !== this.order) return;
      shown = performance.now();
    }
    await this.show();
    if (order === this.order) this.host.tell({ playing: false, moment: this.done, arrived: true });
  }

  /** Plays on from where it is. @param rate 1: in time */
  async play(rate) {
    const order = ++this.order;
    if (this.done < 0) await this.begin(0);
    let from = this.done;
    let began = performance.now();
    let drawing = null;
    let next = 0; // when the next picture is drawn
    let last = began;
    let lastDone = from;
    while (order === this.order && this.done < this.steps) {
      const now = performance.now();
      const due = from + (now - began) / 1000 * rate / this.stepSeconds;
      if (due > this.done + 0.25 / this.stepSeconds * rate) { // it cannot keep up: time runs slower
        from = this.done;
        began = now;
      }
      const stop = now + slice;
      while (this.done < Math.min(due, this.steps) && order === this.order && performance.now() < stop) await this.step();
      if (drawing === null && now >= next && order === this.order) {
        drawing = this.show().then(() => {
          drawing = null;
          next = performance.now() + (performance.now() - now); // where pictures take long, stepping gets half of the time alone
        });
      }
      if (now - last > 500) {
        this.host.tell({ playing: true, moment: this.done, speed: (this.done - lastDone) * this.stepSeconds / ((now - last) / 1000) });
        last = now;
        lastDone = this.done;
      }
      await breath(this.done >= due ? 4 : 0);
    }
    if (order !== this.order) return;
    await this.show();
    this.host.tell({ playing: false, moment: this.done, ended: this.done >= this.steps });
  }

  pause() {
    this.order += 1;
    this.host.tell({ playing: false, moment: this.done });
  }
}
