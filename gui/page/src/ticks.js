// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded ticks as an engine takes them.
import { Writer } from './bytes.js';

/**
 * The list of ticks of one step. @param rows of a segment: typed arrays by name, hand by hand
 * @param first index of the step's first tick in them
 */
export function encodeTicks(rows, first, count) {
  const w = new Writer(8 + 226 * count);
  w.u8(count);
  for (let i = first; i < first + count; ++i) {
    for (const hand of rows.hands) {
      for (let a = 0; a < 3; ++a) w.f8(hand.position[3 * i + a]);
      for (let a = 0; a < 4; ++a) w.f8(hand.orientation[4 * i + a]);
      w.f8(hand.jaw[i]);
      w.u1(hand.instrument[i]);
      w.u1(hand.buttons[i]);
      w.u1(hand.valid[i]);
      w.i8(hand.contact_set[i]);
    }
    for (let a = 0; a < 3; ++a) w.f8(rows.camera.position[3 * i + a]);
    for (let a = 0; a < 4; ++a) w.f8(rows.camera.orientation[4 * i + a]);
    w.f4(rows.lateness[i]);
  }
  return w.done();
}
