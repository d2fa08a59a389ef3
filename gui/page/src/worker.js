// SPDX-License-Identifier: GPL-3.0-or-later
// Threads other than the reader: the first message says which.
import { engineWorker } from './engine_worker.js';
import { pictureWorker } from './picture_worker.js';

onmessage = ({ data }) => {
  if (data.role === 'picture') pictureWorker();
  else engineWorker();
};
