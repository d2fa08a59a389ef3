// SPDX-License-Identifier: GPL-3.0-or-later
// Lighting.
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
#if LOOK >= 10 && !EXACT
  nv = max(nv, 0.25);  // a rim narrower than a pixel would be a line of dots along a shaft
#endif
  vec3 fresnel = m.mirror + (max(vec3(0.55 - 0.5 * m.roughness), m.mirror) - m.mirror) * fifth(1.0 - nv);
  vec3 around = surroundings(r) * (0.2 + 0.8 * min(received, 1.0)) * occlusion;
  // Polished metal mirrors instruments and drapes too: a greyer room, brightest straight ahead of the lens.
  if (m.mirror.x > 0.3) around = 1.5 * mix(around, vec3(dot(around, vec3(0.4, 0.4, 0.2))), 0.72) + 0.10 * received * nv * nv * nv * (nv * nv * nv);
  vec3 rim = fresnel * around;

  show(diffuse + specular * mix(0.4, 1.0, occlusion) + rim, 1.0);
}
