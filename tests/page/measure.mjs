// SPDX-License-Identifier: GPL-3.0-or-later
// How quick the page is with a recording: from the drop to the first picture, seeks, playing, and the whole proof.
//   node measure.mjs RECORDING [--page FILE] [--packages FOLDER] [--browser FILE] [--proof]
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { Page, sleep } from './browser.mjs';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const { values: given, positionals: [recording] } = parseArgs({
  allowPositionals: true,
  options: {
    page: { type: 'string', default: join(root, 'build/page/calot-page.html') },
    packages: { type: 'string', default: join(root, 'build/page/tree') },
    browser: { type: 'string', default: '/usr/bin/chromium' },
    proof: { type: 'boolean', default: false },
  },
});
const page = await Page.open({ ...given, html: given.page });
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
await sleep(1500);
await (await page.page.$('#file')).uploadFile(resolve(recording));
await page.until(() => window.calotPage.state.times.picture, 60);
const times = await page.evaluate(() => window.calotPage.state.times);
for (const name of ['scene', 'opened', 'ready', 'picture']) console.log(`drop to ${name}: ${((times[name] - times.dropped) / 1000).toFixed(2)} s`);

if (given.proof) {
  await page.verdict(1200);
  console.log(await page.text('#proof'));
}
await sleep(3000);
const steps = await page.evaluate(() => window.calotPage.state.attempt.steps);
const seeks = [];
for (const share of [0.31, 0.72, 0.55, 0.93, 0.12, 0.48, 0.81, 0.22, 0.64, 1]) {
  seeks.push(await page.evaluate((moment) => new Promise((done) => {
    const { state } = window.calotPage;
    const [began, before] = [performance.now(), state.drawn];
    let first = null;
    const look = () => {
      if (state.drawn !== before) first ??= performance.now() - began;
      if (state.drawn.moment === moment) done({ first, exact: performance.now() - began });
      else setTimeout(look, 4);
    };
    state.attempt.seek(moment);
    look();
  }), Math.round(share * steps)));
  await sleep(600);
}
console.log(`seek, a picture near by: median ${median(seeks.map((s) => s.first)).toFixed(0)} ms, longest ${Math.max(...seeks.map((s) => s.first)).toFixed(0)} ms`);
console.log(`seek, the moment itself: median ${median(seeks.map((s) => s.exact)).toFixed(0)} ms, longest ${Math.max(...seeks.map((s) => s.exact)).toFixed(0)} ms`);
await page.seek(0);
await page.press(' ');
await sleep(8000);
console.log(`playing at 1x: ${await page.text('#clock')} after 8 s, ${await page.text('#actual')}`);
await page.close();
