// SPDX-License-Identifier: GPL-3.0-or-later
// Passes over the whole picture.
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const occlusionFragment = R"(
uniform sampler2D normalAndDepth;
uniform float reach;             // how far a surface darkens another (m)
layout(location = 0) out float open;

vec3 pointAt(vec2 pixel, float z, vec2 size) {
  vec2 clip = (pixel + 0.5) / size * 2.0 - 1.0;
  return vec3(clip.x / focal.x, -clip.y / focal.y, 1.0) * z;
}

// Share of the half-space above the surface that near surfaces leave open, by samples on a disk of fixed reach
// (in the spirit of Bavoil and Sainz, "Image-space horizon-based ambient occlusion", 2008).
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(normalAndDepth, 0);
  vec4 here = texelFetch(normalAndDepth, pixel, 0);
  open = 1.0;
  if (here.w <= 0.0) return;
  vec3 p = pointAt(vec2(pixel), here.w, vec2(size));
  vec3 n = here.xyz;
  float disk = clamp(reach * focal.y * 0.5 * float(size.y) / here.w, 3.0, 0.35 * float(size.y));
  vec2 turn = hash(uvec2(pixel) & 3u);
  float closed = 0.0;
  for (int i = 0; i < OCCLUSION_SAMPLES; ++i) {
    float r = (float(i) + 0.3 + 0.7 * turn.y) / float(OCCLUSION_SAMPLES);
    float a = turn.x * 2.0 * pi + 2.39996 * float(i);
    ivec2 there = pixel + ivec2(disk * r * vec2(cos(a), sin(a)));
    there = clamp(there, ivec2(0), size - 1);
    float z = texelFetch(normalAndDepth, there, 0).w;
    if (z <= 0.0) continue;
    vec3 v = pointAt(vec2(there), z, vec2(size)) - p;
    float distance2 = dot(v, v);
    float fall = clamp(1.0 - distance2 / (reach * reach), 0.0, 1.0);
    closed += max(0.0, dot(v, n) * inversesqrt(distance2 + 1e-9) - 0.10) * fall;
  }
  open = clamp(1.0 - 2.1 * closed / float(OCCLUSION_SAMPLES), 0.0, 1.0);
}
)";

const char* const blurFragment = R"(
uniform sampler2D openMap;
uniform sampler2D normalAndDepth;
layout(location = 0) out float open;
// The sampling pattern repeats every four pixels: a mean over four by four takes it away.
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(openMap, 0);
  vec4 here = texelFetch(normalAndDepth, pixel, 0);
  float sum = 0.0, weights = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      ivec2 there = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
      vec4 other = texelFetch(normalAndDepth, there, 0);
      float weight = 1e-4 + clamp(1.0 - abs(other.w - here.w) / (0.02 * here.w + 1e-5), 0.0, 1.0) * clamp(dot(other.xyz, here.xyz), 0.0, 1.0);
      sum += weight * texelFetch(openMap, there, 0).x;
      weights += weight;
    }
  open = sum / weights;
}
)";

const char* const composeFragment = R"(
uniform sampler2D radianceMap;
uniform int samples;             // a side
uniform int mask;
layout(location = 0) out vec4 colour;

// Filmic curve (fit by Narkowicz, "ACES filmic tone mapping curve", 2015), then sRGB.
vec3 tone(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }
vec3 encode(vec3 x) { return mix(12.92 * x, 1.055 * pow(max(x, vec3(1e-5)), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x)); }

void main() {
  ivec2 size = textureSize(radianceMap, 0) / samples;
  ivec2 pixel = ivec2(gl_FragCoord.x, size.y - 1 - int(gl_FragCoord.y));  // first row on top
  vec4 sum = vec4(0.0);
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) {
      vec4 s = texelFetch(radianceMap, pixel * samples + ivec2(x, y), 0);
      // Translucent tissue over nothing leaves its colour multiplied by its opacity.
      vec3 whole = s.a < 1.0 ? s.rgb / max(s.a, 1e-3) : s.rgb;
      sum += vec4(tone(0.85 * whole) * s.a, s.a);
    }
  float covered = sum.a / float(samples * samples);
  vec3 linear = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  if (mask != 0) {
    float side = float(min(size.x, size.y));
    float radius = length(vec2(pixel) + 0.5 - 0.5 * vec2(size)) / (0.5 * side);
    float rim = size.x == size.y ? 0.985 : 1.12;     // wide pictures cut the circle above and below
    linear *= mix(1.0, 0.38, smoothstep(0.45, 1.0, radius / rim));
    float edge = 3.0 / side;
    linear *= 1.0 - smoothstep(rim - edge, rim + edge, radius);
    covered = max(covered, smoothstep(rim - edge, rim + edge, radius));
  }
  colour = vec4(encode(linear), covered);
}
)";

}  // namespace calot::gui::glsl
