// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/page/wasm/web_context.h"

#include <string_view>

#include "gui/render/gl_objects.h"

extern "C" {
#define CALOT_GL_IMPORT(Name) \
  __attribute__((import_module("gl"), import_name(#Name))) decltype(gl##Name) gl##Name;
CALOT_GL_FUNCTIONS(CALOT_GL_IMPORT)
#undef CALOT_GL_IMPORT
}

namespace calot::page {
namespace {

class WebContext final : public gui::GraphicsContext {
 public:
  void makeCurrent() override {}
  [[nodiscard]] Function function(const char* name) const override {
    const std::string_view wanted = name;
#define CALOT_GL_FIND(Name) \
  if (wanted == "gl" #Name) return reinterpret_cast<Function>(&gl##Name);
    CALOT_GL_FUNCTIONS(CALOT_GL_FIND)
#undef CALOT_GL_FIND
    return nullptr;
  }
  [[nodiscard]] const char* way() const override { return "WebGL"; }
};

}  // namespace

std::unique_ptr<gui::GraphicsContext> createWebContext() { return std::make_unique<WebContext>(); }

}  // namespace calot::page
