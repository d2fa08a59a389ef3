// SPDX-License-Identifier: GPL-3.0-or-later
// The page in a browser that draws with its own software (Chromium without a window, Firefox on a display), and what went
// wrong in it.
import { readFileSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { pathToFileURL } from 'node:url';

const chromium = (webgl) => ({
  browser: 'chrome',
  headless: true,
  args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
    ...(webgl ? ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] : ['--disable-gpu', '--disable-software-rasterizer', '--disable-3d-apis'])],
});
// Without a display Firefox has no WebGL where there is no graphics processor.
const firefox = (webgl) => ({ browser: 'firefox', headless: false, extraPrefsFirefox: { 'webgl.force-enabled': webgl, 'webgl.disabled': !webgl } });

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

export class Page {
  /** @param packages folder with node_modules that holds puppeteer-core @param html the page's file @param browser its program @param blind without WebGL */
  static async open({ packages, html, browser, width = 1366, height = 768, blind = false }) {
    const { default: puppeteer } = await import(pathToFileURL(createRequire(join(packages, 'package.json')).resolve('puppeteer-core')).href);
    const self = new Page();
    self.profile = mkdtempSync(join(tmpdir(), 'calot-page-'));
    const kind = (/firefox/.test(basename(browser)) ? firefox : chromium)(!blind);
    self.browser = await puppeteer.launch({ ...kind, executablePath: browser, userDataDir: self.profile, defaultViewport: { width, height }, protocolTimeout: 1_800_000 });
    self.requests = [];
    self.errors = [];
    [self.page] = await self.browser.pages();
    self.page.on('request', (request) => self.requests.push(request.url()));
    self.page.on('console', (message) => { if (['error', 'warn'].includes(message.type())) self.errors.push(message.text()); });
    self.page.on('pageerror', (error) => self.errors.push(error.message));
    self.address = pathToFileURL(html).href;
    await self.page.goto(self.address);
    await self.until(() => window.calotPage?.state.engine && window.calotPage.state.times.warm, 60);
    return self;
  }

  async close() {
    await this.browser.close();
    rmSync(this.profile, { recursive: true, force: true });
  }

  /** Waits until it is so in the page. */
  until(condition, seconds, ...given) { return this.page.waitForFunction(condition, { timeout: 1000 * seconds }, ...given); }
  evaluate(code, ...given) { return this.page.evaluate(code, ...given); }
  press(key) { return this.page.keyboard.press(key); }

  /** Requests that left the page: all but itself and the scripts that it made. */
  get sent() { return this.requests.filter((url) => url !== this.address && !url.startsWith('blob:') && !url.startsWith('data:')); }

  /** Drops a file on it, as a hand does. */
  async drop(file, bytes = readFileSync(file)) {
    await this.page.evaluate((text, name) => {
      const content = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      const data = new DataTransfer();
      data.items.add(new File([content], name));
      window.attemptBefore = window.calotPage.state.attempt;
      document.body.dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: data }));
    }, bytes.toString('base64'), basename(file));
  }

  text(selector) { return this.page.$eval(selector, (element) => element.textContent.trim()); }
  seen(selector) { return this.page.$eval(selector, (element) => element.checkVisibility()); }

  /** Waits until the verdict on what was dropped last is no longer open. @return {short, long} */
  async verdict(seconds = 60) {
    await this.until(() => {
      const { attempt } = window.calotPage.state;
      const v = attempt === window.attemptBefore ? null : attempt?.verification;
      return v && v.settled() && attempt.chain?.done && ['good', 'bad'].includes(document.getElementById('verdict').className);
    }, seconds);
    return { short: await this.text('#verdict'), long: await this.text('#proof') };
  }

  /** Waits for a line of refusal. */
  async refusal() {
    await this.until(() => !document.getElementById('refusal').hidden, 10);
    return this.text('#refusal');
  }

  async seek(moment) {
    await this.page.evaluate((m) => window.calotPage.state.attempt.seek(m), moment);
    await this.until((m) => window.calotPage.state.drawn?.moment === m, 30, moment);
  }

  /** The endoscope's picture of the moment that is shown: {width, height, rgba}. */
  async picture(width, height, film) {
    const text = await this.page.evaluate((w, h, f) => new Promise((resolve) => {
      window.calotPage.state.pictures = ({ pixels }) => {
        let out = '';
        for (let i = 0; i < pixels.length; i += 8192) out += String.fromCharCode(...pixels.subarray(i, i + 8192));
        resolve(btoa(out));
      };
      window.calotPage.threads.picture.postMessage({ kind: 'picture', width: w, height: h, film: f });
    }), width, height, film ? 1 : 0);
    return { width, height, rgba: new Uint8Array(Buffer.from(text, 'base64')) };
  }
}
