// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const common = R"(
const float pi = 3.14159265;

uniform vec2 focal;        // clip = focal * (x, -y) / z
uniform vec2 depthRange;   // near, far (m)

// Noise at p (in cells): derivatives in xyz, value in w.
uniform sampler3D noiseVolume;
vec4 noise(vec3 p) { return texture(noiseVolume, p / 8.0); }

// pcg2d of Jarzynski and Olano, JCGT 9(3), 2020.
vec2 hash(uvec2 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * 1664525u; v.y += v.x * 1664525u;
  v ^= v >> 16u;
  v.x += v.y * 1664525u; v.y += v.x * 1664525u;
  v ^= v >> 16u;
  return vec2(v >> 8u) / 16777216.0;
}

// What the endoscope's light gives a surface that faces it, in direction l at squared distance d2: inverse square, in a
// cone that fades, right at the reference distance.
float lightAt(vec3 l, float d2, float referenceDistance) {
  float cone = pow(clamp(-l.z, 0.0, 1.0), 2.5);
  float light = cone * referenceDistance * referenceDistance / max(d2, 0.0004);
  return 1.25 * light / (1.0 + 0.35 * light);  // a camera's knee for what comes too close
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
uniform vec3 eye;          // origin of the projection in C: lens, or light
out vec3 vPosition;
out vec3 vNormal;
out vec3 vRest;
out vec3 vRestNormal;
out vec2 vHarm;
void main() {
  vPosition = position;
  vNormal = normal;
  vRest = rest;
  vRestNormal = restNormal;
  vHarm = harm;
  gl_Position = project(position - eye, focal);
}
)";

const char* const shadowFragment = R"(
void main() {}
)";

const char* const prepassFragment = R"(
in vec3 vPosition;
in vec3 vNormal;
layout(location = 0) out vec4 normalAndDepth;
void main() {
  vec3 n = normalize(vNormal);
  normalAndDepth = vec4(gl_FrontFacing ? n : -n, vPosition.z);
}
)";

const char* const pictureVertex = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

}  // namespace calot::gui::glsl
