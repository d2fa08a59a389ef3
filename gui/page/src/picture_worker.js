// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that draws: scene views of an engine, by the renderer itself, onto a canvas.
import { glImports } from './gl_host.js';
import { instantiate, place, textAt } from './wasm_host.js';

const blank = [0.043, 0.05, 0.06, 1];
const smokeSeconds = 2.5;
const kinds = { clipDropped: 25, smoke: 31 }; // of events
// Film quality takes about eight times as long as interactive quality (docs/explanation/rendering.md). What one picture takes, both
// panes of it, decides what pictures have:
const measured = 6; // pictures that tell
const always = 2.5; // ms: quicker ones have film quality always
const atRest = 30; // ms: quicker ones have it where they stand still
const slow = 80; // ms: where they take longer, those that move are coarse
const coarse = 0.5; // of their width and height
const filmRest = 350; // ms without another picture
const fineRest = 800;
const poll = 3; // ms
const hidden = 300; // ms after which a picture is drawn although the browser asks for none

export function pictureWorker() {
  let gl = null;
  let module = null; // exports
  let panes = []; // {kind: 'endoscope' | 'orbit', x, y, width, height} in pixels, y from the top
  let better = 0; // timer
  const costs = []; // of the first pictures of interactive quality (ms)
  let orbit = null; // eight f8
  let events = null; // /events of the recording: {bytes, steps, stepSeconds}
  let port = null;
  let dirty = false;
  let waiting = []; // views shown when the next picture is there
  let seen = false;
  let blind = false; // there is nothing to draw with

  const failed = (error, kind = 'failed') => {
    const thrown = module ? textAt(module.memory, module.calot_thrown() >>> 0) : '';
    postMessage({ kind, message: thrown || error.message });
  };

  function done(moment) {
    postMessage({ kind: 'drawn', moment });
    port?.postMessage(moment);
  }

  /** Puts the framebuffer that is bound, first row lowest, where a pane is. */
  function present({ x, y, width, height }, w, h) {
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    const bottom = gl.drawingBufferHeight - y - height;
    gl.blitFramebuffer(0, 0, w, h, x, bottom + height, x + width, bottom, gl.COLOR_BUFFER_BIT, w === width ? gl.NEAREST : gl.LINEAR);
  }

  /** Calls what comes after a picture when it is finished, not only begun. */
  function whenFinished(then) {
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (gl.isContextLost() || gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED) {
        gl.deleteSync(fence);
        then();
      } else {
        setTimeout(look, poll);
      }
    };
    setTimeout(look);
  }

  /** How a picture is drawn that moves, or that stands still. */
  function quality(still) {
    if (costs.length === 0) return { film: 0, scale: 1 };
    const cost = Math.min(...costs);
    return { film: cost < always || (still && cost < atRest) ? 1 : 0, scale: still || cost < slow ? 1 : coarse };
  }

  /** A picture is finished: where it stands still, it may become a better one. */
  function rest() {
    const [moving, still] = [quality(false), quality(true)];
    if (moving.film === still.film && moving.scale === still.scale) return;
    clearTimeout(better);
    better = setTimeout(() => requestAnimationFrame(() => draw(true)), moving.scale === 1 ? filmRest : fineRest);
  }

  function draw(still = false) {
    dirty = false;
    if (!seen) return;
    const began = performance.now();
    const { film, scale } = quality(still);
    try {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.disable(gl.SCISSOR_TEST);
      gl.clearColor(...blank);
      gl.clear(gl.COLOR_BUFFER_BIT);
      for (const pane of panes) {
        if (pane.width < 16 || pane.height < 16) continue;
        const [w, h] = [Math.round(scale * pane.width), Math.round(scale * pane.height)];
        if (pane.kind === 'orbit' && orbit) {
          place(module, new Uint8Array(orbit.buffer));
          module.calot_orbit(w, h, film);
        } else {
          module.calot_endoscope(w, h, film, 1);
        }
        present(pane, w, h);
      }
    } catch (error) {
      failed(error);
    }
    const drawn = waiting;
    waiting = [];
    whenFinished(() => {
      if (film === 0 && scale === 1 && costs.length < measured) costs.push(performance.now() - began);
      if (!still) rest();
      drawn.forEach(done);
    });
  }

  function later() {
    clearTimeout(better);
    if (dirty) return;
    dirty = true;
    const once = () => { if (dirty) draw(); };
    requestAnimationFrame(once);
    setTimeout(once, hidden); // a page that is not seen has no frames, but goes on proving
  }

  /** Smoke and clips that fell are no part of a view: they are made of events (docs/explanation/rendering.md). */
  function addTraces(moment) {
    if (!events) return;
    const oldest = moment - Math.ceil(smokeSeconds / events.stepSeconds);
    const rows = [];
    for (let i = 0; i < events.steps.length && events.steps[i] < moment; ++i) {
      const kind = events.bytes[45 * i + 8];
      if (kind === kinds.clipDropped || (kind === kinds.smoke && events.steps[i] >= oldest)) rows.push(events.bytes.subarray(45 * i, 45 * i + 45));
    }
    const list = new Uint8Array(8 + 44 * rows.length);
    new DataView(list.buffer).setBigUint64(0, BigInt(rows.length), true);
    rows.forEach((row, i) => {
      list.set(row.subarray(0, 9), 8 + 44 * i);
      list.set(row.subarray(10), 8 + 44 * i + 9);
    });
    place(module, list);
    module.calot_traces(events.stepSeconds);
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
        blind = true;
        failed(error, 'blind');
      }
    },
    port(m) {
      port = m.port;
      port.onmessage = take;
    },
    view(m) {
      try {
        place(module, new Uint8Array(m.view.buffer, m.view.byteOffset, m.view.byteLength));
        if (module.calot_view() !== 1) throw new Error('the engine gave no scene view');
        addTraces(m.moment);
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
    scene(m) {
      module?.calot_gravity(...m.gravity);
      module?.calot_clips(m.clip?.width, m.clip?.legs);
    },
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
  /** Whoever cannot draw says so once; all else goes on without pictures. */
  const take = ({ data }) => {
    if (!blind || data.kind === 'port') on[data.kind](data);
    else if (data.kind === 'view') done(data.moment);
  };
  onmessage = take;
}
