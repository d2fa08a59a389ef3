// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that turns around a point. World: z up; camera: x right, y down, z forward.

const sub = (a, b) => a.map((x, i) => x - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((x) => x / n); };

/** Unit quaternion w x y z of the rotation whose columns are given. */
function quaternion(x, y, z) {
  const [m00, m10, m20, m01, m11, m21, m02, m12, m22] = [...x, ...y, ...z];
  const trace = m00 + m11 + m22;
  if (trace > 0) {
    const s = 2 * Math.sqrt(trace + 1);
    return [s / 4, (m21 - m12) / s, (m02 - m20) / s, (m10 - m01) / s];
  }
  if (m00 > m11 && m00 > m22) {
    const s = 2 * Math.sqrt(1 + m00 - m11 - m22);
    return [(m21 - m12) / s, s / 4, (m01 + m10) / s, (m02 + m20) / s];
  }
  if (m11 > m22) {
    const s = 2 * Math.sqrt(1 + m11 - m00 - m22);
    return [(m02 - m20) / s, (m01 + m10) / s, s / 4, (m12 + m21) / s];
  }
  const s = 2 * Math.sqrt(1 + m22 - m00 - m11);
  return [(m10 - m01) / s, (m02 + m20) / s, (m12 + m21) / s, s / 4];
}

export class Orbit {
  constructor() {
    this.field = 0.7; // rad
    this.home = null;
    Object.assign(this, { centre: [0, 0, 0], yaw: 0, pitch: 0.3, distance: 0.3, least: 0.02, most: 1 });
  }

  /** Where it begins: beside the endoscope. @param extent centre and radius @param camera of the endoscope */
  set(extent, camera) {
    const centre = extent.slice(0, 3);
    const radius = Math.max(extent[3], 0.01);
    const from = sub(camera.slice(0, 3), centre);
    const yaw = Math.atan2(from[1], from[0]);
    const pitch = Math.asin(Math.max(-0.9, Math.min(0.9, unit(from)[2])));
    this.home = { centre, yaw: yaw + 0.6, pitch: Math.max(0.25, Math.min(1.2, pitch + 0.15)), distance: 3.6 * radius, least: 0.8 * radius, most: 12 * radius };
    this.reset();
  }
  reset() { Object.assign(this, this.home, { centre: [...this.home.centre] }); }
  turn(dx, dy) {
    this.yaw -= dx;
    this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch + dy));
  }
  zoom(factor) { this.distance = Math.max(this.least, Math.min(this.most, this.distance * factor)); }

  axes() {
    const back = [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch)];
    const forward = back.map((x) => -x);
    const right = unit(cross(forward, [0, 0, 1]));
    return { back, forward, right, down: cross(forward, right) };
  }
  /** Moves the turning point across the picture. @param dx, dy shares of the picture's height */
  shift(dx, dy) {
    const { right, down } = this.axes();
    const height = 2 * this.distance * Math.tan(this.field / 2);
    this.centre = this.centre.map((c, i) => c - height * (dx * right[i] + dy * down[i]));
  }
  /** Position, orientation (w x y z), vertical field of view. */
  camera() {
    const { back, forward, right, down } = this.axes();
    const eye = this.centre.map((c, i) => c + this.distance * back[i]);
    return Float64Array.from([...eye, ...quaternion(right, down, forward), this.field]);
  }
}
