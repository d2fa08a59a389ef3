// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms a SheetVertex.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 along;
layout(location = 3) in vec4 look;
layout(location = 4) in float erosion;
out vec3 vPosition;
out vec3 vNormal;
out vec3 vAlong;
out vec4 vLook;
out float vErosion;
void main() {
  vPosition = position;
  vNormal = normal;
  vAlong = along;
  vLook = look;
  vErosion = erosion;
  gl_Position = project(position, focal);
}
