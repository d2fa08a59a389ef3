// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QPointF>

namespace calot::gui {

/// Motions of a pointer that is put back to the middle now and then, so that it never comes to an edge. Positions of
/// before are still under way when it was put back: they count as what they are.
class PointerTrack {
 public:
  /// The next position is where the pointer begins.
  void begin() {
    last_.reset();
    put_.reset();
  }
  /// The pointer was put there: one of the next positions is that, or what came of it.
  void put(QPointF there) { put_ = there; }
  [[nodiscard]] bool isPutBack() const { return put_.has_value(); }
  /// @return by how much the pointer was moved
  QPointF moved(QPointF now);

 private:
  std::optional<QPointF> last_, put_;
};

}  // namespace calot::gui
