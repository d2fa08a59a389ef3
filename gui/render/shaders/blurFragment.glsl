// SPDX-License-Identifier: GPL-3.0-or-later
// Smooths the occlusion within surfaces.
uniform sampler2D openMap;   // normal, halved around 0.5; how open it is
uniform sampler2D depthMap;
layout(location = 0) out float open;
// The sampling pattern repeats every PATTERN pixels: a mean over as many each way takes it away.
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(openMap, 0);
  float here = texelFetch(depthMap, pixel * STRIDE, 0).x;
  vec3 n = texelFetch(openMap, pixel, 0).xyz - 0.5;
  float sum = 0.0, weights = 0.0;
  for (int y = -PATTERN / 2; y < PATTERN / 2; ++y)
    for (int x = -PATTERN / 2; x < PATTERN / 2; ++x) {
      ivec2 there = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
      vec4 other = texelFetch(openMap, there, 0);
      float away = abs(texelFetch(depthMap, there * STRIDE, 0).x - here) / (0.02 * here + 1e-5);
      float alike = 4.0 * dot(other.xyz - 0.5, n);
      float weight = 1e-4 + clamp(1.0 - away, 0.0, 1.0) * clamp(alike, 0.0, 1.0);
      sum += weight * other.w;
      weights += weight;
    }
  open = sum / weights;
}
