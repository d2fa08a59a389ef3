// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures: which of them are seen, where, and the hand that turns one of them.
import { Orbit } from './orbit.js';

const gap = 6; // CSS pixels
const mostPixels = 1_400_000; // of all panes: beyond that pictures take too long
const views = ['both', 'endoscope', 'orbit'];

export class Stage {
  /** @param send posts to the thread that draws */
  constructor(element, labels, send) {
    Object.assign(this, { element, labels, send });
    this.view = 'both';
    this.orbit = new Orbit();
    this.panes = [];
    this.pointers = new Map();
    new ResizeObserver(() => this.lay()).observe(element);
    this.listen();
  }

  choose(view) {
    this.view = view;
    this.lay();
  }
  cycle() { this.choose(views[(views.indexOf(this.view) + 1) % views.length]); return this.view; }

  lay() {
    const { clientWidth: w, clientHeight: h } = this.element;
    if (w < 32 || h < 32) return;
    const kinds = this.view === 'both' ? ['endoscope', 'orbit'] : [this.view];
    const stacked = h > w;
    const scale = Math.min(window.devicePixelRatio || 1, Math.sqrt(mostPixels / (w * h)));
    const px = (x) => Math.round(x * scale);
    const n = kinds.length;
    const [pw, ph] = stacked ? [w, (h - gap * (n - 1)) / n] : [(w - gap * (n - 1)) / n, h];
    this.panes = kinds.map((kind, i) => ({ kind, left: stacked ? 0 : i * (pw + gap), top: stacked ? i * (ph + gap) : 0, w: pw, h: ph }));
    // All of one size: the renderer makes its targets anew where sizes change.
    const [width, height] = [Math.floor(pw * scale), Math.floor(ph * scale)];
    this.send({ kind: 'panes', width: px(w), height: px(h), panes: this.panes.map((p) => ({ kind: p.kind, x: px(p.left), y: px(p.top), width, height })) });
    for (const [kind, label] of Object.entries(this.labels)) {
      const pane = this.panes.find((p) => p.kind === kind);
      label.hidden = !pane;
      if (pane) Object.assign(label.style, { left: `${pane.left + 10}px`, top: `${pane.top + 8}px` });
    }
  }

  seen({ extent, camera }) {
    if (this.orbit.home === null) {
      this.orbit.set(extent, camera);
      this.turned();
    }
  }
  forget() { this.orbit.home = null; }
  turned() { if (this.orbit.home) this.send({ kind: 'orbit', camera: this.orbit.camera() }); }
  home() {
    if (!this.orbit.home) return;
    this.orbit.reset();
    this.turned();
  }

  paneAt(event) {
    const box = this.element.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    return this.panes.find((p) => x >= p.left && x < p.left + p.w && y >= p.top && y < p.top + p.h);
  }

  listen() {
    const { element, orbit, pointers } = this;
    element.addEventListener('pointerdown', (e) => {
      if (this.paneAt(e)?.kind !== 'orbit' || !orbit.home) return;
      element.setPointerCapture(e.pointerId);
      pointers.set(e.pointerId, [e.clientX, e.clientY]);
    });
    element.addEventListener('pointermove', (e) => {
      const before = pointers.get(e.pointerId);
      if (!before) {
        element.style.cursor = this.paneAt(e)?.kind === 'orbit' && orbit.home ? 'grab' : 'default';
        return;
      }
      const [dx, dy] = [e.clientX - before[0], e.clientY - before[1]];
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== e.pointerId)[1];
        const reach = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        orbit.zoom(Math.max(1, reach(before)) / Math.max(1, reach([e.clientX, e.clientY])));
        orbit.shift(dx / 2 / element.clientHeight, dy / 2 / element.clientHeight);
      } else if (e.shiftKey || e.buttons === 4) {
        orbit.shift(dx / element.clientHeight, dy / element.clientHeight);
      } else {
        orbit.turn(dx * 0.008, dy * 0.008);
      }
      pointers.set(e.pointerId, [e.clientX, e.clientY]);
      this.turned();
    });
    for (const name of ['pointerup', 'pointercancel']) element.addEventListener(name, (e) => pointers.delete(e.pointerId));
    element.addEventListener('wheel', (e) => {
      if (this.paneAt(e)?.kind !== 'orbit' || !orbit.home) return;
      e.preventDefault();
      orbit.zoom(Math.exp(e.deltaY * 0.0012));
      this.turned();
    }, { passive: false });
    element.addEventListener('dblclick', (e) => { if (this.paneAt(e)?.kind === 'orbit') this.home(); });
  }
}
