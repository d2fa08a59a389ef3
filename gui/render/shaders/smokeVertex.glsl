// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms a SmokeVertex.
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 corner;
layout(location = 2) in vec2 look;  // opacity, offset into the noise
out vec3 vPosition;
out vec2 vCorner;
out vec2 vLook;
void main() {
  vPosition = position;
  vCorner = corner;
  vLook = look;
  gl_Position = project(position, focal);
}
