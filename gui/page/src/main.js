// SPDX-License-Identifier: GPL-3.0-or-later
// The page: opens what is dropped on it, and joins pictures, time line and proof.
import { Attempt } from './attempt.js';
import { describeAttempt, describeMoment, listEvents, markEvent } from './panel.js';
import { fromBase64, isPage, recordingInPage } from './carried.js';
import { bindKeys } from './keys.js';
import { Stage } from './stage.js';
import { listen, part, starter } from './threads.js';
import { Timeline } from './timeline.js';
import { momentOf, verdictOf } from './verdict.js';
import { clock } from './words.js';

const byId = (id) => document.getElementById(id);
const state = { engine: null, attempt: null, tracks: null, events: [], phases: null, times: {}, last: -1, file: '', blind: null };
const threads = { size: Math.max(1, Math.min(8, navigator.hardwareConcurrency || 2)) };
let stage = null;
let timeline = null;
let prepared = null; // resolves when a recording can be opened

const mark = (name) => { state.times[name] ??= performance.now(); };

/** One clear line instead of a recording, or over the one that is shown. */
function refuse(message) {
  byId('refusal').textContent = message;
  byId('refusal').hidden = false;
  byId('invite').hidden = false;
}

function repaint() {
  if (repaint.asked || !state.attempt) return;
  repaint.asked = true;
  requestAnimationFrame(() => {
    repaint.asked = false;
    timeline.paint();
    showVerdict();
  });
}

function showVerdict() {
  const { attempt } = state;
  if (!attempt) return;
  const { kind, short, long } = verdictOf(attempt, state.engine.software);
  const badge = byId('verdict');
  badge.hidden = false;
  badge.className = kind;
  if (badge.textContent !== short) badge.textContent = short;
  byId('proof').textContent = long;
  if (kind === 'good') mark('verified');
  showMoment();
}

function showMoment() {
  const { attempt } = state;
  const { moment, difference } = attempt;
  const seconds = moment * attempt.stepSeconds;
  byId('clock').textContent = `${clock(seconds)} / ${clock(attempt.steps * attempt.stepSeconds)}`;
  const bar = byId('timeline');
  bar.setAttribute('aria-valuenow', moment);
  bar.setAttribute('aria-valuetext', clock(seconds));
  const known = momentOf(attempt.verification, moment, difference);
  byId('unproven').hidden = known === null;
  if (known) {
    byId('unproven').className = known.kind;
    byId('unproven').textContent = known.text;
  }
  describeMoment(state.tracks, state.phases, moment);
  let index = -1;
  while (index + 1 < state.events.length && state.events[index + 1].step < moment) index += 1;
  if (index !== state.last) markEvent(state.last = index);
}

/** Phases by step as runs: {first, end, phase}. */
function runsOf(phases, count) {
  const runs = [];
  for (let n = 0; n < count; ++n) {
    if (runs.length > 0 && runs.at(-1).phase === phases[n]) runs.at(-1).end = n + 1;
    else runs.push({ first: n, end: n + 1, phase: phases[n] });
  }
  return runs;
}

/** Opens a file, or bytes. */
async function open(what, name) {
  state.times = { dropped: performance.now() };
  state.file = name;
  await prepared;
  if (what instanceof File && await isPage(what)) {
    const carried = await recordingInPage(what).catch(() => null); // base64 that is none
    if (!carried) return refused('it is a page that carries no recording');
    state.file = carried.name;
    what = carried.buffer;
  }
  if (what instanceof ArrayBuffer) threads.reader.postMessage({ kind: 'open', bytes: what, simulation: state.engine.simulation }, [what]);
  else threads.reader.postMessage({ kind: 'open', file: what, simulation: state.engine.simulation });
}

function refused(why) {
  if (state.times.scene !== undefined) close(); // the engine has its scene already, and no longer that of the one before
  refuse(`${state.file} cannot be opened: ${why}.`);
}

/** Shows no recording. */
function close() {
  state.attempt?.end();
  state.attempt = null;
  threads.picture.postMessage({ kind: 'reset' });
  document.body.classList.remove('open');
  for (const element of [byId('panel'), byId('verdict'), byId('unproven'), document.querySelector('footer')]) element.hidden = true;
  byId('title').textContent = 'No recording';
}

function opened(m) {
  state.attempt?.end();
  Object.assign(state, { tracks: null, phases: null, events: [], last: -1 });
  byId('refusal').hidden = true;
  byId('invite').hidden = true;
  if (state.blind) refuse(state.blind);
  byId('panel').hidden = false;
  document.body.classList.add('open');
  document.querySelector('footer').hidden = false;
  byId('title').textContent = `${state.file} · ${m.about.scene_name}`;
  const stepSeconds = m.tick * m.ticks;
  threads.picture.postMessage({ kind: 'reset' });
  const steps = new Float64Array(m.counts.events);
  const view = new DataView(m.events.buffer);
  steps.forEach((_, i) => { steps[i] = Number(view.getBigUint64(45 * i, true)); });
  threads.picture.postMessage({ kind: 'events', bytes: m.events, steps, stepSeconds });
  stage.forget();
  const attempt = new Attempt(m, threads, {
    ready: () => {
      mark('ready');
      attempt.seek(0);
    },
    player: ({ playing, speed }) => {
      byId('play').textContent = playing ? '❚❚' : '▶';
      byId('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
      byId('actual').textContent = playing && speed ? `runs at ${speed.toFixed(2)}×` : '';
    },
    tracks: (data) => {
      state.tracks = data;
      setTimeline();
    },
    judged: () => {
      state.events = attempt.told;
      state.phases = runsOf(attempt.phases, attempt.judgement.first + attempt.judgement.phases.length);
      state.last = -1;
      listEvents(state.events, attempt.stepSeconds, (moment) => attempt.seek(moment));
      if (attempt.judgement.done) describeAttempt(m, attempt.judgement);
      setTimeline();
    },
    changed: repaint,
    failed: (message) => refuse(`The re-simulation stopped: ${message}.`),
  });
  state.attempt = attempt;
  listen(threads.player, { ...attempt.fromPlayer }, refuse);
  describeAttempt(m);
  listEvents(state.events, stepSeconds, (moment) => attempt.seek(moment));
  byId('timeline').setAttribute('aria-valuemax', m.counts.steps);
  setTimeline();
}

function setTimeline() {
  const { attempt, tracks } = state;
  timeline.set({ steps: attempt.steps, stepSeconds: attempt.stepSeconds, get verification() { return attempt.verification; }, events: state.events, phases: state.phases, force: tracks?.force, speed: tracks?.speed });
  showVerdict();
}

/** What pictures need of a scene file: zeros for gravity where it has none. The engine says what else is wrong with it. */
function pictured(bytes) {
  try {
    const { gravity, clip } = JSON.parse(new TextDecoder().decode(bytes));
    return { gravity: Array.isArray(gravity) && gravity.length === 3 && gravity.every(Number.isFinite) ? gravity : [0, 0, 0], clip };
  } catch { /* no scene file */ }
  return { gravity: [0, 0, 0] };
}

const fromReader = {
  scene: ({ files }) => {
    mark('scene');
    threads.picture.postMessage({ kind: 'scene', ...pictured(files[0].content) });
    threads.player.postMessage({ kind: 'scene', files });
  },
  undecided: ({ simulation }) => refused(`it is of simulation version ${simulation}, and this page has the engine of version ${state.engine.simulation} alone (${state.engine.software})`),
  opened: (m) => {
    mark('opened');
    opened(m);
  },
  refused: ({ message }) => refused(message),
  segment: (m) => state.attempt?.fromReader.segment(m),
  tracks: (m) => state.attempt?.fromReader.tracks(m),
  chain: (m) => state.attempt?.fromReader.chain(m),
  judged: (m) => state.attempt?.fromReader.judged(m),
  unjudged: (m) => state.attempt?.fromReader.unjudged(m),
};

const fromPicture = {
  started: () => mark('warm'),
  seen: (m) => stage.seen(m),
  drawn: ({ moment }) => {
    const { attempt } = state;
    if (!attempt) return;
    mark('picture');
    state.drawn = { moment, at: performance.now() };
    attempt.drawn(moment);
    timeline.show(moment);
    showMoment();
    attempt.prove();
  },
  failed: ({ message }) => refuse(`Pictures cannot be drawn: ${message}.`),
  blind: ({ message }) => {
    mark('warm');
    state.blind = `Pictures cannot be drawn: ${message}. All else works.`;
    refuse(state.blind);
  },
  picture: (m) => state.pictures?.(m),
};

/** Starts all that needs no recording, so that the first picture comes soon. */
async function prepare() {
  const compiled = async (name) => WebAssembly.compile(await part(name));
  const [engine, proof, picture, judge, readerThread, workThread] = await Promise.all([compiled('engine'), compiled('proof'), compiled('picture'), compiled('judge'), starter('reader'), starter('worker')]);
  threads.reader = readerThread();
  listen(threads.reader, fromReader, refuse);
  threads.reader.postMessage({ kind: 'start', proof, judge });
  threads.engine = () => {
    const thread = workThread({ role: 'engine' });
    thread.postMessage({ kind: 'module', module: engine, proof });
    return thread;
  };
  threads.picture = workThread({ role: 'picture' });
  listen(threads.picture, fromPicture, refuse);
  const canvas = byId('picture').transferControlToOffscreen();
  threads.picture.postMessage({ kind: 'start', canvas, module: picture }, [canvas]);
  stage = new Stage(byId('stage'), { endoscope: byId('label-endoscope'), orbit: byId('label-orbit') }, (message) => threads.picture.postMessage(message));
  timeline = new Timeline(byId('timeline'), byId('tip'), (moment) => state.attempt?.seek(moment));
  const channel = new MessageChannel();
  threads.player = threads.engine();
  threads.picture.postMessage({ kind: 'port', port: channel.port1 }, [channel.port1]);
  await new Promise((resolve) => {
    listen(threads.player, { engine: (m) => { state.engine = m; resolve(); } }, refuse);
  });
  threads.player.postMessage({ kind: 'picture', port: channel.port2 }, [channel.port2]);
  byId('about-page').textContent = `It is re-simulated, proven bit for bit and drawn here, in this page. Nothing is sent anywhere. Engine of simulation version ${state.engine.simulation}.`;
}

function bind() {
  const file = byId('file');
  byId('open').addEventListener('click', () => file.click());
  file.addEventListener('change', () => {
    if (file.files.length > 0) open(file.files[0], file.files[0].name);
    file.value = '';
  });
  document.addEventListener('dragover', (e) => {
    e.preventDefault();
    document.body.classList.add('dropping');
  });
  document.addEventListener('dragleave', (e) => { if (e.relatedTarget === null) document.body.classList.remove('dropping'); });
  document.addEventListener('drop', (e) => {
    e.preventDefault();
    document.body.classList.remove('dropping');
    const dropped = e.dataTransfer.files[0];
    if (dropped) open(dropped, dropped.name);
  });
  byId('refusal').addEventListener('click', () => { byId('refusal').hidden = true; });
  bindKeys({ state, stage: () => stage, byId });
}

/** A recording that was put into the page. */
function openEmbedded() {
  const embedded = document.getElementById('recording');
  if (embedded?.type !== 'application/x-calot-recording') return;
  open(fromBase64(embedded.textContent).buffer, embedded.dataset.name ?? 'The recording in this page');
}

bind();
prepared = prepare().catch((error) => {
  refuse(`This page does not run here: ${error.message}.`);
  throw error;
});
prepared.then(openEmbedded, () => {});
window.calotPage = { state, threads };
