// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/shader_program.h"

#include <vector>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

[[noreturn]] void fail(const char* name, const std::string& log) {
  throw Error(ErrorKind::failure, std::string("rendering: shader '") + name +
                                      "' is refused by this OpenGL: " + log.substr(0, log.find('\n')));
}

GLuint compile(const GlFunctions& gl, const char* name, GLenum kind,
               const std::initializer_list<const char*>& sources) {
  std::vector<const char*> text{"#version 450 core\n"};
  text.insert(text.end(), sources.begin(), sources.end());
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, static_cast<GLsizei>(text.size()), text.data(), nullptr);
  gl.CompileShader(shader);
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::string log(2000, '\0');
  GLsizei length = 0;
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  gl.DeleteShader(shader);
  log.resize(static_cast<std::size_t>(length));
  fail(name, log);
}

}  // namespace

ShaderProgram::ShaderProgram(const GlFunctions& gl, const char* name, std::initializer_list<const char*> vertex,
                             std::initializer_list<const char*> fragment)
    : gl_(gl) {
  const GLuint vertexShader = compile(gl, name, GL_VERTEX_SHADER, vertex);
  const GLuint fragmentShader = compile(gl, name, GL_FRAGMENT_SHADER, fragment);
  program_ = gl.CreateProgram();
  gl.AttachShader(program_, vertexShader);
  gl.AttachShader(program_, fragmentShader);
  gl.LinkProgram(program_);
  gl.DeleteShader(vertexShader);
  gl.DeleteShader(fragmentShader);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return;
  std::string log(2000, '\0');
  GLsizei length = 0;
  gl.GetProgramInfoLog(program_, static_cast<GLsizei>(log.size()), &length, log.data());
  gl.DeleteProgram(program_);
  log.resize(static_cast<std::size_t>(length));
  fail(name, log);
}

ShaderProgram::~ShaderProgram() { gl_.DeleteProgram(program_); }

}  // namespace calot::gui
