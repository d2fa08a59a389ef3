// SPDX-License-Identifier: GPL-3.0-or-later
// The time line: what is proven, phases, events, forces and speed over time, and the moment that is looked at.
import { curve, highest, niceTop, tickDistance } from './plot.js';
import { State } from './verification.js';
import { clock, phases } from './words.js';

const gutter = 92;
const rightEdge = 14;
export const colours = { left: '#6cb6ff', right: '#ffb35c', open: '#3a424d', running: '#56606e', consistent: '#2b8a80', verified: '#3fb568', differs: '#f0524f', text: '#c9d1d9', faint: '#8b95a1', line: '#2a313a' };
const phaseColours = ['#2a313a', '#8a7bd1', '#4f9bd1', '#d1715a', '#b59a4a', '#4fae7a'];
const font = '12px system-ui, sans-serif';

export class Timeline {
  /** @param seek called with a moment (steps done) and whether the hand still moves */
  constructor(canvas, tip, seek) {
    Object.assign(this, { canvas, tip, seek });
    this.data = null;
    this.moment = 0;
    this.background = document.createElement('canvas');
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.listen();
  }

  /** @param data {steps, stepSeconds, verification, events, phases, force, speed} */
  set(data) {
    this.data = data;
    this.tops = null;
    this.paint();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: w, clientHeight: h } = this.canvas;
    for (const c of [this.canvas, this.background]) {
      c.width = Math.round(w * ratio);
      c.height = Math.round(h * ratio);
    }
    this.paint();
  }

  get width() { return Math.max(10, this.canvas.clientWidth - gutter - rightEdge); }
  x(step) { return gutter + step / this.data.steps * this.width; }
  stepAt(x) { return Math.round(Math.max(0, Math.min(1, (x - gutter) / this.width)) * this.data.steps); }

  /** Tracks from top to bottom: {name, y, h}. */
  tracks() {
    const fixed = [['proof', 14], ['phase', 16], ['events', 18]];
    const axis = 20;
    const space = 5;
    const h = this.canvas.clientHeight;
    let y = 6;
    const out = {};
    for (const [name, height] of fixed) {
      out[name] = { y, h: height };
      y += height + space;
    }
    const plot = Math.max(20, (h - y - axis - 12) / 2);
    out.force = { y: y + 2, h: plot };
    out.speed = { y: y + plot + 10, h: plot };
    out.axis = { y: h - axis, h: axis };
    return out;
  }

  /** Everything but the moment; kept, since the moment changes with every picture. */
  paint() {
    if (this.background.width === 0) return;
    const c = this.background.getContext('2d');
    const ratio = window.devicePixelRatio || 1;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    if (this.data) {
      const t = this.tracks();
      this.paintProof(c, t);
      this.paintPhases(c, t.phase);
      this.paintEvents(c, t.events);
      this.paintPlot(c, t.force, 'Force', 'N', this.data.force, 1);
      this.paintPlot(c, t.speed, 'Speed', 'mm/s', this.data.speed, 1000);
      this.paintAxis(c, t);
    }
    this.show(this.moment);
  }

  label(c, text, y, unit = '') {
    c.font = font;
    c.textAlign = 'left';
    c.textBaseline = 'middle';
    c.fillStyle = colours.text;
    c.fillText(text, 10, y);
    if (unit === '') return;
    c.fillStyle = colours.faint;
    c.fillText(`(${unit})`, 10, y + 15);
  }

  paintProof(c, t) {
    const { verification, steps } = this.data;
    const { y, h } = t.proof;
    this.label(c, 'Proof', y + h / 2);
    c.fillStyle = colours.open;
    c.fillRect(gutter, y, this.width, h);
    if (!verification) return;
    const good = verification.verified ? colours.verified : colours.consistent;
    const below = t.axis.y - y;
    for (const [i, { first, end }] of verification.segments.entries()) {
      const state = verification.state[i];
      const [a, b] = [this.x(first), this.x(end)];
      if (state === State.consistent) {
        c.fillStyle = good;
        c.fillRect(a, y, b - a + 0.5, h);
        continue;
      }
      if (state === State.differs) {
        c.fillStyle = colours.differs;
        c.fillRect(a, y, Math.max(2, b - a), h);
        continue;
      }
      this.hatch(c, a, y, b - a, below);
      if (state === State.running) {
        c.fillStyle = colours.consistent;
        c.fillRect(a, y + h - 4, this.x(Math.min(steps, first + verification.steps[i])) - a, 4);
      }
    }
    if (verification.difference) {
      const x = this.x(verification.difference.step);
      c.fillStyle = colours.differs;
      c.fillRect(x - 1, y - 4, 2, below + 4);
    }
  }

  /** What is not proven is hatched, in all tracks. */
  hatch(c, x, y, w, h) {
    if (!this.pattern) {
      const tile = document.createElement('canvas');
      tile.width = tile.height = 8;
      const p = tile.getContext('2d');
      p.strokeStyle = 'rgba(140, 150, 165, 0.22)';
      p.beginPath();
      for (const d of [-8, 0, 8]) {
        p.moveTo(d, 8);
        p.lineTo(d + 8, 0);
      }
      p.stroke();
      this.pattern = c.createPattern(tile, 'repeat');
    }
    c.fillStyle = this.pattern;
    c.fillRect(x, y, w, h);
  }

  paintPhases(c, { y, h }) {
    const { phases: runs } = this.data;
    this.label(c, 'Phase', y + h / 2);
    if (!runs) return;
    for (const { first, end, phase } of runs) {
      const [a, b] = [this.x(first), this.x(end)];
      c.fillStyle = phaseColours[phase] ?? phaseColours[0];
      c.fillRect(a, y, Math.max(1, b - a), h);
      const name = phases[phase] ?? '';
      c.font = font;
      if (c.measureText(name).width + 8 > b - a) continue;
      c.fillStyle = '#0b0d10';
      c.textAlign = 'left';
      c.fillText(name, a + 4, y + h / 2 + 0.5);
    }
  }

  paintEvents(c, { y, h }) {
    const { events } = this.data;
    this.label(c, 'Events', y + h / 2);
    c.fillStyle = colours.line;
    c.fillRect(gutter, y + h / 2, this.width, 1);
    for (const { step, fault } of events ?? []) {
      const x = this.x(step + 1);
      c.fillStyle = fault ? colours.differs : colours.text;
      c.beginPath();
      if (fault) {
        c.moveTo(x, y + 2);
        c.lineTo(x + 5.5, y + h - 3);
        c.lineTo(x - 5.5, y + h - 3);
      } else {
        c.arc(x, y + h / 2, 3.5, 0, 2 * Math.PI);
      }
      c.fill();
    }
  }

  paintPlot(c, { y, h }, name, unit, series, scale) {
    this.label(c, name, y + h / 2 - 8, unit);
    c.strokeStyle = colours.line;
    c.strokeRect(gutter + 0.5, y + 0.5, this.width - 1, h - 1);
    if (!series) return;
    this.tops ??= {};
    const top = this.tops[name] ??= niceTop(scale * Math.max(...series.map(highest)));
    const at = (value) => y + h - 1 - Math.min(1, value * scale / top) * (h - 3);
    c.fillStyle = colours.faint;
    c.font = '11px system-ui, sans-serif';
    c.textAlign = 'right';
    c.fillText(`${top}`, gutter - 5, y + 6);
    c.fillText('0', gutter - 5, y + h - 5);
    c.lineWidth = 1;
    for (const [i, hand] of ['left', 'right'].entries()) {
      c.strokeStyle = colours[hand];
      curve(c, series[i], 0, this.data.steps, gutter, this.width, at);
    }
  }

  paintAxis(c, t) {
    const seconds = this.data.steps * this.data.stepSeconds;
    const distance = tickDistance(seconds / this.width, 70);
    c.fillStyle = colours.faint;
    c.font = '11px system-ui, sans-serif';
    c.textBaseline = 'middle';
    for (let s = 0; s <= seconds + 1e-9; s += distance) {
      const x = this.x(s / this.data.stepSeconds);
      c.fillRect(x, t.axis.y - 1, 1, 5);
      c.textAlign = x > gutter + this.width - 30 ? 'right' : s === 0 ? 'left' : 'center';
      c.fillText(distance < 1 ? s.toFixed(1) : `${Math.floor(s / 60)}:${String(Math.round(s % 60)).padStart(2, '0')}`, x, t.axis.y + 12);
    }
    c.textAlign = 'left';
    c.fillStyle = colours.text;
    c.font = font;
    c.fillText('Time', 10, t.axis.y + 11);
    c.fillStyle = colours.faint;
    c.fillText('(min:s)', 42, t.axis.y + 11);
  }

  /** The moment that is looked at. */
  show(moment) {
    this.moment = moment;
    const { canvas } = this;
    const c = canvas.getContext('2d');
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    if (this.background.width > 0) c.drawImage(this.background, 0, 0);
    if (!this.data) return;
    const ratio = window.devicePixelRatio || 1;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    const x = this.x(moment);
    c.fillStyle = '#ffffff';
    c.fillRect(x - 0.75, 2, 1.5, this.tracks().axis.y);
    c.beginPath();
    c.moveTo(x - 5, 0);
    c.lineTo(x + 5, 0);
    c.lineTo(x, 7);
    c.fill();
  }

  listen() {
    const { canvas } = this;
    let held = false;
    const moment = (e) => this.stepAt(e.clientX - canvas.getBoundingClientRect().left);
    canvas.addEventListener('pointerdown', (e) => {
      if (!this.data) return;
      held = true;
      canvas.setPointerCapture(e.pointerId);
      this.seek(moment(e));
    });
    canvas.addEventListener('pointermove', (e) => {
      if (!this.data) return;
      if (held) this.seek(moment(e));
      this.hover(e);
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => { held = false; });
    canvas.addEventListener('pointerleave', () => { this.tip.hidden = true; });
  }

  /** What is under the hand: time, and the event that is there. */
  hover(e) {
    const box = this.canvas.getBoundingClientRect();
    const x = e.clientX - box.left;
    if (x < gutter - 2 || x > gutter + this.width + 2) {
      this.tip.hidden = true;
      return;
    }
    const step = this.stepAt(x);
    const near = (this.data.events ?? []).filter((v) => Math.abs(this.x(v.step + 1) - x) < 6).slice(0, 4);
    const { force, speed, stepSeconds } = this.data;
    const n = Math.min(step, this.data.steps - 1);
    const lines = [clock(step * stepSeconds), ...near.map((v) => v.text)];
    if (force) lines.push(`force L ${force[0][n].toFixed(2)} N, R ${force[1][n].toFixed(2)} N`, `speed L ${(1000 * speed[0][n]).toFixed(0)}, R ${(1000 * speed[1][n]).toFixed(0)} mm/s`);
    this.tip.textContent = lines.join('\n');
    this.tip.hidden = false;
    const left = Math.min(e.clientX + 12, window.innerWidth - this.tip.offsetWidth - 8);
    this.tip.style.left = `${left}px`;
    this.tip.style.top = `${box.top - this.tip.offsetHeight - 6}px`;
  }
}
