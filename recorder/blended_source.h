// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "recorder/sources/source.h"

namespace calot::recorder {

/// Another source from its tick 0 on, whose hands and camera set out from where a recording left them: for `blendTime`
/// the pose goes from the last measured one to the source's own by minimum jerk,
///   p = p_0 + s (p_source(t) - p_0),  s = 10 u^3 - 15 u^4 + 6 u^5,  u = t / blendTime
/// (orientation on the shorter arc, jaw angle likewise), so that neither place nor speed jumps at the fork. Instrument,
/// buttons and validity are the source's own from the first tick. Samples are rounded as every source's are.
class BlendedSource final : public SampleSource {
 public:
  static constexpr double blendTime = 1.0;  ///< s

  /// @param source outlives this. @param start the last measured pose of hands and camera.
  BlendedSource(SampleSource& source, const TickSamples& start) : source_(source), start_(start) {}

  [[nodiscard]] const Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override;
  SourceStatus status() override { return source_.status(); }
  void rest() override { source_.rest(); }
  [[nodiscard]] Observer* watcher() override { return source_.watcher(); }
  [[nodiscard]] DeviceSource* device() override { return source_.device(); }
  [[nodiscard]] Outcome ending() const override { return source_.ending(); }
  [[nodiscard]] std::string statusText() const override { return source_.statusText(); }

 private:
  SampleSource& source_;
  TickSamples start_;
};

}  // namespace calot::recorder
