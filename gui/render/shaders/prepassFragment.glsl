// SPDX-License-Identifier: GPL-3.0-or-later
// Normal and depth, for the occlusion.
in vec3 vPosition;
in vec3 vNormal;
layout(location = 0) out float depth;  // z in C
layout(location = 1) out vec3 halved;  // normal, as a colour
void main() {
  vec3 n = normalize(vNormal);
  depth = vPosition.z;
  halved = 0.5 + (gl_FrontFacing ? 0.5 : -0.5) * n;
}
