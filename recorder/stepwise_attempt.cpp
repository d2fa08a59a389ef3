// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/stepwise_attempt.h"

#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {

class StepwiseAttempt::RunawayWatch final : public Observer {
 public:
  void onStep(const StepRecord& record) override { ranAway = ranAway || (record.result.misses & miss::runaway) != 0; }
  void onEnd(Outcome /*outcome*/) override {}
  bool ranAway = false;
};

StepwiseAttempt::StepwiseAttempt(std::shared_ptr<PreparedScene> scene, std::vector<Asset> assets, std::uint64_t seed)
    : scene_(std::move(scene)),
      assets_(std::move(assets)),
      seed_(seed),
      session_(scene_->model(), seed, executor_, scene_->services()),
      hands_(scene_->model().scene()),
      watch_(std::make_unique<RunawayWatch>()),
      samples_(scene_->model().scene().ticksPerStep),
      ticks_(samples_.size()) {
  session_.join(*watch_);
}

StepwiseAttempt::~StepwiseAttempt() = default;

void StepwiseAttempt::record(const std::filesystem::path& target, const AttemptSettings& settings,
                             const Provenance& provenance, WriterOptions options) {
  if (writer_) throw Error(ErrorKind::invalid, Where{target.string()}, "the attempt is recorded already");
  if (ended_ || steps() > 0)
    throw Error(ErrorKind::invalid, Where{target.string()},
                "a recording begins with an attempt's first step: reset, then record");
  AttemptSettings own = settings;
  own.seed = seed_;
  writer_ =
      std::make_unique<RecordingWriter>(target, makeHeader(model(), assets_, provenance, own), std::move(options));
  session_.join(*writer_);
}

Outcome StepwiseAttempt::step(const HandCommands& wanted) {
  if (ended_ || outcome_ != Outcome::running)
    throw Error(ErrorKind::invalid, "the attempt is over: reset begins another one");
  hands_.next(wanted, samples_);
  for (std::size_t i = 0; i < samples_.size(); ++i) ticks_[i] = session_.tick(samples_[i]);
  session_.step(samples_, ticks_, 0.0F);
  const double limit = model().scene().timeLimit;
  if (watch_->ranAway) {
    outcome_ = Outcome::technicalFailure;
  } else if (limit > 0.0 && static_cast<double>(steps()) * model().stepSeconds() >= limit) {
    outcome_ = Outcome::timeLimit;
  }
  return outcome_;
}

void StepwiseAttempt::end(Outcome outcome) {
  if (ended_) return;
  ended_ = true;
  if (outcome_ == Outcome::running) outcome_ = outcome;
  session_.end(outcome_);
  if (writer_) writer_->finish();
  scene_->save();
}

}  // namespace calot::recorder
