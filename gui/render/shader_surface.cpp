// SPDX-License-Identifier: GPL-3.0-or-later
// Wet tissue and brushed metal under the light of an endoscope. The looks are functions of the rest position, so that
// they stick to the tissue however it deforms.
#include "gui/render/shader_sources.h"

namespace calot::gui::glsl {

const char* const surfaceMaterial = R"(
struct Material {
  vec3 albedo;     // linear
  vec3 scatter;    // how far light wraps around an edge, per channel
  vec3 slope;      // gradient of the height in rest coordinates (dimensionless)
  vec3 mirror;     // reflectance at normal incidence
  float roughness;
  float film;      // share of a thin wet film's sharp gloss
};

// A net of vessels: the zero lines of a bent, stretched noise. Dividing by the slope gives every line the same width (in
// cells); fading by a slower noise opens the loops into branches that thin out.
float vessels(vec3 p, float width) {
  vec4 bend = noise(p * 1.3 + 3.1);
  vec4 n = noise(p + 0.11 * bend.xyz);
  float away = abs(n.w) / max(length(n.xyz), 0.6);
  float strength = smoothstep(-0.15, 0.40, noise(p * 0.55 + 7.7).w);
  float w = width * (0.25 + 0.75 * strength);
  return strength * (1.0 - smoothstep(0.35 * w, w, away));
}

Material liver(vec3 mm) {
  vec4 wide = noise(mm / 43.0);
  vec4 middle = noise(mm / 13.0 + 0.4 * wide.xyz);
  vec4 lobules = noise(mm / 1.9);
  vec4 grain = noise(mm / 0.83 + 5.0);
  Material m;
  float tone = 0.5 + 0.55 * wide.w + 0.35 * middle.w;
  m.albedo = mix(vec3(0.082, 0.023, 0.017), vec3(0.165, 0.056, 0.038), clamp(tone, 0.0, 1.0));
  m.albedo *= 1.0 + 0.20 * lobules.w + 0.10 * grain.w;
  m.albedo = mix(m.albedo, vec3(0.245, 0.100, 0.066), 0.30 * smoothstep(0.20, 0.6, middle.w + 0.2 * lobules.w));
  m.scatter = vec3(0.26, 0.08, 0.06);
  m.slope = 1.10 / 13.0 * middle.xyz + 0.060 / 1.9 * lobules.xyz + 0.014 / 0.83 * grain.xyz;
  m.mirror = vec3(0.028);
  m.roughness = 0.40;
  m.film = 0.95;
  return m;
}

Material gallbladder(vec3 mm) {
  vec4 wide = noise(mm / 24.0 + 2.0);
  vec4 middle = noise(mm / 7.0);
  vec4 fine = noise(mm / 1.3);
  Material m;
  float tone = clamp(0.5 + 0.7 * wide.w + 0.35 * middle.w, 0.0, 1.0);
  m.albedo = mix(vec3(0.026, 0.055, 0.047), vec3(0.086, 0.108, 0.066), tone);
  // Serosa: pale where the wall is thicker, with a little fat under it.
  float pale = smoothstep(0.10, 0.60, noise(mm / 17.0 + 9.0).w + 0.25 * middle.w);
  m.albedo = mix(m.albedo, vec3(0.200, 0.160, 0.080), 0.45 * pale);
  float large = vessels(mm * vec3(1.0, 0.4, 0.7) / 10.0, 0.026);
  float small = vessels(mm * vec3(1.0, 0.55, 0.8) / 5.0 + 4.0, 0.034);
  m.albedo = mix(m.albedo, vec3(0.075, 0.012, 0.016), 0.50 * large);
  m.albedo = mix(m.albedo, vec3(0.110, 0.024, 0.022), 0.38 * small);
  m.albedo *= 1.0 + 0.10 * fine.w;
  m.scatter = vec3(0.26, 0.24, 0.18);
  m.slope = 0.55 / 7.0 * middle.xyz + 0.030 / 1.3 * fine.xyz;
  m.mirror = vec3(0.030);
  m.roughness = 0.36;
  m.film = 1.0;
  return m;
}

Material cavityWall(vec3 mm) {
  vec4 wide = noise(mm / 61.0 + 1.0);
  vec4 middle = noise(mm / 27.0 + 0.5 * wide.xyz);
  vec4 lobes = noise(mm / 8.0 + 0.3 * middle.xyz);
  vec4 small = noise(mm / 3.1);
  Material m;
  m.albedo = mix(vec3(0.200, 0.058, 0.046), vec3(0.330, 0.125, 0.095), clamp(0.5 + 0.7 * wide.w, 0.0, 1.0));
  float fat = smoothstep(-0.15, 0.55, middle.w + 0.30 * lobes.w + 0.10 * small.w);
  m.albedo = mix(m.albedo, vec3(0.400, 0.235, 0.105), 0.55 * fat);
  m.albedo *= 1.0 + 0.20 * lobes.w + 0.10 * small.w;
  m.albedo = mix(m.albedo, vec3(0.150, 0.022, 0.024), 0.40 * vessels(mm * vec3(1.0, 0.6, 0.8) / 21.0, 0.035));
  m.scatter = vec3(0.35, 0.15, 0.10);
  m.slope = 2.2 / 27.0 * middle.xyz + (0.5 + 0.6 * fat) / 8.0 * lobes.xyz + 0.12 / 3.1 * small.xyz;
  m.mirror = vec3(0.026);
  m.roughness = 0.50;
  m.film = 0.45;
  return m;
}

Material tissue(vec3 mm) {
  vec4 middle = noise(mm / 9.0);
  vec4 fine = noise(mm / 1.7);
  Material m;
  m.albedo = mix(vec3(0.34, 0.12, 0.09), vec3(0.45, 0.20, 0.15), clamp(0.5 + 0.8 * middle.w, 0.0, 1.0)) * (1.0 + 0.1 * fine.w);
  m.scatter = vec3(0.35, 0.15, 0.10);
  m.slope = 0.25 / 9.0 * middle.xyz + 0.03 / 1.7 * fine.xyz;
  m.mirror = vec3(0.028);
  m.roughness = 0.42;
  m.film = 0.7;
  return m;
}

Material solid(vec3 albedo, vec3 mirror, float roughness) {
  return Material(albedo, vec3(0.0), vec3(0.0), mirror, roughness, 0.0);
}

// Brushed along the shaft: fine grooves across it, long along it.
Material brushed(vec3 mm, vec3 mirror, float roughness) {
  Material m = solid(vec3(0.0), mirror, roughness);
  vec4 groove = noise(vec3(mm.xy * 5.5, mm.z * 0.35));
  m.slope = 0.10 * vec3(groove.xy, 0.0);
  m.mirror *= 1.0 + 0.10 * groove.w;
  return m;
}

Material materialOf(int appearance, vec3 rest) {
  vec3 mm = rest * 1000.0;
  if (appearance == 1) return liver(mm);
  if (appearance == 2) return gallbladder(mm);
  if (appearance == 3) return cavityWall(mm);
  if (appearance == 10) return solid(vec3(0.010, 0.010, 0.011), vec3(0.042), 0.33);
  if (appearance == 11) return brushed(mm, vec3(0.60, 0.585, 0.57), 0.27);
  if (appearance == 12) return solid(vec3(0.62, 0.58, 0.50), vec3(0.045), 0.30);
  if (appearance == 13) return brushed(mm, vec3(0.56, 0.54, 0.60), 0.30);
  return tissue(mm);
}
)";

const char* const surfaceFragment = R"(
in vec3 vPosition;
in vec3 vNormal;
in vec3 vRest;
in vec3 vRestNormal;
layout(location = 0) out vec4 radiance;

uniform int appearance;
uniform vec3 light;              // position in C (m)
uniform float referenceDistance; // where the exposure is right (m)
uniform vec2 pixels;             // size of this target
uniform sampler2D occlusionMap;
uniform sampler2D shadowMap;
uniform vec2 shadowFocal;
uniform vec2 focalOfEye;

// The least rotation from the rest normal to the present one carries slopes from rest to now.
vec3 carried(vec3 v, vec3 from, vec3 to) {
  vec3 axis = cross(from, to);
  float c = dot(from, to);
  if (c < -0.99) return -v;
  return v * c + cross(axis, v) + axis * (dot(axis, v) / (1.0 + c));
}

float shadow(vec3 p, vec3 n) {
  vec3 q = p + n * 0.0006 - light;
  vec4 clip = project(q, shadowFocal);
  vec2 uv = clip.xy / clip.w * 0.5 + 0.5;
  float depth = clip.z / clip.w * 0.5 + 0.5;
  float bias = 0.00004;
  // Penumbra of a light 3 mm wide: wider the farther the blocker stands before the receiver.
  vec2 turn = hash(uvec2(gl_FragCoord.xy) & 3u);
  float a0 = turn.x * 2.0 * pi;
  vec2 wide = 0.5 * shadowFocal * 0.0030;
  float blockers = 0.0, blockerZ = 0.0;
  for (int i = 0; i < BLOCKERS; ++i) {
    float r = sqrt((float(i) + 0.5) / float(BLOCKERS)), a = a0 + 2.39996 * float(i);
    float d = texture(shadowMap, uv + wide / q.z * r * vec2(cos(a), sin(a))).x;
    if (d < depth - bias) {
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
    float r = sqrt((float(i) + 0.5) / float(SHADOW_SAMPLES)), a = a0 + 2.39996 * float(i);
    float d = texture(shadowMap, uv + wide / q.z * penumbra * r * vec2(cos(a), sin(a))).x;
    lit += d < depth - bias ? 0.0 : 1.0;
  }
  return lit / float(SHADOW_SAMPLES);
}

// Microfacet reflection (GGX; Walter et al., EGSR 2007) with Schlick's Fresnel and a compact visibility term.
vec3 gloss(float nl, float nv, float nh, float vh, float roughness, vec3 mirror) {
  float a2 = roughness * roughness; a2 *= a2;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float k = 0.5 * roughness * roughness;
  float visibility = 0.25 / ((nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
  vec3 fresnel = mirror + (1.0 - mirror) * pow(1.0 - vh, 5.0);
  return fresnel * (a2 / (pi * d * d) * visibility * nl);
}

// What a mirror would see in the cavity: lit tissue ahead, dimmer to the sides, dark behind the lens.
vec3 surroundings(vec3 d) {
  float ahead = 0.5 + 0.5 * d.z;
  vec3 tissueLight = mix(vec3(0.015, 0.004, 0.003), vec3(0.36, 0.16, 0.13), ahead * ahead);
  return tissueLight + vec3(0.16, 0.12, 0.11) * smoothstep(0.2, 0.9, -d.y) * (0.3 + 0.7 * ahead);
}

void main() {
  Material m = materialOf(appearance, vRest);
  vec3 n0 = normalize(vNormal);
  if (!gl_FrontFacing) n0 = -n0;
  vec3 nr = normalize(vRestNormal);
  vec3 slope = carried(m.slope - nr * dot(m.slope, nr), nr, n0);
  // Farther away a pixel covers many bumps; its gloss widens instead of glittering.
  float footprint = length(fwidth(vPosition)) * 1000.0;
  slope *= 1.0 / (1.0 + 0.8 * footprint * footprint);
  vec3 n = normalize(n0 - slope);

  vec3 v = -normalize(vPosition);
  vec3 toLight = light - vPosition;
  float d2 = dot(toLight, toLight);
  vec3 l = toLight * inversesqrt(d2);
  vec3 h = normalize(l + v);
  float nl = dot(n, l);
  float nv = clamp(dot(n, v), 0.02, 1.0);
  float nh = clamp(dot(n, h), 0.0, 1.0);
  float vh = clamp(dot(v, h), 0.0, 1.0);

  float received = lightAt(l, d2, referenceDistance);
  float occlusion = texture(occlusionMap, gl_FragCoord.xy / pixels).x;
  float lit = received * shadow(vPosition, n0);

  vec3 wrapped = clamp((vec3(nl) + m.scatter) / (1.0 + m.scatter), 0.0, 1.0);
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
  vec3 fresnel = m.mirror + (max(vec3(0.55 - 0.5 * m.roughness), m.mirror) - m.mirror) * pow(1.0 - nv, 5.0);
  vec3 around = surroundings(r) * (0.2 + 0.8 * min(received, 1.0)) * occlusion;
  // Polished metal mirrors instruments and drapes too: a greyer room, brightest straight ahead of the lens.
  if (m.mirror.x > 0.3) around = 1.5 * mix(around, vec3(dot(around, vec3(0.4, 0.4, 0.2))), 0.72) + 0.10 * received * pow(clamp(dot(n, v), 0.0, 1.0), 6.0);
  vec3 rim = fresnel * around;

  radiance = vec4(diffuse + specular * mix(0.4, 1.0, occlusion) + rim, 1.0);
}
)";

}  // namespace calot::gui::glsl
