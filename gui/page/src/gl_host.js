// SPDX-License-Identifier: GPL-3.0-or-later
// OpenGL as the renderer calls it (gui/render/gl_objects.h), over WebGL 2: numbers stand for its objects.

const precision = ['float', 'int', 'sampler2D', 'sampler3D', 'sampler2DShadow'].map((type) => `precision highp ${type};\n`).join('');

/** A shader of OpenGL's language in that of OpenGL ES 3.0: what the renderer's have in common with it is all but the head. */
function translated(source) { return source.replace(/^#version 450 core\n/, `#version 300 es\n${precision}`); }

class Table {
  constructor() {
    this.items = [null];
    this.free = [];
  }
  add(item) {
    const number = this.free.pop() ?? this.items.length;
    this.items[number] = item;
    return number;
  }
  get(number) { return this.items[number] ?? null; }
  remove(number) {
    const item = this.get(number);
    if (item !== null) this.free.push(number);
    this.items[number] = null;
    return item;
  }
}

/**
 * @param gl a WebGL2RenderingContext @param memory returns the module's memory, which grows
 * @return functions by name, without "gl"
 */
export function glImports(gl, memory) {
  const tables = { Texture: new Table(), Buffer: new Table(), Framebuffer: new Table(), VertexArray: new Table() };
  const shaders = new Table();
  const programs = new Table();
  const locations = new Table();
  const u4 = (at, n) => new Uint32Array(memory().buffer, at, n);
  const bytes = (at, n) => new Uint8Array(memory().buffer, at >>> 0, n);
  const string = (at) => {
    const all = new Uint8Array(memory().buffer);
    let end = at >>> 0;
    while (all[end] !== 0) ++end;
    return new TextDecoder().decode(all.subarray(at >>> 0, end));
  };
  const log = (text, most, length, at) => {
    const encoded = new TextEncoder().encode(text ?? '').subarray(0, Math.max(0, most - 1));
    bytes(at, encoded.length + 1).set([...encoded, 0]);
    if (length !== 0) u4(length, 1)[0] = encoded.length;
  };
  const out = {
    GetError: () => gl.getError(),
    ClearColor: (r, g, b, a) => gl.clearColor(r, g, b, a),
    DepthMask: (on) => gl.depthMask(on !== 0),
    ActiveTexture: (unit) => gl.activeTexture(unit),
    BindTexture: (target, n) => gl.bindTexture(target, tables.Texture.get(n)),
    BindBuffer: (target, n) => gl.bindBuffer(target, tables.Buffer.get(n)),
    BindFramebuffer: (target, n) => gl.bindFramebuffer(target, tables.Framebuffer.get(n)),
    BindVertexArray: (n) => gl.bindVertexArray(tables.VertexArray.get(n)),
    BufferData: (target, size, at, usage) => gl.bufferData(target, bytes(at, size), usage),
    DrawBuffers: (n, at) => gl.drawBuffers(Array.from(u4(at, n))),
    DrawElements: (mode, count, type, offset) => gl.drawElements(mode, count, type, offset >>> 0),
    FramebufferTexture2D: (target, attachment, what, n, level) => gl.framebufferTexture2D(target, attachment, what, tables.Texture.get(n), level),
    ReadPixels: (x, y, w, h, format, type, at) => gl.readPixels(x, y, w, h, format, type, bytes(at, 4 * w * h)),
    TexImage2D: (target, level, internal, w, h, border, format, type, at) => gl.texImage2D(target, level, internal, w, h, border, format, type, bytes(at, (format === gl.RED ? 1 : 4) * w * h)),
    TexImage3D: (target, level, internal, w, h, d, border, format, type, at) => {
      const n = 4 * w * h * d;
      const texels = type === gl.FLOAT ? new Float32Array(memory().buffer, at >>> 0, n) : bytes(at, n);
      gl.texImage3D(target, level, internal, w, h, d, border, format, type, texels);
    },
    CreateShader: (kind) => shaders.add(gl.createShader(kind)),
    ShaderSource: (n, count, at) => gl.shaderSource(shaders.get(n), translated(Array.from(u4(at, count), string).join(''))),
    CompileShader: (n) => gl.compileShader(shaders.get(n)),
    DeleteShader: (n) => gl.deleteShader(shaders.remove(n)),
    GetShaderiv: (n, what, at) => { u4(at, 1)[0] = Number(gl.getShaderParameter(shaders.get(n), what)); },
    GetShaderInfoLog: (n, most, length, at) => log(gl.getShaderInfoLog(shaders.get(n)), most, length, at),
    CreateProgram: () => programs.add(Object.assign(gl.createProgram(), { locations: new Map() })),
    AttachShader: (p, s) => gl.attachShader(programs.get(p), shaders.get(s)),
    LinkProgram: (p) => gl.linkProgram(programs.get(p)),
    DeleteProgram: (p) => gl.deleteProgram(programs.remove(p)),
    UseProgram: (p) => gl.useProgram(programs.get(p)),
    GetProgramiv: (p, what, at) => { u4(at, 1)[0] = Number(gl.getProgramParameter(programs.get(p), what)); },
    GetProgramInfoLog: (p, most, length, at) => log(gl.getProgramInfoLog(programs.get(p)), most, length, at),
    GetUniformLocation: (p, at) => {
      const program = programs.get(p);
      const name = string(at);
      let number = program.locations.get(name);
      if (number === undefined) {
        const location = gl.getUniformLocation(program, name);
        number = location === null ? -1 : locations.add(location);
        program.locations.set(name, number);
      }
      return number;
    },
    Uniform1i: (n, x) => gl.uniform1i(locations.get(n), x),
    Uniform1f: (n, x) => gl.uniform1f(locations.get(n), x),
    Uniform2f: (n, x, y) => gl.uniform2f(locations.get(n), x, y),
    Uniform3f: (n, x, y, z) => gl.uniform3f(locations.get(n), x, y, z),
    VertexAttribPointer: (n, size, type, normalized, stride, offset) => gl.vertexAttribPointer(n, size, type, normalized !== 0, stride, offset >>> 0),
  };
  for (const [kind, table] of Object.entries(tables)) {
    out[`Gen${kind}s`] = (n, at) => { for (let i = 0; i < n; ++i) u4(at, n)[i] = table.add(gl[`create${kind}`]()); };
    out[`Delete${kind}s`] = (n, at) => { for (const number of u4(at, n)) gl[`delete${kind}`](table.remove(number)); };
  }
  for (const name of ['BlendFunc', 'Clear', 'DepthFunc', 'Disable', 'DrawArrays', 'Enable', 'FrontFace', 'PixelStorei', 'Scissor',
    'TexParameteri', 'Viewport', 'CheckFramebufferStatus', 'EnableVertexAttribArray', 'GenerateMipmap', 'TexStorage2D']) {
    const method = gl[name[0].toLowerCase() + name.slice(1)].bind(gl);
    out[name] = (...values) => method(...values);
  }
  return out;
}
