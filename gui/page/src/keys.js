// SPDX-License-Identifier: GPL-3.0-or-later
// Keyboard and buttons.

/** @param page {state, stage(), byId} */
export function bindKeys({ state, stage, byId }) {
  const rate = byId('rate');
  const attempt = () => state.attempt;
  const second = () => 1 / attempt().stepSeconds;
  const by = (steps) => attempt()?.seekBy(steps);
  const toggle = () => {
    const a = attempt();
    if (!a) return;
    if (a.playing) a.pause();
    else if (a.moment >= a.steps) a.seek(0);
    else a.play(Number(rate.value));
  };
  const setRate = (index) => {
    rate.selectedIndex = Math.max(0, Math.min(rate.options.length - 1, index));
    if (attempt()?.playing) attempt().play(Number(rate.value));
  };
  const toEvent = (direction) => {
    const { events } = state;
    const { moment } = attempt();
    const found = direction > 0 ? events.find((e) => e.step + 1 > moment) : events.findLast((e) => e.step + 1 < moment);
    if (found) attempt().seek(found.step + 1);
  };
  const orbit = (change) => {
    if (!stage()?.orbit.home) return;
    change(stage().orbit);
    stage().turned();
  };
  const view = () => stage()?.cycle();

  byId('play').addEventListener('click', toggle);
  byId('back').addEventListener('click', () => attempt() && by(-second()));
  byId('forward').addEventListener('click', () => attempt() && by(second()));
  byId('view').addEventListener('click', view);
  byId('keys').addEventListener('click', () => byId('help').showModal());
  rate.addEventListener('change', () => setRate(rate.selectedIndex));

  const actions = {
    ' ': toggle,
    ArrowLeft: (e) => by(-second() * (e.shiftKey ? 10 : 1)),
    ArrowRight: (e) => by(second() * (e.shiftKey ? 10 : 1)),
    ',': () => by(-1),
    '.': () => by(1),
    Home: () => attempt().seek(0),
    End: () => attempt().seek(attempt().steps),
    p: () => toEvent(-1),
    n: () => toEvent(1),
    '+': () => setRate(rate.selectedIndex + 1),
    '-': () => setRate(rate.selectedIndex - 1),
    a: () => orbit((o) => o.turn(0.1, 0)),
    d: () => orbit((o) => o.turn(-0.1, 0)),
    w: () => orbit((o) => o.turn(0, 0.1)),
    s: () => orbit((o) => o.turn(0, -0.1)),
    q: () => orbit((o) => o.zoom(0.9)),
    e: () => orbit((o) => o.zoom(1 / 0.9)),
    h: () => stage()?.home(),
    v: view,
  };
  document.addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || byId('help').open || e.target.tagName === 'SELECT') return;
    if (e.target.tagName === 'BUTTON' && (e.key === ' ' || e.key === 'Enter')) return;
    const key = e.key.length === 1 ? e.key.toLowerCase() : e.key;
    if (key === 'Escape') byId('refusal').hidden = true;
    else if (key === 'o') byId('open').click();
    else if (key === '?') byId('help').showModal();
    else if (actions[key] && attempt()) {
      e.preventDefault();
      actions[key](e);
    }
  });
}
