// SPDX-License-Identifier: GPL-3.0-or-later
// Wet tissue and brushed metal. The looks are functions of the rest position, so that they stick to the tissue however
// it deforms. What changes slowly along the tissue (surfaceBroad.glsl) stands apart: film quality computes it for every
// pixel, interactive quality for every vertex.
struct Material {
  vec3 albedo;     // linear
  vec3 scatter;    // how far light wraps around an edge, per channel
  vec3 slope;      // gradient of the height in rest coordinates (dimensionless)
  vec3 mirror;     // reflectance at normal incidence
  float roughness;
  float film;      // share of a thin wet film's sharp gloss
};

// The finest grain is left to film quality.
vec4 fineNoise(vec3 p) {
#if FINE
  return noise(p);
#else
  return vec4(0.0);
#endif
}

// A net of vessels: the zero lines of a bent, stretched noise. Dividing by the slope gives every line the same width (in
// cells); fading by a slower noise opens the loops into branches that thin out.
float vessels(vec3 p, vec4 net, float width) {
  vec4 n = noise(p + 0.11 * net.xyz);
  float away = abs(n.w) / max(length(n.xyz), 0.6);
  float w = width * (0.25 + 0.75 * net.w);
  return net.w * (1.0 - smoothstep(0.35 * w, w, away));
}

// Branching veins (scene_resources.h), from three sides; p in textures. Trunks run along y.
uniform sampler2D veinMap;
float veins(vec3 p, vec3 normal) {
  vec3 side = normal * normal;
  side *= side;
  float seen = side.x * texture(veinMap, p.zy).x + side.y * texture(veinMap, p.xz + 0.37).x + side.z * texture(veinMap, p.xy).x;
  return seen / (side.x + side.y + side.z);
}

Material wet(vec3 albedo, vec3 scatter, vec3 slope, float mirror, float roughness, float film) {
  return Material(albedo, scatter, slope, vec3(mirror), roughness, film);
}

Material liver(vec3 mm, Broad broad) {
  vec4 wide = broad.a, middle = broad.b;
  vec4 lobules = noise(mm / 1.9);
  vec4 grain = fineNoise(mm / 0.83 + 5.0);
  float tone = 0.5 + 0.55 * wide.w + 0.35 * middle.w;
  vec3 albedo = mix(vec3(0.082, 0.023, 0.017), vec3(0.165, 0.056, 0.038), clamp(tone, 0.0, 1.0));
  albedo *= 1.0 + 0.20 * lobules.w + 0.10 * grain.w;
  albedo = mix(albedo, vec3(0.245, 0.100, 0.066), 0.30 * smoothstep(0.20, 0.6, middle.w + 0.2 * lobules.w));
  return wet(albedo, vec3(0.26, 0.08, 0.06), 1.10 / 13.0 * middle.xyz + 0.060 / 1.9 * lobules.xyz + 0.014 / 0.83 * grain.xyz,
             0.028, 0.40, 0.95);
}

Material gallbladder(vec3 mm, vec3 normal, Broad broad) {
  vec4 middle = broad.a;
  vec4 fine = fineNoise(mm / 1.3);
  float tone = clamp(0.5 + 0.7 * broad.b.x + 0.35 * middle.w, 0.0, 1.0);
  vec3 albedo = mix(vec3(0.026, 0.055, 0.047), vec3(0.086, 0.108, 0.066), tone);
  // Serosa: pale where the wall is thicker, with a little fat under it.
  float pale = smoothstep(0.10, 0.60, broad.b.y + 0.25 * middle.w);
  albedo = mix(albedo, vec3(0.200, 0.160, 0.080), 0.45 * pale);
  albedo = mix(albedo, vec3(0.085, 0.014, 0.017), 0.48 * veins(mm / 60.0, normal));
  albedo *= 1.0 + 0.10 * fine.w;
  return wet(albedo, vec3(0.26, 0.24, 0.18), 0.55 / 7.0 * middle.xyz + 0.030 / 1.3 * fine.xyz,
             0.030, 0.36, 1.0);
}

// Wall of a bile duct: pale, yellow-green, bile shining through, a net of fine vessels on it.
Material duct(vec3 mm, Broad broad) {
  vec4 middle = broad.a;
  vec4 fine = fineNoise(mm / 0.7);
  vec3 albedo = mix(vec3(0.255, 0.235, 0.095), vec3(0.420, 0.370, 0.185), clamp(0.5 + 0.5 * broad.c.x + 0.5 * middle.w, 0.0, 1.0));
  float net = vessels(ductNet(mm), broad.b, 0.040);
  albedo = mix(albedo, vec3(0.300, 0.060, 0.045), 0.45 * net);
  albedo *= 1.0 + 0.08 * fine.w;
  return wet(albedo, vec3(0.30, 0.28, 0.18), 0.20 / 3.4 * middle.xyz + 0.020 / 0.7 * fine.xyz,
             0.032, 0.34, 1.0);
}

// Wall of an artery: red, with a paler sheath in streaks, smooth and wet.
Material artery(vec3 mm, Broad broad) {
  vec4 fine = noise(mm / 1.1);
  vec3 albedo = mix(vec3(0.300, 0.030, 0.026), vec3(0.420, 0.075, 0.058), clamp(0.5 + 0.7 * broad.a.w, 0.0, 1.0));
  albedo = mix(albedo, vec3(0.520, 0.240, 0.180), 0.35 * smoothstep(0.25, 0.65, fine.w));
  return wet(albedo, vec3(0.30, 0.08, 0.06), 0.08 / 1.1 * fine.xyz,
             0.034, 0.30, 1.0);
}

// Lobules: a noise folded at its zero lines, bulging between furrows, in two sizes.
Material fat(vec3 mm, Broad broad) {
  vec4 bend = broad.a;
  vec4 large = noise(mm / 4.4 + 0.25 * bend.xyz);
  vec4 small = noise(mm / 1.7 + 0.20 * bend.zxy);
  vec4 fine = fineNoise(mm / 0.6);
  float largeUp = min(abs(large.w) * 1.6, 1.0), smallUp = min(abs(small.w) * 1.6, 1.0);
  float up = clamp(0.62 * sqrt(largeUp) + 0.38 * sqrt(smallUp), 0.0, 1.0);
  vec3 albedo = mix(vec3(0.400, 0.170, 0.040), vec3(0.640, 0.395, 0.105), smoothstep(0.12, 0.62, up));
  albedo = mix(albedo, vec3(0.700, 0.490, 0.200), 0.45 * smoothstep(0.0, 0.6, broad.c.x));
  float net = vessels(fatNet(mm), broad.b, 0.026);
  albedo = mix(albedo, vec3(0.330, 0.045, 0.030), 0.50 * net);
  albedo *= 1.0 + 0.07 * fine.w;
  // The folded noise has a crease at its furrow and is round on top.
  vec3 largeSlope = sign(large.w) * (1.0 - largeUp) * large.xyz;
  vec3 smallSlope = sign(small.w) * (1.0 - smallUp) * small.xyz;
  return wet(albedo, vec3(0.42, 0.28, 0.10), 2.1 / 4.4 * largeSlope + 0.42 / 1.7 * smallSlope + 0.020 / 0.6 * fine.xyz,
             0.032, 0.38, 0.9);
}

// What the hook did: first pale, cooked tissue, then brown, then a black, matt crust. Noise moves the limits, so that
// they do not follow the mesh.
Material charredBy(Material m, float charred, vec3 mm) {
  if (charred <= 0.0) return m;
  vec4 patches = noise(mm / 2.1 + 1.7);
  vec4 crumbs = noise(mm / 0.55 + 0.3);
  float x = charred + smoothstep(0.0, 0.25, charred) * (0.38 * patches.w + 0.20 * crumbs.w);
  float cooked = smoothstep(0.02, 0.22, x), brown = smoothstep(0.22, 0.62, x), black = smoothstep(0.62, 1.05, x);
  float grey = dot(m.albedo, vec3(0.3, 0.6, 0.1));
  m.albedo = mix(m.albedo, mix(m.albedo, vec3(1.30, 1.00, 0.62) * (grey + 0.03), 0.5), cooked);
  m.albedo = mix(m.albedo, vec3(0.105, 0.042, 0.015) * (1.0 + 0.5 * crumbs.w), 0.9 * brown);
  m.albedo = mix(m.albedo, vec3(0.012, 0.009, 0.008) * (1.0 + 0.6 * crumbs.w), black);
  m.scatter *= 1.0 - 0.8 * brown;
  m.slope += (0.10 * brown + 0.25 * black) / 0.55 * 0.5 * crumbs.xyz;
  m.mirror = mix(m.mirror, vec3(0.018), black);
  m.roughness = mix(m.roughness, 0.72, max(0.6 * brown, black));
  m.film *= (1.0 - 0.75 * brown) * (1.0 - black);
  return m;
}

// The face of a parted vessel, from rim (1) to middle (2): wall, inner lining, lumen. Below 1: skin stained by blood,
// below 0 by bile.
Material parted(Material m, float face) {
  vec3 stain = face < 0.0 ? vec3(0.190, 0.150, 0.012) : vec3(0.200, 0.012, 0.010);
  m.albedo = mix(m.albedo, stain, 0.75 * smoothstep(0.0, 0.4, abs(face)));
  if (face < 0.5) return m;
  float inward = face - 1.0;
  m.albedo = vec3(0.330, 0.100, 0.075);
  m.albedo = mix(m.albedo, vec3(0.120, 0.014, 0.012), smoothstep(0.28, 0.42, inward));
  m.albedo = mix(m.albedo, vec3(0.020, 0.002, 0.002), smoothstep(0.42, 0.75, inward));
  m.film *= 1.0 - 0.6 * smoothstep(0.3, 0.5, inward);
  return m;
}

Material cavityWall(vec3 mm, Broad broad) {
  vec4 middle = broad.a;
  vec4 lobes = noise(mm / 8.0 + 0.3 * middle.xyz);
  vec4 small = fineNoise(mm / 3.1);
  vec3 albedo = mix(vec3(0.200, 0.058, 0.046), vec3(0.330, 0.125, 0.095), clamp(0.5 + 0.7 * broad.c.x, 0.0, 1.0));
  float fat = smoothstep(-0.15, 0.55, middle.w + 0.30 * lobes.w + 0.10 * small.w);
  albedo = mix(albedo, vec3(0.400, 0.235, 0.105), 0.55 * fat);
  albedo *= 1.0 + 0.20 * lobes.w + 0.10 * small.w;
  albedo = mix(albedo, vec3(0.150, 0.022, 0.024), 0.40 * vessels(wallNet(mm), broad.b, 0.035));
  return wet(albedo, vec3(0.35, 0.15, 0.10), 2.2 / 27.0 * middle.xyz + (0.5 + 0.6 * fat) / 8.0 * lobes.xyz + 0.12 / 3.1 * small.xyz,
             0.026, 0.50, 0.45);
}

// Lobes as of fat, in a thin membrane that is pink where it is thin, with long vessels.
Material omentum(vec3 mm, vec3 normal, Broad broad) {
  vec4 bend = broad.a;
  vec4 lobes = noise(mm / 7.2 + 0.25 * bend.xyz);
  vec4 fine = fineNoise(mm / 1.9);
  float folded = min(abs(lobes.w) * 1.6, 1.0);
  vec3 albedo = mix(vec3(0.400, 0.185, 0.065), vec3(0.540, 0.320, 0.115), smoothstep(0.05, 0.75, sqrt(folded)));
  albedo = mix(albedo, vec3(0.420, 0.170, 0.105), 0.75 * smoothstep(-0.05, 0.55, broad.b.x + 0.4 * broad.b.y));
  albedo = mix(albedo, vec3(0.240, 0.030, 0.028), 0.55 * veins(mm / 83.0, normal));
  albedo *= 1.0 + 0.10 * fine.w;
  return wet(albedo, vec3(0.40, 0.24, 0.10), 1.7 / 7.2 * sign(lobes.w) * (1.0 - folded) * lobes.xyz + 0.05 / 1.9 * fine.xyz,
             0.030, 0.42, 0.8);
}

// Serosa of the bowel: pale pink, smooth, wet, with a fine net.
Material bowel(vec3 mm, vec3 normal, Broad broad) {
  vec4 middle = broad.a;
  vec4 fine = fineNoise(mm / 1.5);
  vec3 albedo = mix(vec3(0.330, 0.110, 0.085), vec3(0.500, 0.235, 0.170), clamp(0.5 + 0.6 * broad.b.x + 0.35 * middle.w, 0.0, 1.0));
  albedo = mix(albedo, vec3(0.260, 0.040, 0.038), 0.50 * veins(mm.yzx / 37.0, normal.yzx));
  albedo *= 1.0 + 0.06 * fine.w;
  return wet(albedo, vec3(0.38, 0.18, 0.13), 0.45 / 12.0 * middle.xyz + 0.02 / 1.5 * fine.xyz,
             0.032, 0.36, 1.0);
}

Material tissue(vec3 mm, Broad broad) {
  vec4 middle = broad.a;
  vec4 fine = noise(mm / 1.7);
  vec3 albedo = mix(vec3(0.34, 0.12, 0.09), vec3(0.45, 0.20, 0.15), clamp(0.5 + 0.8 * middle.w, 0.0, 1.0)) * (1.0 + 0.1 * fine.w);
  return wet(albedo, vec3(0.35, 0.15, 0.10), 0.25 / 9.0 * middle.xyz + 0.03 / 1.7 * fine.xyz,
             0.028, 0.42, 0.7);
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

// One look a program (LOOK, HARMED): a software rasterizer works out every branch for every pixel.
Material materialOf(vec3 rest, vec3 restNormal, vec2 harm, Broad broad) {
  vec3 mm = rest * 1000.0;
#if LOOK == 3
  return cavityWall(mm, broad);
#elif LOOK == 7
  return omentum(mm, restNormal, broad);
#elif LOOK == 8
  return bowel(mm, restNormal, broad);
#elif LOOK == 10 // insulation
  return solid(vec3(0.010, 0.010, 0.011), vec3(0.042), 0.33);
#elif LOOK == 11 // steel
  return brushed(mm, vec3(0.60, 0.585, 0.57), 0.27);
#elif LOOK == 12 // ceramic
  return solid(vec3(0.62, 0.58, 0.50), vec3(0.045), 0.30);
#elif LOOK == 13 // titanium
  return brushed(mm, vec3(0.56, 0.54, 0.60), 0.30);
#elif LOOK == 14 // blood
  return solid(vec3(0.150, 0.006, 0.005), vec3(0.040), 0.12);
#elif LOOK == 15 // bile
  return solid(vec3(0.200, 0.170, 0.012), vec3(0.040), 0.12);
#else
#if LOOK == 1
  Material m = liver(mm, broad);
#elif LOOK == 2
  Material m = gallbladder(mm, restNormal, broad);
#elif LOOK == 4
  Material m = duct(mm, broad);
#elif LOOK == 5
  Material m = artery(mm, broad);
#elif LOOK == 6
  Material m = fat(mm, broad);
#else
  Material m = tissue(mm, broad);
#endif
#if HARMED
  m = charredBy(parted(m, harm.y), harm.x, mm);
#endif
  return m;
#endif
}
