// SPDX-License-Identifier: GPL-3.0-or-later
// Re-simulates for the eye: goes to a moment, and on from it in time. A moment is a number of steps done.
import { breath } from './breath.js';
import { segmentOf, withEvents } from './segment_rows.js';
import { comparison, provenStep } from './verifier.js';
import { keyframeOf } from './waypoints.js';

const slice = 40; // ms of stepping before messages are looked at
const patience = 300; // ms of a seek before a picture on the way is shown

export class Player {
  /** @param host segment(i): its rows; waypoint(moment): a State before it; show(view, moment, difference): a picture, resolves when it is drawn; tell(state); proved(i, difference) */
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

  /** @return a segment's rows, or null where a newer wish came meanwhile */
  async load(i, order) {
    if (this.rows?.index === i) return this.rows;
    const rows = withEvents(await this.host.segment(i));
    if (order !== this.order) return null;
    this.rows = rows;
    return rows;
  }

  /** Starts at the beginning, or at the nearest State before a moment that is known. @return whether the wish still stands */
  async begin(moment, order) {
    const i = segmentOf(this.segments, moment);
    const rows = await this.load(i, order);
    const way = rows && await this.host.waypoint(moment);
    const from = way ? { keyframe: await keyframeOf(way), named: way.named } : rows?.start;
    if (order !== this.order) return false;
    const first = way ? way.moment : rows.first;
    if (this.done >= first && this.done <= moment && this.rowsOfDone === i) return true;
    this.difference = null;
    if (from === null) {
      this.engine.start(rows.seed);
    } else {
      const why = this.engine.restore(from.keyframe, from.named);
      if (why !== null) throw new Error(why);
    }
    this.done = first;
    this.rowsOfDone = i;
    return true;
  }

  /** One step on; what is recorded of it is compared here too. @return whether the wish still stands */
  async step(order) {
    if (this.done >= this.segments[this.rowsOfDone].end) this.rowsOfDone += 1;
    const rows = await this.load(this.rowsOfDone, order);
    if (rows === null || order !== this.order) return false;
    const { difference } = provenStep(this.what, this.engine, rows, this.done - rows.first);
    this.difference ??= difference;
    this.done += 1;
    // What was played from a keyframe or the start on is proven as by any other engine.
    if (this.done === rows.end || difference !== null) this.host.proved(rows.index, this.difference);
    return true;
  }

  show() { return this.host.show(this.engine.view(), this.done, this.difference); }

  /** Goes to a moment; where that takes a while, it shows one on the way there. */
  async seek(moment) {
    const order = ++this.order;
    const wanted = Math.min(Math.max(0, moment), this.steps);
    if (!await this.begin(wanted, order)) return;
    const began = performance.now();
    let rested = began;
    let shown = false;
    while (this.done < wanted) {
      if (!await this.step(order)) return;
      if (performance.now() - rested < slice) continue;
      if (!shown && performance.now() - began > patience) {
        shown = true;
        this.show();
      }
      await breath();
      if (order !== this.order) return;
      rested = performance.now();
    }
    await this.show();
    if (order === this.order) this.host.tell({ playing: false, moment: this.done, arrived: true });
  }

  /** Plays on from where it is. @param rate 1: in time */
  async play(rate) {
    const order = ++this.order;
    if (this.done < 0 && !await this.begin(0, order)) return;
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
      while (this.done < Math.min(due, this.steps) && performance.now() < stop && await this.step(order));
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
