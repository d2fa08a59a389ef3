// SPDX-License-Identifier: GPL-3.0-or-later
// GLSL of the renderer (gui/render/shaders). All geometry is in the camera's frame C: x right, y down, z forward,
// metres.
#pragma once

namespace calot::gui::glsl {

extern const char* const filmChoices;         ///< what film quality chooses; stands before all others
extern const char* const interactiveChoices;  ///< likewise
extern const char* const common;              ///< hash, noise volume, projection; stands before each of the others
extern const char* const surfaceVertex;       ///< transforms a DrawVertex
extern const char* const emptyFragment;       ///< depth only
extern const char* const surroundFragment;    ///< what lies around the round field
extern const char* const prepassFragment;     ///< normal and depth, for the occlusion
extern const char* const surfaceBroad;        ///< slow noises of the looks, for vertices or pixels
extern const char* const surfaceMaterial;     ///< the looks: colour, gloss and bumps of every Appearance
extern const char* const receiver;            ///< what a surface receives of the light, and how it is shown
extern const char* const shadowLookup;        ///< asks the shadow map
extern const char* const softShadow;          ///< the endoscope's shadow on a surface
extern const char* const backdropFragment;    ///< the cavity, from a target of half the size
extern const char* const surfaceFragment;     ///< lighting
extern const char* const sheetVertex;         ///< transforms a SheetVertex
extern const char* const sheetFragment;       ///< connective tissue: texture, opacity and lighting
extern const char* const smokeVertex;         ///< transforms a SmokeVertex
extern const char* const smokeFragment;       ///< smoke: shape, opacity and lighting
extern const char* const pictureVertex;       ///< one triangle over the whole picture, behind everything
extern const char* const surroundVertex;      ///< around the endoscope's round field, before everything
extern const char* const occlusionFragment;   ///< how much of the surroundings a point sees
extern const char* const blurFragment;        ///< smooths the occlusion within surfaces
extern const char* const display;             ///< tone curve, sRGB, the endoscope's field
extern const char* const composeFragment;     ///< tone curve, sample averaging, endoscope's round field

}  // namespace calot::gui::glsl
