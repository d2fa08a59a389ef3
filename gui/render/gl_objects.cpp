// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/gl_objects.h"

#include <fmt/format.h>
#include <array>
#include <string_view>
#include <type_traits>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::gui {

GlFunctions::GlFunctions(const GraphicsContext& context) {
  const auto load = [&](auto& function, const char* name) {
    const auto found = context.function(name);
    if (found == nullptr)
      throw Error(ErrorKind::failure, fmt::format("rendering: this OpenGL has no {}; install a newer Mesa", name));
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
  };
#define CALOT_GL_LOAD(Name) load(Name, "gl" #Name);
  CALOT_GL_FUNCTIONS(CALOT_GL_LOAD)
#undef CALOT_GL_LOAD
}

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

TriangleBuffer::TriangleBuffer(const GlFunctions& gl, std::size_t stride, std::initializer_list<Attribute> attributes)
    : gl_(gl) {
  gl_.GenVertexArrays(1, &vertexArray_);
  gl_.GenBuffers(1, &vertexBuffer_);
  gl_.GenBuffers(1, &indexBuffer_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_);
  GLuint location = 0;
  for (const Attribute& attribute : attributes) {
    gl_.EnableVertexAttribArray(location);
    gl_.VertexAttribPointer(location++, attribute.floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                            reinterpret_cast<const void*>(attribute.offset));
  }
}

TriangleBuffer::~TriangleBuffer() {
  gl_.DeleteBuffers(1, &vertexBuffer_);
  gl_.DeleteBuffers(1, &indexBuffer_);
  gl_.DeleteVertexArrays(1, &vertexArray_);
}

void TriangleBuffer::upload(const void* vertices, std::size_t bytes, const std::vector<std::uint32_t>& index) const {
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), vertices, GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index.size() * sizeof(std::uint32_t)), index.data(),
                 GL_STREAM_DRAW);
}

void TriangleBuffer::draw(std::size_t firstIndex, std::size_t indexCount) const {
  gl_.BindVertexArray(vertexArray_);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(firstIndex * sizeof(std::uint32_t)));
}

namespace {

/// @param get, log the functions for this kind of object, @param wanted its status that must be true
void check(const char* name, GLuint object, GLenum wanted, PFNGLGETSHADERIVPROC get, PFNGLGETSHADERINFOLOGPROC log) {
  GLint good = GL_FALSE;
  get(object, wanted, &good);
  if (good == GL_TRUE) return;
  std::array<char, 2000> text{};
  GLsizei length = 0;
  log(object, static_cast<GLsizei>(text.size()), &length, text.data());
  const std::string_view all(text.data(), static_cast<std::size_t>(length));
  throw Error(ErrorKind::failure,
              fmt::format("rendering: shader '{}' is refused by this OpenGL: {}", name, all.substr(0, all.find('\n'))));
}

}  // namespace

ShaderProgram::ShaderProgram(const GlFunctions& gl, const char* name, std::initializer_list<const char*> vertex,
                             std::initializer_list<const char*> fragment)
    : gl_(gl), program_(gl.CreateProgram()) {
  for (const auto& [kind, sources] : {std::pair(GL_VERTEX_SHADER, vertex), {GL_FRAGMENT_SHADER, fragment}}) {
    std::vector<const char*> text{"#version 450 core\n"};
    text.insert(text.end(), sources.begin(), sources.end());
    const GLuint shader = gl.CreateShader(static_cast<GLenum>(kind));
    gl.ShaderSource(shader, static_cast<GLsizei>(text.size()), text.data(), nullptr);
    gl.CompileShader(shader);
    check(name, shader, GL_COMPILE_STATUS, gl.GetShaderiv, gl.GetShaderInfoLog);
    gl.AttachShader(program_, shader);
    gl.DeleteShader(shader);  // with the program
  }
  gl.LinkProgram(program_);
  check(name, program_, GL_LINK_STATUS, gl.GetProgramiv, gl.GetProgramInfoLog);
}

ShaderProgram::~ShaderProgram() { gl_.DeleteProgram(program_); }

}  // namespace calot::gui
