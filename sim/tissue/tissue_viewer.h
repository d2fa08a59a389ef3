// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace calot {

struct SceneView;
struct State;

/// Adds what pictures show of one kind of tissue to scene views, and keeps from view to view what stays the same.
class TissueViewer {
 public:
  virtual ~TissueViewer() = default;
  /// @pre the state is one of the model's
  virtual void addTo(SceneView& view, const State& state) = 0;
};

}  // namespace calot
