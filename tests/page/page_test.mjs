// SPDX-License-Identifier: GPL-3.0-or-later
// The attempt in a browser: what it says of good and of bad files, and that its pictures are those of the program.
//   node page_test.mjs --calot PROGRAM [--page FILE] [--packages FOLDER] [--browser FILE] [--output FOLDER]
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { Page, sleep } from './browser.mjs';
import { decodePng, encodePng } from './png.mjs';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const { values: given } = parseArgs({
  options: {
    calot: { type: 'string' },
    page: { type: 'string', default: join(root, 'build/page/calot-page.html') },
    packages: { type: 'string', default: join(root, 'build/page/tree') },
    browser: { type: 'string', default: '/usr/bin/chromium' },
    output: { type: 'string', default: join(root, 'build/page/pictures') },
  },
});
if (!given.calot) throw new Error('--calot names the command line that records and renders');

const work = mkdtempSync(join(tmpdir(), 'calot-page-test-'));
mkdirSync(given.output, { recursive: true });
const calot = (...args) => execFileSync(given.calot, args, { encoding: 'utf8', env: { ...process.env, CALOT_CACHE: 'off' } });
const python = (code, ...args) => execFileSync('/usr/bin/python3', ['-c', code, ...args], { encoding: 'utf8' });
const size = [640, 480];
const mostDifference = 1.5; // levels of 255, mean over all channels of a picture: another rasterizer, the same shaders

let failures = 0;
async function check(name, body) {
  const began = performance.now();
  try {
    const note = await body();
    console.log(`ok   ${name} (${((performance.now() - began) / 1000).toFixed(1)} s)${note ? `: ${note}` : ''}`);
  } catch (error) {
    failures += 1;
    console.log(`FAIL ${name}: ${error.message}`);
  }
}

/** Mean absolute difference of two pictures' red, green and blue (levels). */
function difference(a, b) {
  assert.equal(a.rgba.length, b.rgba.length);
  let sum = 0;
  for (let i = 0; i < a.rgba.length; ++i) if (i % 4 !== 3) sum += Math.abs(a.rgba[i] - b.rgba[i]);
  return sum / (a.rgba.length / 4 * 3);
}

function record(scene, seconds) {
  const file = join(work, `${scene}.h5`);
  calot('record', '--scene', scene, '--performer', 'skilled', '--seed', '1', '--seconds', String(seconds), '-o', file);
  return file;
}

const touch = record('touch-liver', 8);
const bed = record('dissect-bed', 4);
const open = (options = {}) => Page.open({ ...given, html: given.page, ...options });
const page = await open();

await check('a recording that is dropped is verified', async () => {
  await page.drop(touch);
  const { short, long } = await page.verdict();
  assert.equal(short, 'verified: bit-exact', long);
  assert.match(long, /800 steps/);
  const { segments, states, waypoints } = await page.evaluate(() => {
    const v = window.calotPage.state.attempt.verification;
    return { segments: v.segments.length, states: [...v.state], waypoints: [...v.waypoints.kept.keys()] };
  });
  assert.deepEqual(states, Array(segments).fill(2));
  assert.equal(waypoints.length, 2 * segments); // the seeks of the next check begin at them
  return long.match(/[\d.]+ times real time/)[0];
});

await check('its pictures are those of the program', async () => {
  const notes = [];
  for (const step of [200, 450, 620]) {
    const file = join(given.output, `program-${step}.png`);
    calot('render', touch, '--at', String(step / 100), '--size', size.join('x'), '--quality', 'film', '-o', file, '--force');
    await page.seek(step + 1);
    const here = await page.picture(...size, true);
    writeFileSync(join(given.output, `page-${step}.png`), encodePng(here));
    const mean = difference(here, decodePng(readFileSync(file)));
    notes.push(`step ${step}: ${mean.toFixed(3)}`);
    assert.ok(mean < mostDifference, `step ${step}: mean difference ${mean.toFixed(2)} levels`);
    await page.seek(step + 60);
    const later = difference(await page.picture(...size, true), decodePng(readFileSync(file)));
    assert.ok(step === 200 || later > mean, `step ${step}: another moment looks as much like it`);
  }
  return notes.join(', ');
});

await check('connective tissue looks as in the program', async () => {
  await page.drop(bed);
  assert.equal((await page.verdict()).short, 'verified: bit-exact');
  const file = join(given.output, 'program-bed.png');
  calot('render', bed, '--at', '3', '--size', size.join('x'), '--quality', 'film', '-o', file, '--force');
  await page.seek(301);
  const here = await page.picture(...size, true);
  writeFileSync(join(given.output, 'page-bed.png'), encodePng(here));
  const mean = difference(here, decodePng(readFileSync(file)));
  assert.ok(mean < mostDifference, `mean difference ${mean.toFixed(2)} levels`);
  return mean.toFixed(3);
});

await check('playing moves on and can be stopped', async () => {
  await page.seek(100);
  await page.press(' ');
  await page.until(() => window.calotPage.state.drawn.moment > 140, 20);
  await page.press(' ');
  await sleep(500);
  const [one, two] = [await page.text('#clock'), (await sleep(400), await page.text('#clock'))];
  assert.equal(one, two);
  await page.press('Home');
  await page.until(() => window.calotPage.state.drawn.moment === 0, 20);
});

await check('the free view turns, by hand and by key, and views change', async () => {
  const box = await (await page.page.$('#stage')).boundingBox();
  const right = { x: box.x + 0.6 * box.width, y: box.y + 60, width: 0.3 * box.width, height: box.height - 120 };
  // Where drawing is slow, the full picture comes after 0.8 s at rest.
  const shot = async () => {
    for (let before = null, round = 0; round < 15; ++round) {
      await sleep(1200);
      const now = Buffer.from(await page.page.screenshot({ clip: right }));
      if (before?.equals(now)) return now;
      before = now;
    }
    return assert.fail('it moves by itself');
  };
  const before = await shot();
  await page.page.mouse.move(right.x + 80, right.y + 100);
  await page.page.mouse.down();
  await page.page.mouse.move(right.x + 180, right.y + 130, { steps: 3 });
  await page.page.mouse.up();
  const turned = await shot();
  assert.ok(!before.equals(turned), 'the hand turns nothing');
  await page.press('w');
  assert.ok(!turned.equals(await shot()), 'the key turns nothing');
  await page.press('h');
  // How finely it is drawn goes by what pictures cost, which another one may have changed.
  const home = difference(decodePng(before), decodePng(await shot()));
  assert.ok(home < mostDifference, `it does not come home: mean difference ${home.toFixed(2)} levels`);
  await page.press('v');
  assert.deepEqual([await page.seen('#label-endoscope'), await page.seen('#label-orbit')], [true, false]);
  await page.press('v');
  assert.deepEqual([await page.seen('#label-endoscope'), await page.seen('#label-orbit')], [false, true]);
  await page.press('v');
});

await check('a changed sample is found, and where', async () => {
  const changed = join(work, 'changed.h5');
  python(`import h5py, shutil, sys
shutil.copy(sys.argv[1], sys.argv[2])
with h5py.File(sys.argv[2], "r+") as f:
    f["ticks/right/position"][4321, 0] += 2.0 ** -20 * 1000`, touch, changed);
  await page.drop(changed);
  const { short, long } = await page.verdict();
  const found = await page.evaluate(() => window.calotPage.state.attempt.verification.difference);
  assert.equal(found.step, 432);
  assert.equal(short, 'differs at step 432');
  assert.match(long, /^The content chain is broken in what was written from step 425 on: something was changed after it was recorded\. The first/);
  assert.match(long, /The first difference is at step 432 \(tick 4321\), 0:04\.33: /);
  assert.match(long, /Run once more, its segment gives the same difference\./);
  const bad = await page.evaluate(() => [...window.calotPage.state.attempt.verification.state]);
  assert.equal(bad.indexOf(3), 4);
  assert.deepEqual(bad.slice(0, 4), [2, 2, 2, 2]);
  return long.slice(0, 120);
});

await check('a changed result is found, though its simulation is the same', async () => {
  const changed = join(work, 'result.h5');
  python(`import h5py, shutil, sys
shutil.copy(sys.argv[1], sys.argv[2])
with h5py.File(sys.argv[2], "r+") as f:
    f["observables/left/jaw"][250] += 1e-12`, touch, changed);
  await page.drop(changed);
  const { short, long } = await page.verdict();
  assert.equal(short, 'differs at step 250');
  assert.match(long, /left\/jaw/);
});

await check('a changed word about the attempt is found by the content chain', async () => {
  const changed = join(work, 'participant.h5');
  python(`import h5py, numpy, shutil, sys
shutil.copy(sys.argv[1], sys.argv[2])
with h5py.File(sys.argv[2], "r+") as f:
    f.attrs.modify("mode", numpy.bytes_("assessment"))`, touch, changed);
  await page.drop(changed);
  const { short, long } = await page.verdict();
  assert.equal(short, 'content chain broken');
  assert.match(long, /broken at its start.*8 of 8 segments consistent/);
});

await check('a recording whose writer was killed is read as far as it goes', async () => {
  const killed = join(work, 'killed.h5');
  const writer = spawn(given.calot, ['record', '--scene', 'touch-liver', '--performer', 'skilled', '--seed', '2', '--seconds', '30', '-o', killed], { env: { ...process.env, CALOT_CACHE: 'off' }, stdio: 'ignore' });
  const ended = new Promise((done) => writer.on('exit', done));
  while (!existsSync(killed) || statSync(killed).size < 400_000) await sleep(20); // some keyframes are in it
  writer.kill('SIGKILL');
  await ended;
  await page.drop(killed);
  const { short, long } = await page.verdict();
  assert.equal(short, 'verified: bit-exact', long);
  assert.match(long, /The recording is incomplete/);
  return long.match(/\d+ steps/)[0];
});

await check('a golden recording, without keyframes, is verified', async () => {
  const golden = join(work, 'golden.h5');
  calot('record', '--scene', 'touch-liver', '--performer', 'skilled', '--seed', '3', '--seconds', '3', '--purpose', 'golden', '-o', golden);
  await page.drop(golden);
  const { short, long } = await page.verdict();
  assert.equal(short, 'verified: bit-exact', long);
  assert.match(long, /^All 300 steps: every digest of the State's components/);
});

await check('wrong files get one clear line', async () => {
  const text = join(work, 'notes.h5');
  writeFileSync(text, 'no recording');
  await page.drop(text);
  assert.equal(await page.refusal(), 'notes.h5 cannot be opened: it is no HDF5 file.');
  await page.seek(77); // the one before is still there
  const cases = {
    'other.h5': ['import h5py, sys\nh5py.File(sys.argv[1], "w").create_dataset("x", data=[1.0])', /no recording of Calot/],
    'version.h5': [`import h5py, shutil, sys
shutil.copy(sys.argv[2], sys.argv[1])
with h5py.File(sys.argv[1], "r+") as f: f.attrs.modify("simulation_version", 17)`, /simulation version 17, and this page has the engine of version \d+ alone/],
    'lacking.h5': [`import h5py, shutil, sys
shutil.copy(sys.argv[2], sys.argv[1])
with h5py.File(sys.argv[1], "r+") as f: del f["ticks/left/jaw"]`, /\/ticks\/left\/jaw is missing/],
  };
  for (const [name, [code, expected]] of Object.entries(cases)) {
    const file = join(work, name);
    python(code, file, touch);
    await page.evaluate(() => { document.getElementById('refusal').hidden = true; });
    await page.drop(file);
    assert.match(await page.refusal().catch(() => `nothing is said of ${name}`), expected);
  }
  await page.evaluate(() => { document.getElementById('refusal').hidden = true; });
  const whole = readFileSync(touch);
  await page.drop(join(work, 'cut.h5'), whole.subarray(0, Math.floor(whole.length * 0.6)));
  assert.match(await page.refusal().catch(() => 'nothing is said of cut.h5'), /^cut.h5 cannot be opened: it is an HDF5 file that is cut off or damaged\.$/);
});

await check('a recording inside the page opens by itself', async () => {
  const html = join(work, 'embedded.html');
  const bytes = readFileSync(touch).toString('base64');
  writeFileSync(html, readFileSync(given.page, 'utf8').replace('</body>', () => `<script type="application/x-calot-recording" id="recording">${bytes}</script></body>`));
  const other = await open({ html });
  assert.equal((await other.verdict()).short, 'verified: bit-exact');
  assert.deepEqual(other.sent, []);
  assert.deepEqual(other.errors, []);
  await other.close();
});

await check('a grade sheet that carries its recording opens it', async () => {
  const sheet = join(work, 'sheet.html');
  const carried = `<script type="application/x-calot-recording" id="recording" data-name="carried.h5">\n${readFileSync(touch).toString('base64')}\n</script>`;
  writeFileSync(sheet, `<!DOCTYPE html>\n<html><body><h1>Grade</h1>${carried}</body></html>`);
  await page.drop(sheet);
  assert.equal((await page.verdict()).short, 'verified: bit-exact');
  assert.match(await page.text('#title'), /^carried\.h5/);
  writeFileSync(sheet, '<!DOCTYPE html>\n<html><body><script type="application/x-calot-recording">?</script></body></html>');
  await page.drop(sheet);
  assert.equal(await page.refusal(), 'sheet.html cannot be opened: it is a page that carries no recording.');
});

await check('without pictures it proves all the same', async () => {
  const blind = await open({ blind: true });
  await blind.drop(touch);
  assert.equal((await blind.verdict()).short, 'verified: bit-exact');
  assert.match(await blind.text('#refusal'), /^Pictures cannot be drawn: this browser has no WebGL 2\. All else works\.$/);
  assert.ok(await blind.seen('#refusal'));
  await blind.seek(200);
  await blind.close();
});

await check('nothing is sent, and nothing goes wrong unsaid', async () => {
  assert.deepEqual(page.sent, []);
  assert.deepEqual(page.errors, []);
  const policy = await page.page.$eval('meta[http-equiv="Content-Security-Policy"]', (element) => element.content);
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /'unsafe-eval'|'unsafe-inline'/);
  const tried = await page.evaluate(() => fetch('https://example.org/').then(() => 'sent', () => 'refused'));
  assert.equal(tried, 'refused');
});

await page.close();
rmSync(work, { recursive: true, force: true });
process.exit(failures === 0 ? 0 : 1);
