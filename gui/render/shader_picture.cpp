// SPDX-License-Identifier: GPL-3.0-or-later
// Passes over the whole picture.
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const occlusionFragment = R"(
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
)";

const char* const blurFragment = R"(
uniform sampler2D openMap;   // normal, halved around 0.5; how open it is
uniform sampler2D depthMap;
layout(location = 0) out float open;
// The sampling pattern repeats every PATTERN pixels: a mean over as many each way takes it away.
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(openMap, 0);
  float here = texelFetch(depthMap, pixel * STRIDE, 0).x;
  vec3 n = texelFetch(openMap, pixel, 0).xyz - 0.5;
  float sum = 0.0, weights = 0.0;
  for (int y = -PATTERN / 2; y < PATTERN / 2; ++y)
    for (int x = -PATTERN / 2; x < PATTERN / 2; ++x) {
      ivec2 there = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
      vec4 other = texelFetch(openMap, there, 0);
      float away = abs(texelFetch(depthMap, there * STRIDE, 0).x - here) / (0.02 * here + 1e-5);
      float alike = 4.0 * dot(other.xyz - 0.5, n);
      float weight = 1e-4 + clamp(1.0 - away, 0.0, 1.0) * clamp(alike, 0.0, 1.0);
      sum += weight * other.w;
      weights += weight;
    }
  open = sum / weights;
}
)";

const char* const display = R"(
uniform vec2 fieldRim;           // radius of the endoscope's round field and how far it fades (pixels); 0: no field
uniform vec2 fieldShare;         // one over the radius; one over twice the fading

// Filmic curve (fit by Narkowicz, "ACES filmic tone mapping curve", 2015), then sRGB.
vec3 tone(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }
vec3 encode(vec3 x) { return mix(12.92 * x, 1.055 * pow(max(x, vec3(1e-5)), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x)); }

// From 0 to 1 between two edges, as smoothstep, but with one over their distance.
float rise(float from, float share, float x) {
  float t = clamp((x - from) * share, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// How bright the endoscope's field is at a pixel, and how far that lies outside of it.
vec2 fieldAt(vec2 pixel, vec2 size) {
  if (fieldRim.x == 0.0) return vec2(1.0, 0.0);
  float radius = length(pixel - 0.5 * size);
  float outside = rise(fieldRim.x - fieldRim.y, fieldShare.y, radius);
  return vec2(mix(1.0, 0.38, rise(0.45, 1.0 / 0.55, radius * fieldShare.x)) * (1.0 - outside), outside);
}

#if DIRECT
// encode(tone(x)) as a quotient of polynomials of the root, within 0.3 levels of 255. A rasterizer on the processor pays
// for roots and quotients.
vec3 encodedTone(vec3 x) {
  vec3 s = sqrt(min(x, 7.24));
  vec3 above = ((((6.09938998 * s + 364.257471) * s - 77.6852799) * s + 5.98233010) * s - 0.08066558) * s;
  vec3 below = (((392.583176 * s - 139.836762) * s + 90.5950532) * s - 15.8369288) * s + 1.0;
  return clamp(above / below, 0.0, 1.0);
}

// Radiance as it is shown, without passes of its own: the field's vignette falls on what is encoded, as its own power.
vec3 shown(vec3 radiance, vec2 pixel, vec2 size) {
  vec3 c = encodedTone(0.85 * radiance);
  if (fieldRim.x == 0.0) return c;
  float radius = length(pixel - 0.5 * size);
  float t = rise(0.45, 1.0 / 0.55, radius * fieldShare.x);
  float vignette = 1.0 - t * (0.261939051 + t * (0.0275699885 + t * 0.0417281199));  // (1 - 0.62 t) to the power of 1/2.4
  float inside = 1.0 - rise(fieldRim.x - fieldRim.y, fieldShare.y, radius);
  // In the straight piece of sRGB's curve there is no offset.
  return max(c * vignette - 0.055 * (1.0 - vignette) * min(25.0 * c, 1.0), 0.0) * inside;
}
#endif
)";

const char* const composeFragment = R"(
uniform sampler2D radianceMap;
layout(location = 0) out vec4 colour;

const int samples = SAMPLES_ASIDE;

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
  vec2 field = fieldAt(vec2(pixel) + 0.5, vec2(size));
  colour = vec4(encode(linear * field.x), max(covered, field.y));
}
)";

}  // namespace calot::gui::glsl
