// SPDX-License-Identifier: GPL-3.0-or-later
// Areolar tissue: translucent films with fibres, wet, whitish yellow; brown and then black where the hook heats it.
in vec3 vPosition;
in vec3 vNormal;
in vec3 vAlong;
in vec4 vLook;
in float vErosion;

uniform sampler2D fibreMap;
uniform sampler2D occlusionMap;

vec3 unit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1e-12)); }

// Hard where one tap is taken, soft at the edge where there are four.
float shadow(vec3 p) {
  vec3 q = p - light;
  vec3 place = shadowPlace(q);
  // What stands less than 2 mm in front is the organ that the tissue hangs on.
  place.z = shadowPlace(q * (1.0 - 0.002 / max(q.z, 0.004))).z;
  float lit = 0.0;
  for (int i = 0; i < SHEET_SHADOW_SAMPLES; ++i) {
    vec2 offset = SHEET_SHADOW_SAMPLES == 1 ? vec2(0.0) : 0.5 * shadowFocal * 0.0008 / q.z * spiral(i);
    lit += litAt(place + vec3(offset, 0.0));
  }
  return lit / float(SHEET_SHADOW_SAMPLES);
}

void main() {
  vec4 f = texture(fibreMap, vLook.xy);
  float fibre = smoothstep(vErosion, vErosion + 0.45, f.r);
  float film = smoothstep(vErosion + 0.05, vErosion + 0.75, f.g);
  vec3 v = -normalize(vPosition);
  vec3 n = unit(vNormal);
  float facing = abs(dot(n, v));
  // The more a film is seen along itself, the more of it lies behind a pixel.
  film = clamp(0.12 * film / (0.30 + 0.70 * facing), 0.0, 0.5);
  float opacity = vLook.z * (1.0 - (1.0 - 0.38 * fibre) * (1.0 - film));
  if (opacity < 0.006) discard;

  vec3 l;
  float received = lightAt(vPosition, l);
  vec3 h = normalize(l + v);
  float occlusion = mix(0.62, 1.0, texture(occlusionMap, gl_FragCoord.xy / pixels).x);
  float lit = received * mix(0.12, 1.0, shadow(vPosition));

  vec3 t = unit(vAlong);
  vec3 aside = cross(n, t);
  n = unit(n + aside * 1.1 * (f.b - 0.5));
  // Light passes through: either side is lit, the far one a little less.
  float nl = dot(n, l) * (dot(n, v) < 0.0 ? -1.0 : 1.0);
  float wrapped = 0.35 + 0.65 * (nl > 0.0 ? nl : -0.6 * nl);

  vec3 albedo = mix(vec3(0.47, 0.33, 0.20), vec3(0.76, 0.64, 0.44), clamp(0.25 + 0.85 * fibre, 0.0, 1.0));
  albedo *= 0.85 + 0.3 * f.a;
  float burnt = vLook.w;
  albedo = mix(albedo, vec3(0.125, 0.055, 0.022), smoothstep(0.0, 0.55, burnt));
  albedo = mix(albedo, vec3(0.012, 0.009, 0.008), smoothstep(0.45, 1.0, burnt));
  vec3 open = vec3(occlusion, vec2(occlusion * mix(1.0, occlusion, 0.5)));
  vec3 diffuse = albedo * open * (1.0 * wrapped * lit + vec3(0.16, 0.085, 0.075) * (0.25 + 0.75 * min(received, 1.0)));

  // A glint along each fibre (Kajiya and Kay, SIGGRAPH 1989), and the wet film's.
  float across = 1.0 - dot(t, h) * dot(t, h);
  float silk = pow(max(across, 0.0), 40.0) * (0.25 + 0.75 * fibre);
  float nh = abs(dot(n, h));
  float wet = pow(nh, 60.0);
  float gloss = (0.07 * silk + 0.5 * wet) * min(lit, 1.6) * occlusion * (1.0 - smoothstep(0.0, 0.6, burnt));
  show(diffuse * opacity + vec3(gloss * min(1.0, 1.6 * opacity)), opacity);
}
