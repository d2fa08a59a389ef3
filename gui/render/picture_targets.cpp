// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/picture_targets.h"

#include "gui/render/scene_programs.h"

namespace calot::gui {
namespace {

GLenum radianceFormat(Quality q) { return q == Quality::film ? GL_RGBA16F : GL_RGBA8; }
int samplesAside(Quality q) { return q == Quality::film ? 2 : 1; }
int coarse(int side, Quality q) { return q == Quality::film ? side : (side + 1) / 2; }
int shadowSide(Quality q) { return q == Quality::film ? 1536 : 512; }

}  // namespace

PictureTargets::PictureTargets(const GlFunctions& gl, int w, int h, Quality q)
    : width(w),
      height(h),
      quality(q),
      shadow(gl, shadowSide(q), shadowSide(q), {{}, true, false, q == Quality::interactive}),
      prepass(gl, coarse(w, q), coarse(h, q), {{GL_R32F, GL_RGBA8}, true}),
      open(gl, prepass.width() / occlusionStride(q), prepass.height() / occlusionStride(q), {{GL_RGBA8}}),
      smoothed(gl, open.width(), open.height(), {{GL_R8}, false, true}),
      radiance(gl, w * samplesAside(q), h * samplesAside(q), {{radianceFormat(q)}, true}) {
  if (q == Quality::film)
    picture = std::make_unique<RenderTarget>(gl, w, h, RenderTarget::Layout{{GL_RGBA8}});
  else
    backdrop = std::make_unique<RenderTarget>(gl, prepass.width(), prepass.height(),
                                              RenderTarget::Layout{{GL_RGBA8}, false, true, false, &prepass});
}

}  // namespace calot::gui
