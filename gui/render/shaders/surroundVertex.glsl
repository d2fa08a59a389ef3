// SPDX-License-Identifier: GPL-3.0-or-later
// Around the endoscope's round field, before everything.
uniform vec2 field;  // half axes of the endoscope's round field in clip coordinates

// A ring of quads, each of two triangles, from the field to far outside, at the near plane: what comes later is hidden.
const ivec2 corner[6] = ivec2[](ivec2(0, 0), ivec2(0, 1), ivec2(1, 0), ivec2(1, 0), ivec2(0, 1), ivec2(1, 1));
void main() {
  ivec2 at = corner[gl_VertexID % 6];
  float angle = float(gl_VertexID / 6 + at.x) * (2.0 * pi / float(FIELD_SIDES));
  gl_Position = vec4((at.y == 0 ? 1.0 : 4.0) * field * vec2(cos(angle), sin(angle)), -1.0, 1.0);
}
