// SPDX-License-Identifier: GPL-3.0-or-later
// A surface under the light of an endoscope.
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const receiver = R"(
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
)";

const char* const shadowLookup = R"(
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
)";

const char* const softShadow = R"(
// How much of the light reaches p, with normal n.
float shadow(vec3 p, vec3 n) {
  vec3 q = p + n * SHADOW_OFFSET - light;
  vec3 place = shadowPlace(q) - vec3(0.0, 0.0, 0.00004);
#if SOFT_SHADOWS
  // Penumbra of a light 3 mm wide: wider the farther the blocker stands before the receiver.
  mat2 turned = rotation(hash(uvec2(gl_FragCoord.xy) & 3u).x);
  vec2 wide = 0.5 * shadowFocal * 0.0030;
  float blockers = 0.0, blockerZ = 0.0;
  for (int i = 0; i < BLOCKERS; ++i) {
    vec2 at = sqrt((float(i) + 0.5) / float(BLOCKERS)) * spiral(i);
    float d = texture(shadowMap, place.xy + wide / q.z * (turned * at)).x;
    if (d < place.z) {
      float ndc = d * 2.0 - 1.0;
      blockerZ += 2.0 * depthRange.x * depthRange.y / (depthRange.y + depthRange.x - ndc * (depthRange.y - depthRange.x));
      blockers += 1.0;
    }
  }
  if (blockers < 0.5) return 1.0;
  blockerZ /= blockers;
  float penumbra = clamp((q.z - blockerZ) / blockerZ, 0.03, 1.2);
  float lit = 0.0;
  for (int i = 0; i < SHADOW_SAMPLES; ++i) {
    vec2 at = sqrt((float(i) + 0.5) / float(SHADOW_SAMPLES)) * spiral(i);
    lit += litAt(place + vec3(wide / q.z * penumbra * (turned * at), 0.0));
  }
  return lit / float(SHADOW_SAMPLES);
#else
  return litAt(place);
#endif
}
)";

const char* const backdropFragment = R"(
uniform vec2 pixelShare;         // one over the size of this target
uniform sampler2D backdropMap;   // of half the size; alpha 0 where it was hidden
layout(location = 0) out vec4 radiance;
void main() {
  vec4 s = texture(backdropMap, gl_FragCoord.xy * pixelShare);
  // A gap that is too narrow for half the size is as dark as gaps are.
  radiance = vec4(s.a > 0.02 ? s.rgb * (1.0 / s.a) : vec3(0.070, 0.020, 0.016), 1.0);
}
)";

const char* const surfaceFragment = R"(
in vec3 vPosition;
in vec3 vNormal;
in vec3 vRest;
in vec3 vRestNormal;
in vec2 vHarm;
#if BROAD_PER_VERTEX
in vec4 vBroadA, vBroadB, vBroadC, vBroadD;
#endif

uniform sampler2D occlusionMap;

// The least rotation from the rest normal to the present one carries slopes from rest to now.
vec3 carried(vec3 v, vec3 from, vec3 to) {
  vec3 axis = cross(from, to);
  float c = dot(from, to);
  if (c < -0.99) return -v;
  return v * c + cross(axis, v) + axis * (dot(axis, v) / (1.0 + c));
}

float fifth(float x) { return x * x * (x * x) * x; }

// Microfacet reflection (GGX; Walter et al., EGSR 2007) with Schlick's Fresnel and a compact visibility term.
vec3 gloss(float nl, float nv, float nh, float vh, float roughness, vec3 mirror) {
  float a2 = roughness * roughness; a2 *= a2;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float k = 0.5 * roughness * roughness;
  float hidden = (nl * (1.0 - k) + k) * (nv * (1.0 - k) + k);
  vec3 fresnel = mirror + (1.0 - mirror) * fifth(1.0 - vh);
  return fresnel * (0.25 * a2 * nl / (pi * d * d * hidden));
}

// What a mirror would see in the cavity: lit tissue ahead, dimmer to the sides, dark behind the lens.
vec3 surroundings(vec3 d) {
  float ahead = 0.5 + 0.5 * d.z;
  vec3 tissueLight = mix(vec3(0.015, 0.004, 0.003), vec3(0.36, 0.16, 0.13), ahead * ahead);
  return tissueLight + vec3(0.16, 0.12, 0.11) * smoothstep(0.2, 0.9, -d.y) * (0.3 + 0.7 * ahead);
}

void main() {
#if BROAD_PER_VERTEX
  Broad broad = Broad(vBroadA, vBroadB, vBroadC, vBroadD);
#else
  Broad broad = broadOf(vRest);
#endif
  Material m = materialOf(vRest, vRestNormal, vHarm, broad);
  vec3 n0 = normalize(vNormal);
  if (!gl_FrontFacing) n0 = -n0;
#if EXACT
  vec3 nr = normalize(vRestNormal);
#else
  vec3 nr = vRestNormal;
#endif
  vec3 slope = carried(m.slope - nr * dot(m.slope, nr), nr, n0);
  // Farther away a pixel covers many bumps; its gloss widens instead of glittering.
  vec3 across = fwidth(vPosition);
  slope *= 1.0 / (1.0 + 0.8e6 * dot(across, across));
  vec3 n = normalize(n0 - slope);

  vec3 v = -normalize(vPosition);
  vec3 l;
  float received = lightAt(vPosition, l);
  vec3 h = normalize(l + v);
  float nl = dot(n, l);
  float nv = clamp(dot(n, v), 0.02, 1.0);
  float nh = clamp(dot(n, h), 0.0, 1.0);
  float vh = clamp(dot(v, h), 0.0, 1.0);

  float occlusion = texture(occlusionMap, gl_FragCoord.xy * pixelShare).x;
  float lit = received * shadow(vPosition, n0);

  vec3 wrapped = clamp((vec3(nl) + m.scatter) * (1.0 / (1.0 + m.scatter)), 0.0, 1.0);
  wrapped *= wrapped * 0.35 + 0.65;
  // Light between walls of tissue is red: occlusion darkens blue and green first.
  vec3 ambientOpen = vec3(occlusion, occlusion * occlusion, occlusion * occlusion);
  vec3 diffuse = m.albedo * (wrapped * lit * (0.35 + 0.65 * ambientOpen) * 1.9 + vec3(0.16, 0.085, 0.075) * ambientOpen * (0.25 + 0.75 * min(received, 1.0)));

  float nlc = clamp(nl, 0.0, 1.0);
  vec3 specular = gloss(nlc, nv, nh, vh, m.roughness, m.mirror) * lit * 2.2;
  if (m.film > 0.0) {
    vec3 nFilm = normalize(n0 - 0.8 * slope);
    float nhFilm = clamp(dot(nFilm, h), 0.0, 1.0);
    specular += m.film * gloss(clamp(dot(nFilm, l), 0.0, 1.0), nv, nhFilm, vh, 0.20, vec3(0.026)) * min(lit, 1.6) * 1.6;
  }

  vec3 r = reflect(-v, n);
  vec3 fresnel = m.mirror + (max(vec3(0.55 - 0.5 * m.roughness), m.mirror) - m.mirror) * fifth(1.0 - nv);
  vec3 around = surroundings(r) * (0.2 + 0.8 * min(received, 1.0)) * occlusion;
  // Polished metal mirrors instruments and drapes too: a greyer room, brightest straight ahead of the lens.
  if (m.mirror.x > 0.3) around = 1.5 * mix(around, vec3(dot(around, vec3(0.4, 0.4, 0.2))), 0.72) + 0.10 * received * nv * nv * nv * (nv * nv * nv);
  vec3 rim = fresnel * around;

  show(diffuse + specular * mix(0.4, 1.0, occlusion) + rim, 1.0);
}
)";

}  // namespace calot::gui::glsl
