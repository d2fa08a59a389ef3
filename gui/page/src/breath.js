// SPDX-License-Identifier: GPL-3.0-or-later
// Lets a thread's messages in, between pieces of long work.

const channel = new MessageChannel();
const waiting = [];
channel.port1.onmessage = () => waiting.shift()();

/** @param ms at least so long; 0: until the messages that are there were looked at */
export function breath(ms = 0) {
  return new Promise((resolve) => {
    if (ms > 0) {
      setTimeout(resolve, ms);
    } else {
      waiting.push(resolve);
      channel.port2.postMessage(0);
    }
  });
}
