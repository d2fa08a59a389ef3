// SPDX-License-Identifier: GPL-3.0-or-later
// A context on one of the machine's graphics devices, found by enumeration: it needs no window and no display server.

#include "gui/render/graphics.h"

#include <dlfcn.h>
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <GL/osmesa.h>
#include <algorithm>
#include <array>
#include <cstddef>

#include "recorder/base/errors.h"

namespace calot::gui {

const std::vector<std::string>& graphicsWords() {
  static const std::vector<std::string> words{"auto", "card", "software", "egl-software"};
  return words;
}

Graphics graphicsFrom(std::string_view word) {
  const std::vector<std::string>& words = graphicsWords();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw Error(ErrorKind::invalid, fmt::format("graphics '{}'; there are {}", word, fmt::join(words, ", ")));
  return static_cast<Graphics>(found - words.begin());
}

namespace {

template <class Function>
Function extension(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// True if a space-separated list contains this word.
bool names(const char* list, const std::string& word) {
  return list != nullptr && fmt::format(" {} ", list).find(fmt::format(" {} ", word)) != std::string::npos;
}

/// The devices of this machine with a card behind them, or those without; none where EGL cannot list them.
std::vector<EGLDeviceEXT> devices(bool software) {
  const char* const extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!names(extensions, "EGL_EXT_device_base") && !names(extensions, "EGL_EXT_device_enumeration")) return {};
  const auto list = extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto text = extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  EGLint count = 0;
  if (list == nullptr || list(0, nullptr, &count) != EGL_TRUE || count <= 0) return {};
  std::vector<EGLDeviceEXT> ids(static_cast<std::size_t>(count));
  if (list(count, ids.data(), &count) != EGL_TRUE) return {};
  ids.resize(static_cast<std::size_t>(count));
  std::erase_if(ids, [&](EGLDeviceEXT id) {
    return software != (text != nullptr && names(text(id, EGL_EXTENSIONS), "EGL_MESA_device_software"));
  });
  return ids;
}

class EglContext final : public GraphicsContext {
 public:
  explicit EglContext(EGLDeviceEXT device) {
    const auto open = extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (open != nullptr) display_ = open(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) {
      fault_ = "it cannot be opened";
      return;
    }
    // Nothing is drawn on a surface: framebuffer objects take the pictures.
    if (!names(eglQueryString(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
      fault_ = "it wants a window";
      return;
    }
    static constexpr std::array<EGLint, 3> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    eglBindAPI(EGL_OPENGL_API);
    if (eglChooseConfig(display_, wanted.data(), &config, 1, &configs) != EGL_TRUE || configs == 0) config = nullptr;
    static constexpr std::array<EGLint, 7> attributes{
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) fault_ = "it has no OpenGL 4.5";
  }
  /// The display stays open: other contexts of the process may be on it.
  ~EglContext() override {
    if (context_ == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglReleaseThread();
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void makeCurrent() override {
    eglBindAPI(EGL_OPENGL_API);  // of the thread
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      throw Error(ErrorKind::failure, "rendering: the graphics card's OpenGL context cannot be made current");
  }
  Function function(const char* name) const override { return eglGetProcAddress(name); }
  const char* way() const override { return "EGL"; }

  /// Reason why there is no context; empty if there is one.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string fault_;
};

/// A function of libOSMesa, which is loaded when software first draws: it brings a compiler, half of a program's start.
template <class Function>
Function* osmesa(const char* name) {
  static void* const library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  void* const symbol = library != nullptr ? dlsym(library, name) : nullptr;
  if (symbol == nullptr)
    throw Error(ErrorKind::failure, "rendering: libOSMesa.so.8 cannot be loaded; install libosmesa6");
  return reinterpret_cast<Function*>(symbol);
}

class OsmesaContext final : public GraphicsContext {
 public:
  OsmesaContext() {
    static constexpr int attributes[][2]{{OSMESA_FORMAT, OSMESA_RGBA},          {OSMESA_DEPTH_BITS, 0},
                                         {OSMESA_PROFILE, OSMESA_CORE_PROFILE}, {OSMESA_CONTEXT_MAJOR_VERSION, 4},
                                         {OSMESA_CONTEXT_MINOR_VERSION, 5},     {0, 0}};
    context_ = osmesa<decltype(OSMesaCreateContextAttribs)>("OSMesaCreateContextAttribs")(attributes[0], nullptr);
    if (context_ == nullptr)
      throw Error(ErrorKind::failure,
                  "rendering: no off-screen OpenGL 4.5; install a Mesa with libosmesa6 22 or newer");
  }
  ~OsmesaContext() override { destroy_(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void makeCurrent() override {
    // Pictures are drawn into framebuffer objects; this buffer only has to exist.
    if (makeCurrent_(context_, buffer_.data(), GL_UNSIGNED_BYTE, side, side) != GL_TRUE)
      throw Error(ErrorKind::failure, "rendering: the off-screen OpenGL context cannot be made current");
  }
  Function function(const char* name) const override { return address_(name); }
  const char* way() const override { return "OSMesa"; }

 private:
  static constexpr int side = 16;
  decltype(OSMesaDestroyContext)* destroy_ = osmesa<decltype(OSMesaDestroyContext)>("OSMesaDestroyContext");
  decltype(OSMesaMakeCurrent)* makeCurrent_ = osmesa<decltype(OSMesaMakeCurrent)>("OSMesaMakeCurrent");
  decltype(OSMesaGetProcAddress)* address_ = osmesa<decltype(OSMesaGetProcAddress)>("OSMesaGetProcAddress");
  std::array<unsigned char, 4 * side * side> buffer_{};
  OSMesaContext context_ = nullptr;
};

}  // namespace

std::unique_ptr<GraphicsContext> createContext(Graphics graphics) {
  if (graphics == Graphics::software) return std::make_unique<OsmesaContext>();
  std::string why = "EGL lists none";
  for (EGLDeviceEXT device : devices(graphics == Graphics::deviceSoftware)) {
    auto context = std::make_unique<EglContext>(device);
    if (context->fault().empty()) return context;
    why = context->fault();
  }
  throw Error(ErrorKind::failure,
              fmt::format("rendering: no graphics card that draws ({}); software draws without one", why));
}

}  // namespace calot::gui
