// SPDX-License-Identifier: GPL-3.0-or-later
// The OpenGL 4.5 functions that the renderer uses, loaded through the context: no loader library works
// with every off-screen context.
#pragma once

#include <GL/gl.h>
#include <GL/glext.h>

#include "gui/render/graphics_context.h"

// glext.h has pointer types for what came after OpenGL 1.1; for the older functions the declaration gives the type.
#define CALOT_GL_FUNCTIONS(ENTRY)                                  \
  ENTRY(decltype(&glBindTexture), BindTexture)                     \
  ENTRY(decltype(&glBlendFunc), BlendFunc)                         \
  ENTRY(decltype(&glClear), Clear)                                 \
  ENTRY(decltype(&glClearColor), ClearColor)                       \
  ENTRY(decltype(&glColorMask), ColorMask)                         \
  ENTRY(decltype(&glCullFace), CullFace)                           \
  ENTRY(decltype(&glDeleteTextures), DeleteTextures)               \
  ENTRY(decltype(&glDepthFunc), DepthFunc)                         \
  ENTRY(decltype(&glDepthMask), DepthMask)                         \
  ENTRY(decltype(&glDisable), Disable)                             \
  ENTRY(decltype(&glDrawArrays), DrawArrays)                       \
  ENTRY(decltype(&glDrawElements), DrawElements)                   \
  ENTRY(decltype(&glEnable), Enable)                               \
  ENTRY(decltype(&glFrontFace), FrontFace)                         \
  ENTRY(decltype(&glGenTextures), GenTextures)                     \
  ENTRY(decltype(&glGetError), GetError)                           \
  ENTRY(decltype(&glGetString), GetString)                         \
  ENTRY(decltype(&glPixelStorei), PixelStorei)                     \
  ENTRY(decltype(&glReadPixels), ReadPixels)                       \
  ENTRY(decltype(&glScissor), Scissor)                             \
  ENTRY(decltype(&glTexImage2D), TexImage2D)                       \
  ENTRY(decltype(&glTexParameteri), TexParameteri)                 \
  ENTRY(decltype(&glViewport), Viewport)                           \
  ENTRY(PFNGLACTIVETEXTUREPROC, ActiveTexture)                     \
  ENTRY(PFNGLATTACHSHADERPROC, AttachShader)                       \
  ENTRY(PFNGLBINDBUFFERPROC, BindBuffer)                           \
  ENTRY(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                 \
  ENTRY(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                 \
  ENTRY(PFNGLBUFFERDATAPROC, BufferData)                           \
  ENTRY(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)   \
  ENTRY(PFNGLCOMPILESHADERPROC, CompileShader)                     \
  ENTRY(PFNGLCREATEPROGRAMPROC, CreateProgram)                     \
  ENTRY(PFNGLCREATESHADERPROC, CreateShader)                       \
  ENTRY(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                     \
  ENTRY(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)           \
  ENTRY(PFNGLDELETEPROGRAMPROC, DeleteProgram)                     \
  ENTRY(PFNGLDELETESHADERPROC, DeleteShader)                       \
  ENTRY(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)           \
  ENTRY(PFNGLDRAWBUFFERSPROC, DrawBuffers)                         \
  ENTRY(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
  ENTRY(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)       \
  ENTRY(PFNGLGENBUFFERSPROC, GenBuffers)                           \
  ENTRY(PFNGLGENERATEMIPMAPPROC, GenerateMipmap)                   \
  ENTRY(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                 \
  ENTRY(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                 \
  ENTRY(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)             \
  ENTRY(PFNGLGETPROGRAMIVPROC, GetProgramiv)                       \
  ENTRY(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)               \
  ENTRY(PFNGLGETSHADERIVPROC, GetShaderiv)                         \
  ENTRY(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)           \
  ENTRY(PFNGLLINKPROGRAMPROC, LinkProgram)                         \
  ENTRY(PFNGLSHADERSOURCEPROC, ShaderSource)                       \
  ENTRY(PFNGLTEXIMAGE3DPROC, TexImage3D)                           \
  ENTRY(PFNGLTEXSTORAGE2DPROC, TexStorage2D)                       \
  ENTRY(PFNGLUNIFORM1FPROC, Uniform1f)                             \
  ENTRY(PFNGLUNIFORM1IPROC, Uniform1i)                             \
  ENTRY(PFNGLUNIFORM2FPROC, Uniform2f)                             \
  ENTRY(PFNGLUNIFORM3FPROC, Uniform3f)                             \
  ENTRY(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)               \
  ENTRY(PFNGLUSEPROGRAMPROC, UseProgram)                           \
  ENTRY(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)

namespace calot::gui {

struct GlFunctions {
#define CALOT_GL_MEMBER(Type, Name) Type Name = nullptr;
  CALOT_GL_FUNCTIONS(CALOT_GL_MEMBER)
#undef CALOT_GL_MEMBER

  /// @pre the context is current. @throws calot::Error (failure) naming the first function that is missing.
  explicit GlFunctions(const GraphicsContext& context);
};

}  // namespace calot::gui
