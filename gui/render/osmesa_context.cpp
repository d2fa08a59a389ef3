// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include <GL/osmesa.h>

#include "gui/render/graphics_context.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

class OsmesaContext final : public GraphicsContext {
 public:
  OsmesaContext() {
    static constexpr std::array<int, 13> attributes{OSMESA_FORMAT,
                                                    OSMESA_RGBA,
                                                    OSMESA_DEPTH_BITS,
                                                    0,
                                                    OSMESA_PROFILE,
                                                    OSMESA_CORE_PROFILE,
                                                    OSMESA_CONTEXT_MAJOR_VERSION,
                                                    4,
                                                    OSMESA_CONTEXT_MINOR_VERSION,
                                                    5,
                                                    0,
                                                    0,
                                                    0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
    if (context_ == nullptr)
      throw Error(ErrorKind::failure,
                  "rendering: no off-screen OpenGL 4.5; install a Mesa with libosmesa6 22 or newer");
  }
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void makeCurrent() override {
    // Pictures are drawn into framebuffer objects; this buffer only has to exist.
    if (OSMesaMakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, side, side) != GL_TRUE)
      throw Error(ErrorKind::failure, "rendering: the off-screen OpenGL context cannot be made current");
  }
  Function function(const char* name) const override { return OSMesaGetProcAddress(name); }
  const char* way() const override { return "OSMesa"; }

 private:
  static constexpr int side = 16;
  std::array<unsigned char, 4 * side * side> buffer_{};
  OSMesaContext context_ = nullptr;
};

}  // namespace

std::unique_ptr<GraphicsContext> createSoftwareContext() { return std::make_unique<OsmesaContext>(); }

}  // namespace calot::gui
