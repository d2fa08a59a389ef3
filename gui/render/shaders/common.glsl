// SPDX-License-Identifier: GPL-3.0-or-later
// Hash, noise volume, projection; stands before each of the others.
const float pi = 3.14159265;

uniform vec2 focal;        // clip = focal * (x, -y) / z
uniform vec2 depthRange;   // near, far (m)

// Noise at p (in cells): derivatives in xyz, value in w.
uniform sampler3D noiseVolume;
#if NOISE_BYTES
vec4 noise(vec3 p) { return texture(noiseVolume, p / 8.0) * vec4(vec3(4.0), 2.0) - vec4(vec3(2.0), 1.0); }
#else
vec4 noise(vec3 p) { return texture(noiseVolume, p / 8.0); }
#endif

// pcg2d of Jarzynski and Olano, JCGT 9(3), 2020.
vec2 hash(uvec2 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * 1664525u; v.y += v.x * 1664525u;
  v ^= v >> 16u;
  v.x += v.y * 1664525u; v.y += v.x * 1664525u;
  v ^= v >> 16u;
  return vec2(v >> 8u) / 16777216.0;
}

// Places of samples on a disk: sunflower seeds, rotated as a whole by a share of a revolution.
vec2 spiral(int i) { return vec2(cos(2.39996 * float(i)), sin(2.39996 * float(i))); }
mat2 rotation(float turn) {
  float c = cos(2.0 * pi * turn), s = sin(2.0 * pi * turn);
  return mat2(c, s, -s, c);
}

vec4 project(vec3 p, vec2 f) {
  return vec4(f.x * p.x, -f.y * p.y,
              (p.z * (depthRange.y + depthRange.x) - 2.0 * depthRange.x * depthRange.y) / (depthRange.y - depthRange.x), p.z);
}
