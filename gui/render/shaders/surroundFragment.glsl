// SPDX-License-Identifier: GPL-3.0-or-later
// What lies around the round field.
layout(location = 0) out vec4 black;
void main() { black = vec4(0.0, 0.0, 0.0, 1.0); }
