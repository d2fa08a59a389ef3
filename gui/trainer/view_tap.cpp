// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/view_tap.h"

namespace calot::gui {
namespace {

constexpr int maxUnderway = 3;
constexpr std::chrono::milliseconds period(30);  // every third step: some are lost, thirty a second are to stay
/// A window that is hidden shows nothing; it is tried again so often.
constexpr std::chrono::milliseconds patience(500);

}  // namespace

void ViewTap::begin(recorder::Session& session) {
  underway_ = 1;
  sink_(std::make_shared<const SceneView>(session.view()));
}

void ViewTap::onStep(const recorder::StepRecord& record) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  if (underway_ >= maxUnderway && now < last_ + patience) return;
  // The mean is kept, not the distance.
  next_ = now - next_ > period ? now + period : next_ + period;
  last_ = now;
  ++underway_;
  ++taken_;
  sink_(std::make_shared<const SceneView>(record.view()));
}

}  // namespace calot::gui
