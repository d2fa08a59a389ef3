// SPDX-License-Identifier: GPL-3.0-or-later
// States between the recorded keyframes, left by engines that prove: whoever seeks later has a shorter way.
const most = 512 << 20; // bytes; a browser may move blobs to its disk
const pieces = 3; // that waypoints make of a segment
const shortest = 9; // steps of a segment that is worth it

/** Is a State to be kept after step k of a segment with so many steps? */
export function isWaypoint(k, steps) {
  if (steps < shortest) return false;
  for (let piece = 1; piece < pieces; ++piece)
    if (k + 1 === Math.round(piece * steps / pieces)) return true;
  return false;
}

export class Waypoints {
  constructor() {
    this.kept = new Map(); // by moment, the newest last: {moment, index, step, state, haptics, named, bytes}
    this.bytes = 0;
  }

  /** @param named sets that the last tick before named, by hand */
  keep({ moment, index, keyframe: { step, state, haptics }, named }) {
    if (this.kept.has(moment)) return;
    const bytes = state.length + haptics.length;
    this.kept.set(moment, { moment, index, step, state: new Blob([state]), haptics: new Blob([haptics]), named, bytes });
    this.bytes += bytes;
    for (const [oldest, { bytes: freed }] of this.kept) {
      if (this.bytes <= most) break;
      this.kept.delete(oldest);
      this.bytes -= freed;
    }
  }

  /** The last one of a segment that is not behind a moment, or null. */
  before(moment, index) {
    let best = null;
    for (const way of this.kept.values())
      if (way.index === index && way.moment <= moment && way.moment > (best?.moment ?? -1)) best = way;
    return best;
  }
}

/** What Waypoints.before() gave, on the side of an engine: {step, state, haptics}. */
export async function keyframeOf({ step, state, haptics }) {
  const [a, b] = await Promise.all([state.arrayBuffer(), haptics.arrayBuffer()]);
  return { step, state: new Uint8Array(a), haptics: new Uint8Array(b) };
}
