// SPDX-License-Identifier: GPL-3.0-or-later
// Puffs of smoke in the endoscope's light.
in vec3 vPosition;
in vec2 vCorner;
in vec2 vLook;

void main() {
  float away = dot(vCorner, vCorner);
  float shape = clamp(1.0 - away, 0.0, 1.0);
  vec3 place = vec3(1.3 * vCorner, 8.0 * vLook.y);
  float wisps = 0.75 + 0.8 * noise(place).w + 0.4 * noise(2.3 * place + 1.9).w;
  float opacity = vLook.x * shape * shape * clamp(wisps, 0.0, 1.4);
  if (opacity < 0.004) discard;
  // Near the lens it would be blinding, as it is; but not to the camera's last bit.
  vec3 l;
  float received = min(lightAt(vPosition, l), 1.6);
  show(vec3(0.55, 0.55, 0.56) * (0.10 + 0.90 * received) * opacity, opacity);
}
