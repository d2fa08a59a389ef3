// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "recorder/engine/engine.h"
#include "recorder/engine/session.h"
#include "sim/scene/scene_viewer.h"

namespace calot::recorder {

/// This program's own simulation.
class LocalEngine final : public Engine {
 public:
  /// @param model, executor outlive the engine. @param services of its session's stepper
  LocalEngine(const Model& model, Executor& executor, const StepperServices& services = {})
      : model_(model), executor_(&executor), services_(services) {}
  /// Goes on with a session that is there, which outlives the engine. @pre nobody calls start()
  explicit LocalEngine(Session& session) : model_(session.model()), session_(&session) { session.join(newest_); }
  ~LocalEngine() override {
    if (session_ != nullptr) session_->leave(newest_);
  }

  [[nodiscard]] const DigestLayout& layout() const override { return model_.layout(); }
  void start(std::uint64_t seed) override;
  [[nodiscard]] bool restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) override;
  [[nodiscard]] std::uint64_t steps() const override { return session_ != nullptr ? session_->steps() : 0; }
  EngineStep step(const StepInput& input) override;
  [[nodiscard]] Keyframe keyframe() override { return session_->keyframe(); }
  [[nodiscard]] SceneView view() override;
  [[nodiscard]] std::optional<KeyframeDifference> explain(const Keyframe& recorded) override {
    return differenceOf(model_, recorded, session_->keyframe());
  }

  /// @pre start() or restore()
  [[nodiscard]] const Session& session() const { return *session_; }

 private:
  /// Keeps what a step came to.
  class Newest final : public Observer {
   public:
    void onStep(const StepRecord& record) override {
      result = &record.result;
      digest = &record.digest;
    }
    void onEnd(Outcome /*outcome*/) override {}
    const StepResult* result = nullptr;
    const StateDigest* digest = nullptr;
  };

  [[nodiscard]] std::unique_ptr<Session> makeSession(std::uint64_t seed);

  const Model& model_;
  Executor* executor_ = nullptr;
  StepperServices services_;
  Newest newest_;
  std::vector<TickOutcome> ticks_;
  std::unique_ptr<Session> owned_;
  Session* session_ = nullptr;
  std::unique_ptr<SceneViewer> viewer_;  ///< once something is drawn
};

}  // namespace calot::recorder
