// SPDX-License-Identifier: GPL-3.0-or-later
// One opened recording: its reader, the engine that plays it, the engines that prove it.
import { listen } from './threads.js';
import { buffersOf } from './segment_rows.js';
import { Verification } from './verification.js';

let askers = 0; // of all attempts: a late answer to an earlier one must not be taken for another's

export class Attempt {
  /**
   * @param opened what the reader said @param threads {reader, player, engine: makes an engine's thread, size}
   * @param on ready(), player(state), tracks(data), judged(), changed(), failed(message)
   */
  constructor(opened, threads, on) {
    Object.assign(this, { opened, threads, on });
    this.stepSeconds = opened.tick * opened.ticks;
    this.steps = opened.counts.steps;
    this.waiting = new Map();
    this.verification = null;
    this.playing = false;
    this.moment = 0; // of the picture that is seen
    this.wanted = null; // moment that it is on the way to
    this.compared = new Map(); // differences by moment, of pictures on their way
    this.difference = null;
    this.chain = null; // how far the content chain was followed
    this.phases = null; // by step
    this.told = []; // events in words
    this.judgement = null;
    this.stopped = false;
    threads.player.postMessage({ kind: 'about', about: opened.comparison, segments: opened.segments });
  }

  /** Rows of a segment, from the reader. */
  read(index) {
    return new Promise((resolve, reject) => {
      const asker = ++askers;
      this.waiting.set(asker, { resolve, reject });
      this.threads.reader.postMessage({ kind: 'segment', index, asker });
    });
  }

  fromReader = {
    segment: ({ asker, rows, message }) => {
      const wait = this.waiting.get(asker);
      this.waiting.delete(asker);
      if (rows) wait?.resolve(rows);
      else wait?.reject(new Error(message));
    },
    tracks: (data) => this.on.tracks(data),
    chain: (m) => {
      this.chain = m;
      if (m.done) this.on.changed();
    },
    judged: (m) => {
      this.phases ??= new Uint8Array(this.steps);
      this.phases.set(m.phases, m.first);
      this.told.push(...m.told);
      this.judgement = m;
      if (m.done || m.told.length > 0) this.on.judged();
    },
    unjudged: () => {}, // there is nothing to judge, or it is of an earlier version
  };

  fromPlayer = {
    ready: ({ columns, result }) => {
      this.threads.reader.postMessage({ kind: 'columns', columns, result });
      this.on.ready();
    },
    'segment?': ({ index, asker }) => {
      const { player } = this.threads;
      this.read(index).then((found) => player.postMessage({ kind: 'answer', asker, found }, buffersOf(found)), (error) => player.postMessage({ kind: 'answer', asker, message: error.message }));
    },
    'waypoint?': ({ moment, asker }) => this.threads.player.postMessage({ kind: 'answer', asker, found: this.verification?.waypointBefore(moment) ?? null }),
    compared: ({ moment, difference }) => this.compared.set(moment, difference),
    player: (m) => {
      this.playing = m.playing;
      if (m.playing || m.arrived) this.wanted = null;
      // What is played is proven by that: where it cannot keep up, the others rest.
      const slow = m.speed !== undefined && m.speed < 0.9 * this.rate;
      this.verification?.attention(m.moment, m.playing ? (slow ? 'alone' : 'play') : '');
      this.on.player(m);
    },
    proved: (m) => this.verification?.proved(null, m),
    failed: ({ message }) => {
      this.verification?.attention(this.moment, '');
      this.on.failed(message);
    },
  };

  /** A picture is there: this moment is what is looked at. */
  drawn(moment) {
    this.moment = moment;
    if (this.compared.has(moment)) this.difference = this.compared.get(moment);
    this.compared.clear();
  }

  /** Begins to prove; called when the first picture is there, which comes first. */
  prove() {
    if (this.verification || this.stopped) return;
    const { opened, threads } = this;
    this.verification = new Verification(opened.segments, threads.size, () => {
      const thread = threads.engine();
      thread.postMessage({ kind: 'scene', files: opened.files });
      thread.postMessage({ kind: 'about', about: opened.comparison, segments: opened.segments });
      return thread;
    }, (index) => this.read(index), () => this.on.changed());
    threads.reader.postMessage({ kind: 'tracks' });
  }

  /** So many steps from where it is, or is on the way to. */
  seekBy(steps) { this.seek((this.wanted ?? this.moment) + steps); }

  seek(moment) {
    this.playing = false;
    const wanted = Math.max(0, Math.min(this.steps, Math.round(moment)));
    this.wanted = wanted;
    this.threads.player.postMessage({ kind: 'seek', moment: wanted });
    this.verification?.attention(wanted, 'seek');
  }
  play(rate) {
    this.playing = true;
    this.rate = rate;
    this.threads.player.postMessage({ kind: 'play', rate });
    this.verification?.attention(this.moment, 'play');
  }
  pause() {
    this.playing = false;
    this.threads.player.postMessage({ kind: 'pause' });
  }
  end() {
    this.stopped = true;
    this.verification?.end();
  }
}
