// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "recorder/sources/devices/scope_input.h"
#include "recorder/sources/scope/scope_driver.h"

namespace calot::recorder {

/// The endoscope by the keys and the mouse of a window: it moves while a key is held, and stays where it is let go.
class ScopeKeys final : public ScopeDriver {
 public:
  static constexpr double swingSpeed = 0.3;     ///< rad/s
  static constexpr double insertSpeed = 0.03;   ///< m/s
  static constexpr double rotateSpeed = 0.8;    ///< rad/s
  static constexpr double pixelSwing = 0.0015;  ///< rad
  static constexpr double notchInsert = 0.005;  ///< m

  /// @param input not null
  explicit ScopeKeys(std::shared_ptr<ScopeInput> input) : input_(std::move(input)) {}

  void setOut(const ScopeJoints& joints) override;
  [[nodiscard]] ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) override;
  void rest() override { static_cast<void>(input_->take()); }

 private:
  std::shared_ptr<ScopeInput> input_;
  ScopeJoints aim_;
};

}  // namespace calot::recorder
