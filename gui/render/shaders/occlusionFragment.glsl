// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the surroundings a point sees.
uniform sampler2D normalMap;     // halved, around 0.5
uniform sampler2D depthMap;      // z in C (m), 0: nothing
uniform float reach;             // how far a surface darkens another (m)
layout(location = 0) out vec4 halvedAndOpen;  // the normal, as it came; how open it is

vec3 pointAt(vec2 pixel, float z, vec2 size) {
  vec2 clip = (pixel + 0.5) / size * 2.0 - 1.0;
  return vec3(clip.x / focal.x, -clip.y / focal.y, 1.0) * z;
}

// Share of the half-space above the surface that near surfaces leave open, by samples on a disk of fixed reach
// (in the spirit of Bavoil and Sainz, "Image-space horizon-based ambient occlusion", 2008).
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) * STRIDE;  // of the prepass
  ivec2 size = textureSize(depthMap, 0);
  float here = texelFetch(depthMap, pixel, 0).x;
  halvedAndOpen = vec4(1.0);
  if (here <= 0.0) return;
  vec3 p = pointAt(vec2(pixel), here, vec2(size));
  vec3 halved = texelFetch(normalMap, pixel, 0).xyz;
  vec3 n = normalize(halved - 0.5);
  float disk = clamp(reach * abs(focal.y) * 0.5 * float(size.y) / here, 3.0, 0.35 * float(size.y));
  vec2 turn = hash(uvec2(gl_FragCoord.xy) & uint(PATTERN - 1));
  mat2 turned = rotation(turn.x);
  float closed = 0.0;
  for (int i = 0; i < OCCLUSION_SAMPLES; ++i) {
    float r = (float(i) + 0.3 + 0.7 * turn.y) / float(OCCLUSION_SAMPLES);
    ivec2 there = pixel + ivec2(turned * (disk * r * spiral(i)));
    there = clamp(there, ivec2(0), size - 1);
    float z = texelFetch(depthMap, there, 0).x;
    if (z <= 0.0) continue;
    vec3 v = pointAt(vec2(there), z, vec2(size)) - p;
    float distance2 = dot(v, v);
    float fall = clamp(1.0 - distance2 / (reach * reach), 0.0, 1.0);
    closed += max(0.0, dot(v, n) * inversesqrt(distance2 + 1e-9) - 0.10) * fall;
  }
  halvedAndOpen = vec4(halved, clamp(1.0 - 2.1 * closed / float(OCCLUSION_SAMPLES), 0.0, 1.0));
}
