// SPDX-License-Identifier: GPL-3.0-or-later
// A thread with an engine: proves segments, or plays.
import { Engine } from './engine.js';
import { Player } from './player.js';
import { Verifier } from './verifier.js';
import { instantiate } from './wasm_host.js';

export function engineWorker() {
  let module = null;
  let proof = null;
  let scene = null; // {files, about, segments}
  let engine = null;
  let verifier = null;
  let player = null;
  let proving = Promise.resolve();
  let held = false;
  let picture = null; // port to the thread that draws
  const asked = new Map(); // what the recording was asked for
  let asker = 0;
  const drawn = []; // waiting for a picture

  const build = () => {
    engine = new Engine(module);
    engine.scene(scene.files);
    return engine;
  };

  const ask = (kind, what) => new Promise((resolve, reject) => {
    asked.set(++asker, { resolve, reject });
    postMessage({ kind, asker, ...what });
  });
  const host = {
    segment: (index) => ask('segment?', { index }),
    waypoint: (moment) => ask('waypoint?', { moment }),
    show: (view, moment, difference) => new Promise((resolve) => {
      drawn.push(resolve);
      postMessage({ kind: 'compared', moment, difference });
      picture.postMessage({ kind: 'view', view, moment }, [view.buffer]);
    }),
    tell: (state) => postMessage({ kind: 'player', ...state }),
    proved: (index, difference) => postMessage({ kind: 'proved', index, difference }),
  };
  const guarded = (work) => Promise.resolve().then(work).catch((error) => {
    engine = null;
    player = null;
    postMessage({ kind: 'failed', message: error.message });
  });
  const withPlayer = (work) => guarded(() => {
    player ??= new Player(scene.about, scene.segments, engine ?? build(), proof, host);
    return work(player);
  });

  const on = {
    module(m) {
      module = m.module;
      proof = instantiate(m.proof);
      const probe = new Engine(module); // compiles, and says of which version it is
      postMessage({ kind: 'engine', simulation: probe.simulation, result: probe.result, software: probe.software });
    },
    picture(m) {
      picture = m.port;
      picture.onmessage = () => drawn.shift()?.();
    },
    /** The scene takes a moment to build, and comes before all else that is read of a recording. */
    scene(m) {
      player?.pause(); // what it is at ends
      asked.clear();
      scene = { files: m.files };
      engine = verifier = player = null;
      guarded(build);
    },
    about(m) {
      Object.assign(scene, { about: m.about, segments: m.segments });
      guarded(() => {
        if (engine === null) build();
        postMessage({ kind: 'ready', columns: engine.columns, result: engine.result });
      });
    },
    /** One after the other, in the order in which they come. */
    prove(m) {
      proving = proving.then(() => guarded(async () => {
        verifier ??= new Verifier(scene.about, engine ?? build(), proof);
        verifier.hold(held);
        const { index } = m.rows;
        let told = performance.now();
        const difference = await verifier.run(m.rows, (steps) => {
          const now = performance.now();
          if (now - told < 200) return;
          told = now;
          postMessage({ kind: 'progress', index, steps });
        }, (waypoint) => postMessage({ kind: 'waypoint', ...waypoint }));
        if (difference?.ended) engine = verifier = null;
        postMessage({ kind: 'proved', index, difference });
      }));
    },
    hold(m) {
      held = m.on;
      verifier?.hold(held);
    },
    answer({ asker: whose, found, message }) {
      const { resolve, reject } = asked.get(whose) ?? {};
      if (!resolve) return; // of a recording that was closed
      asked.delete(whose);
      if (message === undefined) resolve(found);
      else reject(new Error(message));
    },
    seek: (m) => withPlayer((p) => p.seek(m.moment)),
    play: (m) => withPlayer((p) => p.play(m.rate)),
    pause: () => withPlayer((p) => p.pause()),
  };
  onmessage = ({ data }) => on[data.kind](data);
}
