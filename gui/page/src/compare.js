// SPDX-License-Identifier: GPL-3.0-or-later
// One re-simulated step beside the recorded one, bit for bit, in the order in which `calot replay` compares.
import { same } from './bytes.js';
import { place } from './wasm_host.js';

const handNames = ['left', 'right'];
const forceGrid = 2 ** -14; // N
const torqueGrid = 2 ** -20; // N m
const eventFields = [['step', 0, 8], ['kind', 8, 2], ['hand', 10, 1], ['subject', 11, 2], ['position', 13, 24], ['value', 37, 8]];
const readers = { f8: [8, 'getFloat64'], f4: [4, 'getFloat32'], u1: [1, 'getUint8'], u2: [2, 'getUint16'], u4: [4, 'getUint32'], u8: [8, 'getBigUint64'], i8: [8, 'getBigInt64'] };

const rounded = (x, grid) => Math.floor(x / grid + 0.5) * grid;
const row = (bytes, i, size) => bytes.subarray(i * size, (i + 1) * size);

function digest(proof, bytes) {
  place(proof, bytes);
  return BigInt.asUintN(64, proof.calot_digest(bytes.length));
}
const u8At = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, 8).getBigUint64(0, true);

/**
 * @param what {recording: about format and fields, engine, proof} @param rows of the segment
 * @param k the step's index in the segment @param answer the engine's
 * @return the first difference, or null
 */
export function compareStep(what, rows, k, answer) {
  return forces(what, rows, k, answer) ?? digests(what, rows, k, answer) ?? (what.golden ? null : results(what, rows, k, answer)) ?? events(rows, k, answer);
}

function forces({ golden, format, proof }, rows, k, answer) {
  const { step } = answer;
  const here = new Float64Array(answer.forces.slice().buffer);
  for (let i = 0; !golden && i < rows.ticks; ++i) {
    for (let h = 0; h < 2; ++h) {
      for (const [name, offset, grid] of [['force', 0, forceGrid], ['torque', 3, torqueGrid]]) {
        for (let a = 0; a < 3; ++a) {
          const recorded = rows.hands[h][name][3 * (k * rows.ticks + i) + a];
          const exact = here[12 * i + 6 * h + offset + a];
          const value = format === 1 ? exact : rounded(exact, grid);
          if (Object.is(recorded, value)) continue;
          return { step, tick: step * rows.ticks + i, component: `force.${handNames[h]}`, field: `${name}[${a}]`, detail: `recorded ${recorded}, here ${value}` };
        }
      }
    }
  }
  const recorded = rows.digests.force_digest;
  if (recorded && u8At(row(recorded, k, 8)) !== digest(proof, answer.forces)) return { step, component: 'force', field: "digest of the step's forces", detail: '' };
  return null;
}

function digests({ format, proof, components, fields, fieldComponent }, rows, k, answer) {
  const { step } = answer;
  const { component_digest: ofComponents, state_digest: ofState, field_digest: ofFields } = rows.digests;
  const size = format === 1 ? 4 : 2;
  let field = -1;
  for (let f = 0; ofFields && f < fields.length && field < 0; ++f) {
    const recorded = ofFields.subarray((k * fields.length + f) * size, (k * fields.length + f + 1) * size);
    if (!same(recorded, answer.fields.subarray(4 * f, 4 * f + size))) field = f;
  }
  if (ofState) {
    const equal = u8At(row(ofState, k, 8)) === digest(proof, answer.components);
    if (equal && field < 0) return null;
    if (field < 0) return { step, component: 'state', field: 'a field that only the long digest shows', detail: '' };
    const component = components[fieldComponent[field]];
    if (equal) return { step, component: 'digest', field: fields[field], detail: '' };
    return { step, component, field: fields[field].slice(component.length + 1), detail: '' };
  }
  for (let c = 0; ofComponents && c < components.length; ++c) {
    const at = k * components.length + c;
    if (same(ofComponents.subarray(8 * at, 8 * at + 8), answer.components.subarray(8 * c, 8 * c + 8))) continue;
    const named = field >= 0 && fieldComponent[field] === c ? fields[field].slice(components[c].length + 1) : 'a field';
    return { step, component: components[c], field: named, detail: '' };
  }
  return field < 0 ? null : { step, component: 'digest', field: fields[field], detail: '' };
}

function results({ columns, columnSizes }, rows, k, answer) {
  for (let at = 0, c = 0; c < columns.length; ++c) {
    const size = columnSizes[c];
    const recorded = row(rows.columns[c], k, size);
    const here = answer.results.subarray(at, at + size);
    at += size;
    if (same(recorded, here)) continue;
    const [width, get] = readers[columns[c].type];
    let i = 0;
    while (same(recorded.subarray(i * width, (i + 1) * width), here.subarray(i * width, (i + 1) * width))) ++i;
    const value = (bytes) => new DataView(bytes.buffer, bytes.byteOffset)[get](i * width, true);
    const index = columns[c].width > 1 ? `[${i}]` : '';
    return { step: answer.step, component: 'observables', field: `${columns[c].path}${index}`, detail: `recorded ${value(recorded)}, here ${value(here)}` };
  }
  return null;
}

/** An event of the protocol (44 bytes) as a row of /events (45 bytes): its kind has two bytes there. */
export function eventRow(bytes) {
  const out = new Uint8Array(45);
  out.set(bytes.subarray(0, 9));
  out.set(bytes.subarray(9), 10);
  return out;
}

function events(rows, k, answer) {
  const { step } = answer;
  const recorded = rows.eventsOf(step);
  const n = answer.events.length / 44;
  if (recorded.length / 45 !== n) return { step, component: 'events', field: 'number', detail: `recorded ${recorded.length / 45}, here ${n}` };
  for (let e = 0; e < n; ++e) {
    const here = eventRow(row(answer.events, e, 44));
    const there = row(recorded, e, 45);
    const differs = eventFields.find(([, at, size]) => !same(here.subarray(at, at + size), there.subarray(at, at + size)));
    if (differs) return { step, component: 'events', field: `${e}/${differs[0]}`, detail: '' };
  }
  return null;
}
