// SPDX-License-Identifier: GPL-3.0-or-later
// Tone curve, sRGB, the endoscope's field.
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
