// SPDX-License-Identifier: GPL-3.0-or-later
// Tone curve, sample averaging, endoscope's round field.
uniform sampler2D radianceMap;
layout(location = 0) out vec4 colour;

const int samples = SAMPLES_ASIDE;

void main() {
  ivec2 size = textureSize(radianceMap, 0) / samples;
  ivec2 pixel = ivec2(gl_FragCoord.x, size.y - 1 - int(gl_FragCoord.y));  // first row on top
  vec4 sum = vec4(0.0);
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) {
      vec4 s = texelFetch(radianceMap, pixel * samples + ivec2(x, y), 0);
      // Translucent tissue over nothing leaves its colour multiplied by its opacity.
      vec3 whole = s.a < 1.0 ? s.rgb / max(s.a, 1e-3) : s.rgb;
      sum += vec4(tone(0.85 * whole) * s.a, s.a);
    }
  float covered = sum.a / float(samples * samples);
  vec3 linear = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  vec2 field = fieldAt(vec2(pixel) + 0.5, vec2(size));
  colour = vec4(encode(linear * field.x), max(covered, field.y));
}
