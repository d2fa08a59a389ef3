// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/local_engine.h"

#include <utility>

namespace calot::recorder {

std::unique_ptr<Session> LocalEngine::makeSession(std::uint64_t seed) {
  auto session = std::make_unique<Session>(model_, seed, *executor_, services_);
  session->join(newest_);
  return session;
}

void LocalEngine::start(std::uint64_t seed) {
  owned_ = makeSession(seed);
  session_ = owned_.get();
}

bool LocalEngine::restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) {
  // A session that is used again keeps what it worked out of the model. The seed went into the keyframe's State.
  if (session_ != nullptr) return session_->restore(keyframe, named);
  std::unique_ptr<Session> fresh = makeSession(0);
  if (!fresh->restore(keyframe, named)) return false;
  owned_ = std::move(fresh);
  session_ = owned_.get();
  return true;
}

SceneView LocalEngine::view() {
  if (!viewer_) viewer_ = std::make_unique<SceneViewer>(model_);
  return viewer_->view(session_->state());
}

EngineStep LocalEngine::step(const StepInput& input) {
  ticks_.resize(input.samples.size());
  for (std::size_t i = 0; i < input.samples.size(); ++i) {
    const TickOutcome& logged = input.logged[i];
    ticks_[i] = session_->tick(input.samples[i], NamedSets{logged.hand[0].contactSet, logged.hand[1].contactSet});
    ticks_[i].lateness = logged.lateness;
  }
  session_->step(input.samples, ticks_, input.lateness);
  return {session_->steps() - 1, ticks_, *newest_.result, *newest_.digest};
}

}  // namespace calot::recorder
