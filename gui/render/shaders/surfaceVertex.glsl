// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms a DrawVertex.
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
