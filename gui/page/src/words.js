// SPDX-License-Identifier: GPL-3.0-or-later
// Words for what a recording numbers. Those for events come from the module that judges.

export const instruments = ['none', 'grasper', 'hook', 'clip applier', 'scissors', 'probe'];
export const phases = ['', 'identification', 'clipping', 'cutting', 'dissection', 'done'];
/** Seconds as minutes:seconds.hundredths. */
export function clock(seconds) {
  const hundredths = Math.round(seconds * 100);
  const m = Math.floor(hundredths / 6000);
  const s = Math.floor(hundredths / 100) % 60;
  return `${m}:${String(s).padStart(2, '0')}.${String(hundredths % 100).padStart(2, '0')}`;
}
