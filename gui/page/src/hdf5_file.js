// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of data sets as they are stored, read with h5wasm.
import createModule from '../node_modules/h5wasm/dist/esm/hdf5_util.js';

/** A file that cannot be read as what it should be: one line for people. */
export class Damaged extends Error {}

let ready = null;
let opened = 0;

/** Starts the library, which takes a moment. */
export function prepare() {
  ready ??= createModule({ noInitialRun: true, print: () => {}, printErr: () => {} });
  return ready;
}

export class Hdf5File {
  /** @param bytes of the whole file */
  static async open(bytes) {
    const h5 = await prepare();
    h5.activate_throwing_error_handler?.();
    const name = `recording-${++opened}.h5`; // beside the one before, which stays if this one is refused
    // A recording whose writer was killed still has its writer's mark in the superblock: only a reader beside a writer may open it.
    const marked = bytes.length > 12 && bytes[8] === 3 && (bytes[11] & 4) !== 0;
    const signature = bytes.length > 8 && String.fromCharCode(...bytes.subarray(0, 8)) === '\x89HDF\r\n\x1a\n';
    h5.FS.writeFile(name, bytes, { canOwn: true });
    let id = -1n;
    try {
      id = h5.open(name, h5.H5F_ACC_RDONLY | (marked ? h5.H5F_ACC_SWMR_READ : 0), false, -1, -1);
    } catch { /* said below */ }
    if (id > 0) return new Hdf5File(h5, id, name);
    h5.FS.unlink(name);
    throw new Damaged(signature ? 'it is an HDF5 file that is cut off or damaged' : 'it is no HDF5 file');
  }

  constructor(h5, id, name) {
    Object.assign(this, { h5, id, name });
    this.known = new Map();
  }

  close() {
    this.h5.close_file(this.id);
    this.h5.FS.unlink(this.name);
  }

  attributes(path) { return this.h5.get_attribute_names(this.id, path); }

  /** An attribute's bytes and kind. */
  attribute(path, attribute) {
    const { h5, id } = this;
    const metadata = h5.get_attribute_metadata(id, path, attribute);
    const size = metadata.size * Number(metadata.total_size);
    const at = h5._malloc(size);
    try {
      h5.get_attribute_data(id, path, attribute, BigInt(at));
      return { bytes: h5.HEAPU8.slice(at, at + size), metadata };
    } finally {
      h5._free(at);
    }
  }

  has(path) {
    let at = '';
    for (const part of path.split('/').filter(Boolean)) {
      if (!this.names(at === '' ? '/' : at).includes(part)) return false;
      at += `/${part}`;
    }
    return true;
  }

  names(group) {
    let names = this.known.get(`names ${group}`);
    if (names === undefined) {
      try {
        names = this.h5.get_names(this.id, group, false);
      } catch {
        names = [];
      }
      this.known.set(`names ${group}`, names);
    }
    return names;
  }

  /** Size of an element (bytes) and shape. @throws Damaged */
  describe(path) {
    let found = this.known.get(path);
    if (found) return found;
    if (!this.has(path)) throw new Damaged(`${path} is missing`);
    const m = this.h5.get_dataset_metadata(this.id, path);
    if (!m?.shape) throw new Damaged(`${path} is no data set of rows`);
    const shape = Array.from(m.shape, Number);
    found = { size: m.size, shape, row: m.size * shape.slice(1).reduce((a, b) => a * b, 1), type: m.type };
    this.known.set(path, found);
    return found;
  }

  /** Rows as bytes. @throws Damaged */
  rows(path, first = 0, count = undefined) {
    const { h5 } = this;
    const { shape, row } = this.describe(path);
    const wanted = count ?? shape[0] - first;
    if (first + wanted > shape[0]) throw new Damaged(`${path} has ${shape[0]} rows: ${first + wanted} are needed`);
    const size = wanted * row;
    if (size === 0) return new Uint8Array(0);
    const at = h5._malloc(size);
    if (at === 0) throw new Damaged(`${path} does not fit into memory`);
    try {
      const ones = shape.map(() => 1n);
      const lengths = shape.map((n, i) => BigInt(i === 0 ? wanted : n));
      const offsets = shape.map((_, i) => BigInt(i === 0 ? first : 0));
      const status = h5.get_dataset_data(this.id, path, lengths, offsets, ones, BigInt(at));
      if (status < 0) throw new Error('unreadable');
      return h5.HEAPU8.slice(at, at + size);
    } catch {
      throw new Damaged(`${path} cannot be read (rows ${first} to ${first + wanted})`);
    } finally {
      h5._free(at);
    }
  }
}
