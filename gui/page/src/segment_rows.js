// SPDX-License-Identifier: GPL-3.0-or-later
// Segments, and their rows on the side of an engine.

/** Adds what is looked up step by step to the rows that came from the reader. */
export function withEvents(rows) {
  const { events } = rows;
  const view = new DataView(events.buffer, events.byteOffset, events.byteLength);
  const count = events.length / 45;
  let at = 0; // steps are asked for in their order
  rows.eventsOf = (step) => {
    const stepOf = (i) => Number(view.getBigUint64(45 * i, true));
    if (at > 0 && stepOf(at - 1) >= step) at = 0;
    while (at < count && stepOf(at) < step) ++at;
    let end = at;
    while (end < count && stepOf(end) === step) ++end;
    return events.subarray(45 * at, 45 * end);
  };
  return rows;
}

/** Index of the segment in which a moment is reached; the end is, from the last keyframe before it. */
export function segmentOf(segments, moment) {
  const found = segments.findIndex((s) => moment < s.end);
  return found < 0 ? segments.length - 1 : found;
}

/** What of a segment's rows can be handed over to another thread. */
export function buffersOf(value, found = new Set()) {
  if (ArrayBuffer.isView(value)) found.add(value.buffer);
  else if (Array.isArray(value)) value.forEach((v) => buffersOf(v, found));
  else if (value && typeof value === 'object') Object.values(value).forEach((v) => buffersOf(v, found));
  return [...found];
}
