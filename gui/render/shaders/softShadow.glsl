// SPDX-License-Identifier: GPL-3.0-or-later
// The endoscope's shadow on a surface.
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
#elif LOOK == 3 || LOOK == 7 || LOOK == 8
  // The surroundings have half the size: a shadow that is narrower than their pixels would break into dashes.
  vec2 aside = 0.6 * shadowFocal * pixelShare / abs(focal);
  return 0.25 * (litAt(place + vec3(aside, 0.0)) + litAt(place - vec3(aside, 0.0)) +
                 litAt(place + vec3(aside.x, -aside.y, 0.0)) + litAt(place + vec3(-aside.x, aside.y, 0.0)));
#else
  return litAt(place);
#endif
}
