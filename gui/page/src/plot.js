// SPDX-License-Identifier: GPL-3.0-or-later
// A curve over time in so many columns of pixels: each column shows what it covers, so that no peak is lost.

/** Rounds up to 1, 2 or 5 times a power of ten. */
export function niceTop(x) {
  if (!(x > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= x * 0.999);
}

/** A value that few steps exceed: one outlier must not flatten all else. */
export function highest(values) {
  const sorted = Float32Array.from(values).sort();
  return sorted[Math.floor(0.999 * (sorted.length - 1))] || 0;
}

/** Draws values of [from, to) into a box. @param y maps a value to pixels */
export function curve(context, values, from, to, left, width, y) {
  context.beginPath();
  const perPixel = (to - from) / width;
  for (let x = 0; x < width; ++x) {
    const a = Math.max(0, Math.floor(from + x * perPixel));
    const b = Math.min(values.length, Math.max(a + 1, Math.floor(from + (x + 1) * perPixel)));
    let low = Infinity;
    let high = -Infinity;
    for (let i = a; i < b; ++i) {
      low = Math.min(low, values[i]);
      high = Math.max(high, values[i]);
    }
    if (high < low) continue;
    if (x === 0) context.moveTo(left, y(high));
    context.lineTo(left + x + 0.5, y(high));
    if (y(low) - y(high) > 0.5) context.lineTo(left + x + 0.5, y(low));
  }
  context.stroke();
}

/** Distance of ticks on a time axis (s) so that they are at least so many pixels apart. */
export function tickDistance(secondsPerPixel, least) {
  return [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600].find((d) => d / secondsPerPixel >= least) ?? 1200;
}
