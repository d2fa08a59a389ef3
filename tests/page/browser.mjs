// SPDX-License-Identifier: GPL-3.0-or-later
// The page in a headless browser that draws with its own software, and what went wrong in it.
import { readFileSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { pathToFileURL } from 'node:url';

const switches = ['--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export class Page {
  /** @param packages folder with node_modules that holds playwright-core @param html the page's file */
  static async open({ packages, html, browser, width = 1366, height = 768 }) {
    const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
    const self = new Page();
    self.profile = mkdtempSync(join(tmpdir(), 'calot-page-'));
    self.context = await chromium.launchPersistentContext(self.profile, { executablePath: browser, headless: true, viewport: { width, height }, args: switches });
    self.requests = [];
    self.errors = [];
    self.context.on('request', (request) => self.requests.push(request.url()));
    self.page = self.context.pages()[0];
    self.page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) self.errors.push(message.text()); });
    self.page.on('pageerror', (error) => self.errors.push(error.message));
    self.address = pathToFileURL(html).href;
    await self.page.goto(self.address);
    await self.page.waitForFunction(() => window.calotPage?.state.engine && window.calotPage.state.times.warm, null, { timeout: 60000 });
    return self;
  }

  async close() {
    await this.context.close();
    rmSync(this.profile, { recursive: true, force: true });
  }

  /** Requests that left the page: all but itself and the scripts that it made. */
  get sent() { return this.requests.filter((url) => url !== this.address && !url.startsWith('blob:') && !url.startsWith('data:')); }

  /** Drops a file on it, as a hand does. */
  async drop(file, bytes = readFileSync(file)) {
    const name = basename(file);
    const transfer = await this.page.evaluateHandle(([text, named]) => {
      const content = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      const data = new DataTransfer();
      data.items.add(new File([content], named));
      return data;
    }, [bytes.toString('base64'), name]);
    await this.page.evaluate(() => { window.attemptBefore = window.calotPage.state.attempt; });
    await this.page.dispatchEvent('body', 'drop', { dataTransfer: transfer });
  }

  async text(selector) { return (await this.page.textContent(selector)).trim(); }

  /** Waits until the verdict on what was dropped last is no longer open. @return {short, long} */
  async verdict(seconds = 60) {
    await this.page.waitForFunction(() => {
      const { attempt } = window.calotPage.state;
      const v = attempt === window.attemptBefore ? null : attempt?.verification;
      return v && v.settled() && attempt.chain?.done && ['good', 'bad'].includes(document.getElementById('verdict').className);
    }, null, { timeout: 1000 * seconds });
    return { short: await this.text('#verdict'), long: await this.text('#proof') };
  }

  /** Waits for a line of refusal. */
  async refusal() {
    await this.page.waitForSelector('#refusal:not([hidden])', { timeout: 10000 });
    return this.text('#refusal');
  }

  async seek(moment) {
    await this.page.evaluate((m) => window.calotPage.state.attempt.seek(m), moment);
    await this.page.waitForFunction((m) => window.calotPage.state.drawn?.moment === m, moment, { timeout: 30000 });
  }

  /** The endoscope's picture of the moment that is shown: {width, height, rgba}. */
  async picture(width, height, film) {
    const text = await this.page.evaluate(([w, h, f]) => new Promise((resolve) => {
      window.calotPage.state.pictures = ({ pixels }) => {
        let out = '';
        for (let i = 0; i < pixels.length; i += 8192) out += String.fromCharCode(...pixels.subarray(i, i + 8192));
        resolve(btoa(out));
      };
      window.calotPage.threads.picture.postMessage({ kind: 'picture', width: w, height: h, film: f });
    }), [width, height, film ? 1 : 0]);
    return { width, height, rgba: new Uint8Array(Buffer.from(text, 'base64')) };
  }
}
