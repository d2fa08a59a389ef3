// SPDX-License-Identifier: GPL-3.0-or-later
// Text beside the pictures.
import { clock, instruments, phases } from './words.js';

const byId = (id) => document.getElementById(id);

/** Fills a definition list. @param rows [name, text] */
function define(list, rows) {
  list.replaceChildren(...rows.filter(([, text]) => text !== '').flatMap(([name, text]) => {
    const [dt, dd] = [document.createElement('dt'), document.createElement('dd')];
    dt.textContent = name;
    dd.textContent = text;
    return [dt, dd];
  }));
}

/** @param judgement after the last step, where there is one */
export function describeAttempt({ about, counts, tick, outcome, completed }, judgement = null) {
  const operator = [about.operator_kind, about.performer_profile, about.performer_version].filter(Boolean).join(' ');
  define(byId('attempt'), [
    ['Scene', `${about.scene_name} ${about.scene_major}.${about.scene_minor}`],
    ['Length', `${clock(counts.ticks * tick)} (min:s)`],
    ['Outcome', completed ? outcome : 'incomplete'],
    ['Critical view', judgement ? `${judgement.criticalView} of 6 points` : ''],
    ['Verdict', judgement ? judgement.verdict.join(' ') : ''],
    ['Operator', operator],
    ['Participant', about.participant],
    ['Mode', `${about.mode}, ${about.purpose}`],
    ['Started', about.start_utc.replace('T', ' ').replace('Z', ' UTC')],
    ['Simulation', `version ${about.simulation_version}`],
    ['Recorded by', about.software],
    ['Attempt', about.attempt_uuid],
  ]);
}

export function listEvents(events, stepSeconds, seek) {
  byId('events').replaceChildren(...events.map(({ step, text, fault }) => {
    const [item, button, time, words] = ['li', 'button', 'time', 'span'].map((n) => document.createElement(n));
    time.textContent = clock((step + 1) * stepSeconds);
    words.textContent = fault ? `▲ ${text}` : text;
    item.classList.toggle('fault', fault);
    button.append(time, words);
    button.addEventListener('click', () => seek(step + 1));
    item.append(button);
    return item;
  }));
  if (events.length > 0) return;
  const item = document.createElement('li');
  item.className = 'faint';
  item.textContent = 'none to tell of';
  byId('events').append(item);
}

export function markEvent(index) {
  const list = byId('events');
  list.querySelector('.now')?.classList.remove('now');
  const item = index < 0 ? null : list.children[index];
  if (!item) return;
  item.classList.add('now');
  list.scrollTop = item.offsetTop - list.offsetTop - list.clientHeight / 2;
}

export function describeMoment(tracks, phaseRuns, moment) {
  if (!tracks) return;
  const n = Math.max(0, Math.min(tracks.force[0].length - 1, moment - 1));
  const hand = (h) => `${instruments[tracks.instrument[h][n]] ?? 'unknown'}, ${tracks.force[h][n].toFixed(2)} N, ${(1000 * tracks.speed[h][n]).toFixed(0)} mm/s`;
  const run = phaseRuns?.find((r) => n < r.end);
  define(byId('now'), [['Step', `${moment} of ${tracks.force[0].length}`], ['Phase', run ? phases[run.phase] ?? '' : ''], ['Left', hand(0)], ['Right', hand(1)]]);
}
