// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const common = R"(
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
)";

const char* const surfaceVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest;
layout(location = 3) in vec3 restNormal;
layout(location = 4) in vec2 harm;  // charred, face
invariant gl_Position;
uniform vec3 eye;          // origin of the projection in C: lens, or light
out vec3 vPosition;
out vec3 vNormal;
out vec3 vRest;
out vec3 vRestNormal;
out vec2 vHarm;
#if BROAD_PER_VERTEX && defined(LOOK)
out vec4 vBroadA, vBroadB, vBroadC, vBroadD;
#endif
void main() {
  vPosition = position;
  vNormal = normal;
  vRest = rest;
  vRestNormal = restNormal;
  vHarm = harm;
#if BROAD_PER_VERTEX && defined(LOOK)
  Broad broad = broadOf(rest);
  vBroadA = broad.a;
  vBroadB = broad.b;
  vBroadC = broad.c;
  vBroadD = broad.d;
#endif
  gl_Position = project(position - eye, focal);
}
)";

const char* const prepassFragment = R"(
in vec3 vPosition;
in vec3 vNormal;
layout(location = 0) out float depth;  // z in C
layout(location = 1) out vec3 halved;  // normal, as a colour
void main() {
  vec3 n = normalize(vNormal);
  depth = vPosition.z;
  halved = 0.5 + (gl_FrontFacing ? 0.5 : -0.5) * n;
}
)";

const char* const pictureVertex = R"(
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);
}
)";

const char* const surroundVertex = R"(
uniform vec2 field;  // half axes of the endoscope's round field in clip coordinates

// A ring of quads, each of two triangles, from the field to far outside, at the near plane: what comes later is hidden.
const ivec2 corner[6] = ivec2[](ivec2(0, 0), ivec2(0, 1), ivec2(1, 0), ivec2(1, 0), ivec2(0, 1), ivec2(1, 1));
void main() {
  ivec2 at = corner[gl_VertexID % 6];
  float angle = float(gl_VertexID / 6 + at.x) * (2.0 * pi / float(FIELD_SIDES));
  gl_Position = vec4((at.y == 0 ? 1.0 : 4.0) * field * vec2(cos(angle), sin(angle)), -1.0, 1.0);
}
)";

const char* const emptyFragment = R"(
void main() {}
)";

const char* const surroundFragment = R"(
layout(location = 0) out vec4 black;
void main() { black = vec4(0.0, 0.0, 0.0, 1.0); }
)";

}  // namespace calot::gui::glsl
