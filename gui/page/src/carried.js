// SPDX-License-Identifier: GPL-3.0-or-later
// A recording that a page carries: this one, or a grade sheet (calot grade --html --with-replay).

/** Bytes of base64 text. */
export const fromBase64 = (text) => Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));

/** Is this file a page rather than a recording? By its first bytes; what it is called does not count. */
export async function isPage(file) {
  const head = await file.slice(0, 16).text();
  return /^\s*<(!doctype|html)/i.test(head);
}

/** {name, buffer} of the recording in a page; null where it carries none. */
export async function recordingInPage(file) {
  // Parsed as a document, a page runs nothing and loads nothing.
  const page = new DOMParser().parseFromString(await file.text(), 'text/html');
  const element = page.querySelector('script[type="application/x-calot-recording"]');
  if (!element) return null;
  return { name: element.dataset.name ?? file.name, buffer: fromBase64(element.textContent).buffer };
}
