// SPDX-License-Identifier: GPL-3.0-or-later
// The cavity, from a target of half the size.
uniform vec2 pixelShare;         // one over the size of this target
uniform sampler2D backdropMap;   // of half the size; alpha 0 where it was hidden
layout(location = 0) out vec4 radiance;
void main() {
  vec4 s = texture(backdropMap, gl_FragCoord.xy * pixelShare);
  // A gap that is too narrow for half the size is as dark as gaps are.
  radiance = vec4(s.a > 0.02 ? s.rgb * (1.0 / s.a) : vec3(0.070, 0.020, 0.016), 1.0);
}
