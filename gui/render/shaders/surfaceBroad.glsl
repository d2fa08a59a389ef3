// SPDX-License-Identifier: GPL-3.0-or-later
// Slow noises of the looks, for vertices or pixels.
// Slow noises of a look; what each one is stands at broadOf().
struct Broad { vec4 a, b, c, d; };

// Of a net of vessels: how its lines are bent (xyz), and where it is strong (w).
vec4 netOf(vec3 p) { return vec4(noise(p * 1.3 + 3.1).xyz, smoothstep(-0.15, 0.40, noise(p * 0.55 + 7.7).w)); }

// In the coordinates of a net, lines run farther along some axes than along others.
vec3 wallNet(vec3 mm) { return mm * vec3(1.0, 0.6, 0.8) / 21.0; }
vec3 ductNet(vec3 mm) { return mm / 3.0 + 2.0; }
vec3 fatNet(vec3 mm) { return mm / 7.0 + 5.0; }

Broad broadOf(vec3 rest) {
  vec3 mm = rest * 1000.0;
  Broad f = Broad(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
#if LOOK == 1    // liver: wide, middle
  f.a = noise(mm / 43.0);
  f.b = noise(mm / 13.0 + 0.4 * f.a.xyz);
#elif LOOK == 2  // gallbladder: middle; wide and pale
  f.a = noise(mm / 7.0);
  f.b = vec4(noise(mm / 24.0 + 2.0).w, noise(mm / 17.0 + 9.0).w, 0.0, 0.0);
#elif LOOK == 3  // cavity: middle, net; wide
  vec4 wide = noise(mm / 61.0 + 1.0);
  f.a = noise(mm / 27.0 + 0.5 * wide.xyz);
  f.b = netOf(wallNet(mm));
  f.c = vec4(wide.w, 0.0, 0.0, 0.0);
#elif LOOK == 4  // duct: middle, net; wide
  f.a = noise(mm / 3.4);
  f.b = netOf(ductNet(mm));
  f.c = vec4(noise(mm / 11.0 + 6.0).w, 0.0, 0.0, 0.0);
#elif LOOK == 5  // artery: wide
  f.a = noise(mm / 6.0 + 4.0);
#elif LOOK == 6  // fat: bend, net; wide
  f.a = noise(mm / 6.5 + 3.0);
  f.b = netOf(fatNet(mm));
  f.c = vec4(noise(mm / 15.0 + 8.0).w, 0.0, 0.0, 0.0);
#elif LOOK == 7  // omentum: bend; wide, middle
  f.a = noise(mm / 9.0 + 3.0);
  f.b = vec4(noise(mm / 38.0 + 8.0).w, noise(mm / 17.0 + 1.0).w, 0.0, 0.0);
#elif LOOK == 8  // bowel: middle; wide
  f.a = noise(mm / 12.0 + 6.0);
  f.b = vec4(noise(mm / 33.0 + 4.0).w, 0.0, 0.0, 0.0);
#elif LOOK == 0  // plain tissue: middle
  f.a = noise(mm / 9.0);
#endif
  return f;
}
