// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "gui/render/gl_functions.h"

namespace calot::gui {

/// A framebuffer with colour textures and an optional depth texture; all sampled with clamping to the edge.
class RenderTarget {
 public:
  struct Layout {
    std::vector<GLenum> colour;  ///< internal formats of the attachments, in order
    bool depth = false;          ///< 32-bit float depth texture
    bool linear = false;         ///< filter colours linearly
    bool compared = false;       ///< a look into the depth compares (sampler2DShadow), over the four nearest texels
    const RenderTarget* depthOf = nullptr;  ///< shares the depth of another of the same size, which outlives this
  };
  /// @throws calot::Error (failure) if there is no memory for it.
  RenderTarget(const GlFunctions& gl, int width, int height, const Layout& layout);
  ~RenderTarget();
  RenderTarget(const RenderTarget&) = delete;
  RenderTarget& operator=(const RenderTarget&) = delete;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Binds for drawing and sets the viewport.
  void bind() const;
  void sampleColour(int unit, std::size_t attachment = 0) const { sample(unit, textures_[attachment]); }
  /// @pre the layout has depth
  void sampleDepth(int unit) const { sample(unit, textures_.back()); }

 private:
  void sample(int unit, GLuint texture) const;
  const GlFunctions& gl_;
  int width_, height_;
  GLuint framebuffer_ = 0;
  std::vector<GLuint> textures_;  ///< colours, then the depth, if it is its own
};

}  // namespace calot::gui
