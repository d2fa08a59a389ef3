// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/gl_functions.h"

#include <string>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

template <class Pointer>
Pointer load(const GraphicsContext& context, const char* name) {
  const auto found = context.function(name);
  if (found == nullptr)
    throw Error(ErrorKind::failure, std::string("rendering: this OpenGL has no ") + name + "; install a newer Mesa");
  return reinterpret_cast<Pointer>(found);
}

}  // namespace

GlFunctions::GlFunctions(const GraphicsContext& context) {
#define CALOT_GL_LOAD(Type, Name) Name = load<Type>(context, "gl" #Name);
  CALOT_GL_FUNCTIONS(CALOT_GL_LOAD)
#undef CALOT_GL_LOAD
}

}  // namespace calot::gui
