// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#define GL_GLEXT_PROTOTYPES  // for the functions' types
#include <GL/gl.h>
#include <GL/glext.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "gui/render/graphics.h"

// clang-format off
/// The OpenGL 4.5 functions that the renderer uses.
#define CALOT_GL_FUNCTIONS(ENTRY)                                                                                     \
  ENTRY(ActiveTexture) ENTRY(AttachShader) ENTRY(BindBuffer) ENTRY(BindFramebuffer) ENTRY(BindTexture)                \
  ENTRY(BindVertexArray) ENTRY(BlendFunc) ENTRY(BufferData) ENTRY(CheckFramebufferStatus) ENTRY(Clear)                \
  ENTRY(ClearColor) ENTRY(CompileShader) ENTRY(CreateProgram) ENTRY(CreateShader) ENTRY(DeleteBuffers)                \
  ENTRY(DeleteFramebuffers) ENTRY(DeleteProgram) ENTRY(DeleteShader) ENTRY(DeleteTextures)                            \
  ENTRY(DeleteVertexArrays) ENTRY(DepthFunc) ENTRY(DepthMask) ENTRY(Disable) ENTRY(DrawArrays) ENTRY(DrawBuffers)     \
  ENTRY(DrawElements) ENTRY(Enable) ENTRY(EnableVertexAttribArray) ENTRY(FramebufferTexture2D) ENTRY(FrontFace)       \
  ENTRY(GenBuffers) ENTRY(GenFramebuffers) ENTRY(GenTextures) ENTRY(GenVertexArrays) ENTRY(GenerateMipmap)            \
  ENTRY(GetError) ENTRY(GetProgramInfoLog) ENTRY(GetProgramiv) ENTRY(GetShaderInfoLog) ENTRY(GetShaderiv)             \
  ENTRY(GetString) ENTRY(GetUniformLocation) ENTRY(LinkProgram) ENTRY(PixelStorei) ENTRY(ReadPixels) ENTRY(Scissor)   \
  ENTRY(ShaderSource) ENTRY(TexImage2D) ENTRY(TexImage3D) ENTRY(TexParameteri) ENTRY(TexStorage2D) ENTRY(Uniform1f)   \
  ENTRY(Uniform1i) ENTRY(Uniform2f) ENTRY(Uniform3f) ENTRY(UseProgram) ENTRY(VertexAttribPointer) ENTRY(Viewport)
// clang-format on

namespace calot::gui {

/// They are loaded through the context: no loader library works with every off-screen context.
struct GlFunctions {
#define CALOT_GL_MEMBER(Name) decltype(&gl##Name) Name = nullptr;
  CALOT_GL_FUNCTIONS(CALOT_GL_MEMBER)
#undef CALOT_GL_MEMBER

  /// @pre the context is current. @throws calot::Error (failure) naming the first function that is missing.
  explicit GlFunctions(const GraphicsContext& context);
};

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

/// Vertices of one kind and triangles of them, on the graphics side. Kept from picture to picture.
class TriangleBuffer {
 public:
  /// A vertex shader's input: its location is its place in the list.
  struct Attribute {
    GLint floats;
    std::size_t offset;  ///< in a vertex (bytes)
  };
  /// @param stride size of a vertex (bytes)
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  TriangleBuffer(const GlFunctions& gl, std::size_t stride, std::initializer_list<Attribute> attributes);
  ~TriangleBuffer();
  TriangleBuffer(const TriangleBuffer&) = delete;
  TriangleBuffer& operator=(const TriangleBuffer&) = delete;

  /// @param list has `vertex` and `index`
  template <class List>
  void upload(const List& list) const {
    upload(list.vertex.data(), list.vertex.size() * sizeof(list.vertex[0]), list.index);
  }
  /// Triangles by their indices, with the program, target and settings of the moment.
  void draw(std::size_t firstIndex, std::size_t indexCount) const;

 private:
  void upload(const void* vertices, std::size_t bytes, const std::vector<std::uint32_t>& index) const;

  const GlFunctions& gl_;
  GLuint vertexArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0;
};

/// A linked pair of vertex and fragment shader.
class ShaderProgram {
 public:
  /// Sources are concatenated in order behind "#version 450 core". @throws calot::Error (failure) with the first line
  /// of the compiler's log.
  ShaderProgram(const GlFunctions& gl, const char* name, std::initializer_list<const char*> vertex,
                std::initializer_list<const char*> fragment);
  ~ShaderProgram();
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  void use() const { gl_.UseProgram(program_); }
  // Setters act on the program in use; a name that the compiler dropped is ignored, as OpenGL does.
  void set(const char* name, int value) const { gl_.Uniform1i(location(name), value); }
  void set(const char* name, float value) const { gl_.Uniform1f(location(name), value); }
  void set(const char* name, float x, float y) const { gl_.Uniform2f(location(name), x, y); }
  void set(const char* name, float x, float y, float z) const { gl_.Uniform3f(location(name), x, y, z); }

 private:
  [[nodiscard]] GLint location(const char* name) const { return gl_.GetUniformLocation(program_, name); }
  const GlFunctions& gl_;
  GLuint program_ = 0;
};

}  // namespace calot::gui
