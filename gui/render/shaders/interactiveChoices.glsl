// SPDX-License-Identifier: GPL-3.0-or-later
// Interactive quality: noise of eight bits, its slow part for every vertex instead of every pixel and its finest part not
// at all; narrow shadows; occlusion and cavity at half the size.
#define FIELD_SIDES 96
#define OCCLUSION_SAMPLES 6
#define SHEET_SHADOW_SAMPLES 1
#define PATTERN 2
#define STRIDE 2
#define SAMPLES_ASIDE 1
#define DIRECT 1
#define NOISE_BYTES 1
#define BROAD_PER_VERTEX 1
#define FINE 0
#define EXACT 0
#define SOFT_SHADOWS 0
#define SHADOW_OFFSET 0.0007
