// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that draws: scene views of an engine, by the renderer itself, onto a canvas.
import { glImports } from './gl_host.js';
import { instantiate, place, textAt } from './wasm_host.js';

const blank = [0.043, 0.05, 0.06, 1];
const smokeSeconds = 2.5;
// Film quality takes about eight times as long as interactive quality (docs/rendering.md).
const measured = 6; // pictures
const always = 2.5; // ms
const atRest = 30; // ms
const rest = 350; // ms without another picture
const hidden = 300; // ms after which a picture is drawn although the browser asks for none

export function pictureWorker() {
  let gl = null;
  let module = null; // exports
  let panes = []; // {kind: 'endoscope' | 'orbit', x, y, width, height} in pixels, y from the top
  let film = 0;
  let still = 0; // timer
  const costs = []; // of the first pictures (ms)
  let orbit = null; // eight f8
  let events = null; // /events of the recording: {bytes, steps, stepSeconds}
  let port = null;
  let dirty = false;
  let waiting = []; // views shown when the next picture is there
  let seen = false;

  const failed = (error) => {
    const thrown = module ? textAt(module.memory, module.calot_thrown() >>> 0) : '';
    postMessage({ kind: 'failed', message: thrown || error.message });
  };

  /** Puts the framebuffer that is bound, first row lowest, where a pane is. */
  function present({ x, y, width, height }) {
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    const bottom = gl.drawingBufferHeight - y - height;
    gl.blitFramebuffer(0, 0, width, height, x, bottom + height, x + width, bottom, gl.COLOR_BUFFER_BIT, gl.NEAREST);
  }

  /** How long a picture takes is found by the first ones: reading a pixel waits for it. */
  function measure(began) {
    if (costs.length === measured) return;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    costs.push(performance.now() - began);
  }

  /** Where film quality is quick, all pictures have it; where it is bearable, those that stand still. */
  function choose() {
    if (costs.length < measured) return;
    const cost = Math.min(...costs);
    const wasStill = film === 1 && cost >= always;
    film = cost < always ? 1 : 0;
    if (film === 1 || wasStill || cost > atRest) return;
    still = setTimeout(() => {
      film = 1;
      requestAnimationFrame(draw);
    }, rest);
  }

  function draw() {
    dirty = false;
    if (!seen) return;
    const began = performance.now();
    try {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.disable(gl.SCISSOR_TEST);
      gl.clearColor(...blank);
      gl.clear(gl.COLOR_BUFFER_BIT);
      for (const pane of panes) {
        if (pane.width < 16 || pane.height < 16) continue;
        if (pane.kind === 'orbit' && orbit) {
          place(module, new Uint8Array(orbit.buffer));
          module.calot_orbit(pane.width, pane.height, film);
        } else {
          module.calot_endoscope(pane.width, pane.height, film, 1);
        }
        present(pane);
      }
      gl.flush();
      if (film === 0) measure(began);
      choose();
    } catch (error) {
      failed(error);
    }
    for (const moment of waiting) {
      postMessage({ kind: 'drawn', moment });
      port?.postMessage(moment);
    }
    waiting = [];
  }

  function later() {
    clearTimeout(still);
    if (costs.length === measured && Math.min(...costs) >= always) film = 0;
    if (dirty) return;
    dirty = true;
    const once = () => { if (dirty) draw(); };
    requestAnimationFrame(once);
    setTimeout(once, hidden); // a page that is not seen has no frames, but goes on proving
  }

  /** Smoke is no part of a view: it is made of the events of the last seconds (docs/rendering.md). */
  function addSmoke(moment) {
    if (!events) return;
    const oldest = moment - Math.ceil(smokeSeconds / events.stepSeconds);
    const rows = [];
    for (let i = events.bytes.length / 45 - 1; i >= 0 && events.steps[i] >= oldest; --i)
      if (events.steps[i] < moment && events.bytes[45 * i + 8] === 31) rows.unshift(events.bytes.subarray(45 * i, 45 * i + 45));
    const list = new Uint8Array(8 + 44 * rows.length);
    new DataView(list.buffer).setBigUint64(0, BigInt(rows.length), true);
    rows.forEach((row, i) => {
      list.set(row.subarray(0, 9), 8 + 44 * i);
      list.set(row.subarray(10), 8 + 44 * i + 9);
    });
    place(module, list);
    module.calot_smoke(events.stepSeconds);
  }

  const on = {
    start(m) {
      try {
        gl = m.canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, powerPreference: 'high-performance' });
        if (!gl) throw new Error('this browser has no WebGL 2');
        if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('this browser draws on no floating-point textures (EXT_color_buffer_float)');
        gl.getExtension('OES_texture_float_linear');
        m.canvas.addEventListener('webglcontextlost', () => postMessage({ kind: 'failed', message: 'the graphics processor was taken away; load the page again' }));
        module = instantiate(m.module, { gl: glImports(gl, () => module.memory) });
        module.calot_warm();
        postMessage({ kind: 'started' });
      } catch (error) {
        failed(error);
      }
    },
    port(m) {
      port = m.port;
      port.onmessage = ({ data }) => on[data.kind](data);
    },
    view(m) {
      try {
        place(module, new Uint8Array(m.view.buffer, m.view.byteOffset, m.view.byteLength));
        if (module.calot_view() !== 1) throw new Error('the engine gave no scene view');
        addSmoke(m.moment);
        const first = !seen;
        seen = true;
        const extent = Array.from(new Float64Array(module.memory.buffer, module.calot_extent() >>> 0, 4));
        const camera = Array.from(new Float64Array(module.memory.buffer, module.calot_camera() >>> 0, 8));
        postMessage({ kind: 'seen', first, extent, camera });
      } catch (error) {
        failed(error);
      }
      waiting.push(m.moment);
      later();
    },
    panes(m) {
      gl.canvas.width = m.width;
      gl.canvas.height = m.height;
      panes = m.panes;
      later();
    },
    orbit(m) { orbit = m.camera; later(); },
    events(m) { events = m; },
    reset() {
      seen = false;
      orbit = null;
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.disable(gl.SCISSOR_TEST);
      gl.clearColor(...blank);
      gl.clear(gl.COLOR_BUFFER_BIT);
    },
    /** The picture of one pane as it would be by itself: for the comparison with the program's. */
    picture(m) {
      try {
        if (m.camera) {
          place(module, new Uint8Array(m.camera.buffer));
          module.calot_orbit(m.width, m.height, m.film);
        } else {
          module.calot_endoscope(m.width, m.height, m.film, 1);
        }
        const pixels = new Uint8Array(4 * m.width * m.height);
        gl.readPixels(0, 0, m.width, m.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        postMessage({ kind: 'picture', width: m.width, height: m.height, pixels }, [pixels.buffer]);
        later();
      } catch (error) {
        failed(error);
      }
    },
  };
  onmessage = ({ data }) => on[data.kind](data);
}
