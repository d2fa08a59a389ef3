// SPDX-License-Identifier: GPL-3.0-or-later
// Asks the shadow map.
uniform vec2 shadowFocal;
#if SOFT_SHADOWS
uniform sampler2D shadowMap;
float litAt(vec3 place) { return texture(shadowMap, place.xy).x < place.z ? 0.0 : 1.0; }
#else
uniform sampler2DShadow shadowMap;
float litAt(vec3 place) { return texture(shadowMap, place); }
#endif

// Where in the shadow map q, seen from the light, is: texture coordinates and depth.
vec3 shadowPlace(vec3 q) {
  vec4 clip = project(q, shadowFocal);
  return clip.xyz * (0.5 / clip.w) + 0.5;
}
