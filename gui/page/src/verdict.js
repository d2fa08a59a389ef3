// SPDX-License-Identifier: GPL-3.0-or-later
// The proof in words (docs/reference/glossary.md): parts are consistent; only all of them together make an attempt verified.
import { State } from './verification.js';
import { clock } from './words.js';

/** {kind, short, long} of how far a proof is. */
export function verdictOf({ verification, opened, stepSeconds, chain }, software) {
  if (!verification) return { kind: '', short: 'not proven yet', long: 'The proof begins when the first picture is there.' };
  const { difference, error, total, done } = verification;
  const good = verification.state.filter((s) => s === State.consistent).length;
  const parts = `${good} of ${verification.segments.length} segments consistent`;
  const speed = `${verification.speed(stepSeconds).toFixed(1)} times real time, ${verification.workers.length === 1 ? 'one engine' : `${verification.workers.length} engines`}`;
  if (error) return { kind: 'bad', short: 'proof stopped', long: `The proof stopped: ${error}. ${parts}.` };
  if (difference) {
    const where = [difference.component, difference.field].filter(Boolean).join(', ');
    const before = verification.state.subarray(0, difference.index).every((s) => s === State.consistent);
    const tick = difference.tick === undefined ? '' : ` (tick ${difference.tick})`;
    const again = { same: 'Run once more, its segment gives the same difference.', other: 'Run once more, its segment gives another difference: this machine does not compute reproducibly.', consistent: 'Run once more, its segment is consistent: this machine does not compute reproducibly.' }[verification.again] ?? '';
    return {
      kind: 'bad',
      short: `differs at step ${difference.step}`,
      long: `${chainWords(chain)}${before ? 'The first difference' : 'A difference (earlier segments are still run)'} is at step ${difference.step}${tick}, ${clock((difference.step + 1) * stepSeconds)}: ${where}${difference.detail ? `: ${difference.detail}` : ''}. ${again} What is recorded is not what simulation ${opened.about.simulation_version} gives for these samples. ${parts}.`,
    };
  }
  if (chain?.done && chain.broken !== null) {
    return { kind: 'bad', short: 'content chain broken', long: `${chainWords(chain)}${parts}; ${done} of ${total} steps re-simulated (${speed}).` };
  }
  if (verification.verified && chain?.done) {
    const seconds = ((verification.finished - verification.began) / 1000).toFixed(1);
    const incomplete = opened.completed ? '' : ' The recording is incomplete: its writer was stopped before the end.';
    return {
      kind: 'good',
      short: 'verified: bit-exact',
      long: `${provenWords(verification, opened, total)} The content chain is intact. (${software}; ${seconds} s, ${speed}.)${incomplete} It does not show who operated, nor that the file is the one that was handed out.`,
    };
  }
  return { kind: 'part', short: `consistent so far, ${Math.min(99, Math.floor(100 * done / total))} %`,
    long: `${parts}; ${done} of ${total} steps re-simulated (${speed}). Not verified before all are, and the content chain is followed to its end.` };
}

/** What was compared, with what came out. */
function provenWords({ segments }, { comparison }, steps) {
  if (comparison.golden) return `All ${steps} steps: every digest of the State's components and of the forces, and every event, comes out again bit for bit.`;
  const parts = segments.length === 1 ? 'One segment' : `All ${segments.length} segments`;
  return `${parts}, ${steps} steps: every digest, force, result and event comes out again bit for bit, and every keyframe byte for byte.`;
}

/** What is wrong with the content chain, if anything. */
function chainWords(chain) {
  if (!chain?.done || chain.broken === null) return '';
  if (chain.message) return `The content chain cannot be followed: ${chain.message}. `;
  const where = chain.broken === 0 ? 'at its start: what the recording says of itself, or its scene, was changed' : `in what was written from step ${chain.step} on: something was changed`;
  return `The content chain is broken ${where} after it was recorded. `;
}

/** What is known of the step that a picture shows: {kind, text}. */
export function momentOf(verification, moment, difference) {
  if (difference) return { kind: 'bad', text: `differs from the recording since step ${difference.step}` };
  if (!verification) return { kind: '', text: 'not proven yet' };
  const { segments, state, steps } = verification;
  const i = Math.max(0, segments.findIndex((s) => moment <= s.end));
  if (verification.difference && moment > verification.difference.step) return { kind: 'bad', text: 'after the first difference' };
  if (verification.verified) return null;
  if (state[i] === State.consistent) return { kind: 'good', text: 'consistent; verified when all is proven' };
  if (moment <= segments[i].first + steps[i] && steps[i] > 0) return { kind: 'good', text: 'consistent so far' };
  return { kind: '', text: 'not proven yet' };
}
