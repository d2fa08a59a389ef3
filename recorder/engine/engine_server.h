// SPDX-License-Identifier: GPL-3.0-or-later
// The answering side of an engine's protocol (schemas/engine.md): requests in, answers out, as bytes. What carries them
// - a pipe, a WebAssembly module's memory - is no concern of it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "recorder/engine/session.h"
#include "recorder/engine/wire.h"

namespace calot::recorder {

class EngineServer {
 public:
  /// @param software program and version
  EngineServer(std::string software, Confinement confinement)
      : software_(std::move(software)), confinement_(confinement) {}

  /// The answer to a request, a whole message; valid until the next call. After a fault there is nothing more to ask.
  std::span<const std::byte> answer(std::uint32_t kind, std::span<const std::byte> payload);
  /// A fault was answered.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  void dispatch(std::uint32_t kind, std::span<const std::byte> payload);
  void hello(std::span<const std::byte> payload);
  void scene(std::span<const std::byte> payload);
  void restore(std::span<const std::byte> payload);
  void step(std::span<const std::byte> payload);
  void fail(wire::FaultCode code, const std::string& message);
  /// Was an attempt begun, and has it a step? A fault where not.
  bool running();
  bool stepped();

  std::string software_;
  Confinement confinement_;
  bool greeted_ = false, begun_ = false, ended_ = false;
  std::unique_ptr<const Model> model_;
  SerialExecutor executor_;
  std::unique_ptr<LocalEngine> engine_;
  std::vector<TickSamples> samples_;
  std::vector<TickOutcome> logged_;
  wire::Bytes answer_;
};

}  // namespace calot::recorder
