// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <initializer_list>
#include <string>

#include "gui/render/gl_functions.h"

namespace calot::gui {

/// Column-major 4 x 4 matrix as OpenGL takes it.
using Matrix4 = std::array<float, 16>;

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
  void set(const char* name, const Matrix4& m) const { gl_.UniformMatrix4fv(location(name), 1, GL_FALSE, m.data()); }

 private:
  [[nodiscard]] GLint location(const char* name) const { return gl_.GetUniformLocation(program_, name); }
  const GlFunctions& gl_;
  GLuint program_ = 0;
};

}  // namespace calot::gui
