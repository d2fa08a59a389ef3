// SPDX-License-Identifier: GPL-3.0-or-later
// What the page carries, packed, and the threads it starts from that.

/** Bytes of a part that scripts/page.py put into the document. */
export async function part(name) {
  const element = document.getElementById(`part-${name}`);
  const packed = Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
  element.remove();
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** A function that starts a thread of a script, as often as wanted. */
export async function starter(name) {
  const url = URL.createObjectURL(new Blob([await part(name)], { type: 'text/javascript' }));
  return (first = null) => {
    const worker = new Worker(url);
    if (first !== null) worker.postMessage(first);
    return worker;
  };
}

/** Calls handlers by the kind of a message. @param failed for what a thread could not catch itself */
export function listen(worker, handlers, failed) {
  worker.onmessage = ({ data }) => handlers[data.kind]?.(data);
  worker.onerror = (event) => {
    event.preventDefault();
    failed(event.message || 'a thread failed');
  };
}
