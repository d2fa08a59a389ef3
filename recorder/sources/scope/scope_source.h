// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "recorder/sources/scope/endoscope.h"
#include "recorder/sources/source.h"

namespace calot::recorder {

/// Another source's hands, with an endoscope that moves: its pose takes the place of the source's camera in every tick,
/// and so is recorded. Replay needs neither the endoscope nor who held it.
///
/// The endoscope is no body: it touches nothing, and the simulation of the tissue is the same whatever it does.
class ScopeSource final : public SampleSource {
 public:
  /// @param source, driver not null
  ScopeSource(std::unique_ptr<SampleSource> source, const Endoscope& endoscope, std::unique_ptr<ScopeDriver> driver);

  /// Before the first tick: the endoscope sets out from this pose instead of its start (a branch).
  void setOutFrom(const CameraSample& camera);
  /// The run must keep the pace of the clock.
  [[nodiscard]] bool realTime() const { return driver_->realTime(); }

  [[nodiscard]] const Provenance& provenance() const override { return source_->provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override;
  SourceStatus status() override { return source_->status(); }
  void rest() override;
  [[nodiscard]] Observer* watcher() override { return source_->watcher(); }
  [[nodiscard]] DeviceSource* device() override { return source_->device(); }
  [[nodiscard]] ScopeSource* scope() override { return this; }
  [[nodiscard]] Outcome ending() const override { return source_->ending(); }
  [[nodiscard]] std::string statusText() const override { return source_->statusText(); }

 private:
  std::unique_ptr<SampleSource> source_;
  Endoscope endoscope_;
  std::unique_ptr<ScopeDriver> driver_;
  ScopeMotion motion_;
};

}  // namespace calot::recorder
