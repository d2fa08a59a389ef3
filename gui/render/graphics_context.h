// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

namespace calot::gui {

/// An OpenGL 4.5 core context without a window. All members are called on the thread that called makeCurrent().
class GraphicsContext {
 public:
  virtual ~GraphicsContext() = default;
  /// @throws calot::Error (failure)
  virtual void makeCurrent() = 0;
  /// Address of an OpenGL function, or null.
  using Function = void (*)();
  [[nodiscard]] virtual Function function(const char* name) const = 0;
  /// Name of the context: "OSMesa".
  [[nodiscard]] virtual const char* way() const = 0;
};

/// Mesa's software rasterizer. @throws calot::Error (failure) if it gives no context of this version.
[[nodiscard]] std::unique_ptr<GraphicsContext> createSoftwareContext();

/// card: graphics cards; software: what EGL offers without one, which takes the same way through it.
enum class DeviceKind { card, software };

/// On the first device of the kind that has what is needed. @throws calot::Error (failure) saying what the last one
/// lacks.
[[nodiscard]] std::unique_ptr<GraphicsContext> createDeviceContext(DeviceKind kind);

}  // namespace calot::gui
