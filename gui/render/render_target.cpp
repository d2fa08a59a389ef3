// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/render_target.h"

#include <fmt/format.h>

#include "recorder/base/errors.h"

namespace calot::gui {

RenderTarget::RenderTarget(const GlFunctions& gl, int width, int height, const Layout& layout)
    : gl_(gl), width_(width), height_(height) {
  while (gl_.GetError() != GL_NO_ERROR) {
  }
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const auto attach = [&](GLenum format, GLenum attachment, bool linear) {
    GLuint texture = 0;
    gl_.GenTextures(1, &texture);
    textures_.push_back(texture);
    gl_.BindTexture(GL_TEXTURE_2D, texture);
    gl_.TexStorage2D(GL_TEXTURE_2D, 1, format, width_, height_);
    const GLint filter = linear ? GL_LINEAR : GL_NEAREST;
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
  };
  for (std::size_t c = 0; c < layout.colour.size(); ++c)
    attach(layout.colour[c], static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + c), layout.linear);
  if (layout.colour.size() > 1) {
    std::vector<GLenum> attachments;
    for (std::size_t c = 0; c < layout.colour.size(); ++c)
      attachments.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + c));
    gl_.DrawBuffers(static_cast<GLsizei>(attachments.size()), attachments.data());
  }
  if (layout.depth) attach(GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, layout.compared);
  if (layout.compared) gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  if (layout.depthOf != nullptr)
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, layout.depthOf->textures_.back(), 0);
  const bool complete = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (complete && gl_.GetError() == GL_NO_ERROR) return;
  gl_.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
  gl_.DeleteFramebuffers(1, &framebuffer_);
  throw Error(ErrorKind::failure,
              fmt::format("rendering: no memory for a {}x{} picture; ask for a smaller one", width, height));
}

RenderTarget::~RenderTarget() {
  gl_.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
  gl_.DeleteFramebuffers(1, &framebuffer_);
}

void RenderTarget::bind() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, width_, height_);
}

void RenderTarget::sample(int unit, GLuint texture) const {
  gl_.ActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  gl_.BindTexture(GL_TEXTURE_2D, texture);
}

}  // namespace calot::gui
