// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/open_loop.h"

#include "recorder/engine/session.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

AttemptInputs inputsOf(Recording& recording) {
  AttemptInputs inputs;
  inputs.outcome = recording.outcome();
  inputs.seed = recording.header().seed;
  inputs.samples.reserve(recording.tickCount());
  inputs.lateness.reserve(recording.tickCount());
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    inputs.samples.insert(inputs.samples.end(), step.samples.begin(), step.samples.end());
    for (const TickOutcome& tick : step.ticks) inputs.lateness.push_back(tick.lateness);
  }
  inputs.lateness.resize(inputs.samples.size(), 0.0F);
  return inputs;
}

void runOpenLoop(const Model& model, const AttemptInputs& inputs, std::span<Observer* const> observers,
                 Executor& executor) {
  Session session(model, inputs.seed, executor);
  for (Observer* observer : observers) session.join(*observer);
  const std::size_t every = model.scene().ticksPerStep;
  std::vector<TickOutcome> outcome(every);
  for (std::size_t begin = 0; begin + every <= inputs.samples.size(); begin += every) {
    const std::span<const TickSamples> step(inputs.samples.data() + begin, every);
    for (std::size_t i = 0; i < every; ++i) {
      outcome[i] = session.tick(step[i]);
      outcome[i].lateness = begin + i < inputs.lateness.size() ? inputs.lateness[begin + i] : 0.0F;
    }
    session.step(step, outcome, 0.0F);
  }
  session.end(inputs.outcome);
}

}  // namespace calot::recorder
