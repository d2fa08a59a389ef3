// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface receives of the light, and how it is shown.
uniform float referenceDistance;         // where the exposure is right (m)
uniform vec2 pixels;                     // size of this target
uniform vec2 pixelShare;                 // one over it
uniform vec3 light;                      // position in C (m)
layout(location = 0) out vec4 radiance;  // multiplied by the opacity

// What the endoscope's light gives a surface at p that faces it: inverse square, in a cone that fades, right at the
// reference distance. l: the direction in which the light is.
float lightAt(vec3 p, out vec3 l) {
  vec3 toLight = light - p;
  float d2 = max(dot(toLight, toLight), 0.0004);
  l = normalize(toLight);
  float ahead = clamp(-l.z, 0.0, 1.0);
  float given = ahead * ahead * sqrt(ahead) * referenceDistance * referenceDistance;
  return 1.25 * given / (d2 + 0.35 * given);  // a camera's knee for what comes too close
}

// @param whole multiplied by the opacity
void show(vec3 whole, float opacity) {
#if DIRECT
  whole = shown(whole / opacity, gl_FragCoord.xy, pixels) * opacity;
#endif
  radiance = vec4(whole, opacity);
}
