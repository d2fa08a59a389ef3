// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_programs.h"

#include <fmt/format.h>

#include <initializer_list>

#include "gui/render/shader_sources.h"

namespace calot::gui {
namespace {

// What the qualities differ in. Interactive: noise of eight bits, its slow part for every vertex instead of every pixel
// and its finest part not at all; narrow shadows; occlusion and cavity at half the size.
const char* const filmChoices = R"(
#define FIELD_SIDES 96
#define OCCLUSION_SAMPLES 24
#define BLOCKERS 8
#define SHADOW_SAMPLES 16
#define SHEET_SHADOW_SAMPLES 4
#define PATTERN 4
#define STRIDE 1
#define SAMPLES_ASIDE 2
#define DIRECT 0
#define NOISE_BYTES 0
#define BROAD_PER_VERTEX 0
#define FINE 1
#define EXACT 1
#define SOFT_SHADOWS 1
#define SHADOW_OFFSET 0.0006
)";
const char* const interactiveChoices = R"(
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
#define SHADOW_OFFSET 0.0016
)";

}  // namespace

ScenePrograms::ScenePrograms(const GlFunctions& gl, Quality quality)
    : ScenePrograms(gl, quality == Quality::film ? filmChoices : interactiveChoices) {}

ScenePrograms::ScenePrograms(const GlFunctions& gl, const char* choices)
    : shadow(gl, "shadow", {choices, glsl::common, glsl::surfaceVertex}, {glsl::emptyFragment}),
      prepass(gl, "prepass", {choices, glsl::common, glsl::surfaceVertex}, {glsl::prepassFragment}),
      surround(gl, "surround", {choices, glsl::common, glsl::surroundVertex}, {glsl::surroundFragment}),
      sheet(gl, "sheet", {choices, glsl::common, glsl::sheetVertex},
            {choices, glsl::common, glsl::display, glsl::receiver, glsl::shadowLookup, glsl::sheetFragment}),
      smoke(gl, "smoke", {choices, glsl::common, glsl::smokeVertex},
            {choices, glsl::common, glsl::display, glsl::receiver, glsl::smokeFragment}),
      occlusion(gl, "occlusion", {glsl::pictureVertex}, {choices, glsl::common, glsl::occlusionFragment}),
      backdrop(gl, "backdrop", {glsl::pictureVertex}, {glsl::backdropFragment}),
      blur(gl, "blur", {glsl::pictureVertex}, {choices, glsl::blurFragment}),
      compose(gl, "compose", {glsl::pictureVertex}, {choices, glsl::display, glsl::composeFragment}),
      gl_(gl),
      choices_(choices) {}

const ShaderProgram& ScenePrograms::surface(const DrawPart& part) {
  const int look = static_cast<int>(part.appearance);
  std::unique_ptr<ShaderProgram>& program = surface_[{look, part.harmed}];
  if (!program) {
    const std::string choice = fmt::format("#define LOOK {}\n#define HARMED {}\n", look, part.harmed ? 1 : 0);
    program = std::make_unique<ShaderProgram>(
        gl_, "surface",
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceVertex},
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceMaterial, glsl::display, glsl::receiver, glsl::shadowLookup,
                                           glsl::softShadow, glsl::surfaceFragment});
  }
  return *program;
}

}  // namespace calot::gui
