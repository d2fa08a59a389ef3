// SPDX-License-Identifier: GPL-3.0-or-later
// An engine of one simulation version, asked in its protocol (schemas/engine.md; recorder/engine/wire.h).
import { Reader, Writer } from './bytes.js';
import { instantiate } from './wasm_host.js';

const headBytes = 12;
const magic = new TextEncoder().encode('CALOTENG');
const Kind = { hello: 1, scene: 2, start: 3, restore: 4, step: 5, keyframe: 6, view: 7, explain: 8 };
const refused = 104;
const fault = 199;

export const want = { keyframe: 1, view: 4 };

/** What the engine says when it ends. */
export class EngineFault extends Error {}

export class Engine {
  /** @param module compiled WebAssembly of the engine */
  constructor(module) {
    this.exports = instantiate(module);
    const hello = new Writer();
    hello.raw(magic);
    hello.u4(1);
    const r = this.ask(Kind.hello, hello.done());
    r.raw(magic.length);
    r.u4();
    this.simulation = r.u4();
    this.result = r.u4();
    this.software = r.str();
  }

  /** Sends one request. @return a reader over a copy of the answer's payload */
  ask(kind, payload) {
    const { exports } = this;
    const place = exports.calot_request(headBytes + payload.length) >>> 0;
    const view = new DataView(exports.memory.buffer, place, headBytes);
    view.setUint32(0, kind, true);
    view.setBigUint64(4, BigInt(payload.length), true);
    new Uint8Array(exports.memory.buffer, place + headBytes, payload.length).set(payload);
    let answer = 0;
    try {
      answer = exports.calot_answer() >>> 0;
    } catch (error) {
      answer = exports.calot_fault() >>> 0;
      if (answer === 0) throw new EngineFault(`the engine failed: ${error.message}`);
    }
    if (answer === 0) throw new EngineFault('the engine has ended');
    const head = new DataView(exports.memory.buffer, answer, headBytes);
    this.answered = head.getUint32(0, true);
    const reader = new Reader(new Uint8Array(exports.memory.buffer, answer + headBytes, Number(head.getBigUint64(4, true))).slice());
    if (this.answered !== fault) return reader;
    reader.u4();
    throw new EngineFault(reader.str());
  }

  /** @param files the scene file first, then what it names: {name, content} */
  scene(files) {
    const w = new Writer();
    w.u8(files.length);
    for (const { name, content } of files) {
      w.str(name);
      w.blob(content);
    }
    const r = this.ask(Kind.scene, w.done());
    this.ticks = r.u4();
    this.tick = r.f8();
    this.components = r.list(() => r.str());
    this.fields = r.list(() => ({ component: r.u4(), name: r.str() }));
    this.structures = r.list(() => r.str());
    this.columns = r.list(() => ({ path: r.str(), type: r.str(), width: r.u4() }));
  }

  start(seed) {
    const w = new Writer();
    w.u8(seed);
    this.ask(Kind.start, w.done());
  }

  /** @param named sets that the last tick before named, by hand @return why it is refused, or null */
  restore({ step, state, haptics }, named) {
    const w = new Writer(state.length + haptics.length + 64);
    writeKeyframe(w, { step, state, haptics });
    w.u1(1);
    for (const set of named) w.i8(set);
    const r = this.ask(Kind.restore, w.done());
    return this.answered === refused ? r.str() : null;
  }

  /** @param ticks payload of the step's ticks, as encodeTicks() makes it */
  step(wanted, lateness, ticks) {
    const w = new Writer(ticks.length + 16);
    w.u1(wanted);
    w.f4(lateness);
    w.raw(ticks);
    return parseStep(this.ask(Kind.step, w.done()));
  }

  /** Payload of the scene view after the last step. */
  view() { return this.ask(Kind.view, new Uint8Array(0)).bytes; }

  /** The first field in which a recorded keyframe differs from the engine's own, or null. */
  explain(keyframe) {
    const w = new Writer(keyframe.state.length + keyframe.haptics.length + 64);
    writeKeyframe(w, keyframe);
    const r = this.ask(Kind.explain, w.done());
    return r.u1() === 0 ? null : { field: r.str(), detail: r.str() };
  }
}

function writeKeyframe(w, { step, state, haptics }) {
  w.u8(step);
  w.blob(state);
  w.blob(haptics);
}

function parseStep(r) {
  const step = Number(r.u8());
  const forces = r.raw(96 * r.count()); // of each tick: left force and torque, right force and torque
  const components = r.raw(8 * r.count());
  const fields = r.raw(4 * r.count());
  const events = r.raw(44 * r.count());
  const results = r.blob();
  const keyframe = parseKeyframe(r.blob());
  r.blob();
  const view = r.blob();
  return { step, forces, components, fields, events, results, keyframe, view };
}

function parseKeyframe(bytes) {
  if (bytes.length === 0) return null;
  const r = new Reader(bytes);
  return { step: Number(r.u8()), state: r.blob(), haptics: r.blob() };
}
