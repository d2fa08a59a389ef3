// SPDX-License-Identifier: GPL-3.0-or-later
// Choice of the OpenGL implementation.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

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

enum class Graphics {
  automatic,      ///< a graphics card where there is one that has what is needed, software else
  card,           ///< a graphics card, or an error
  software,       ///< Mesa's software rasterizer: the same bytes in every run
  deviceSoftware  ///< the same rasterizer on the way that cards are reached: to try that way without one
};

/// The words of the option `--graphics`, in the order of the enumeration: auto, card, software, egl-software.
[[nodiscard]] const std::vector<std::string>& graphicsWords();
/// @throws calot::Error (invalid) for another word
[[nodiscard]] Graphics graphicsFrom(std::string_view word);

/// A context of a card or of EGL's software, on the first device that has what is needed.
/// @param graphics not automatic
/// @throws calot::Error (failure) where this machine has no such context, saying what the last device lacks
[[nodiscard]] std::unique_ptr<GraphicsContext> createContext(Graphics graphics);

}  // namespace calot::gui
