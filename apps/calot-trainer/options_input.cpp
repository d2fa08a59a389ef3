// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot-trainer/options_input.h"

#include <utility>

#include "recorder/sources/scope/scope_source.h"

namespace calot::apps {

OptionsInput::OptionsInput(SourceOptions options, std::uint64_t seed) : options_(std::move(options)), seed_(seed) {}

void OptionsInput::check(const SceneDescription& scene) { makeSource(options_, scene, seed_); }

std::unique_ptr<recorder::SampleSource> OptionsInput::open(const SceneDescription& scene) {
  return makeSource(options_, scene, seed_);
}

void OptionsInput::setOut(recorder::SampleSource& source, const SceneDescription& /*scene*/, const TickSamples& start) {
  if (auto* const device = source.device(); device != nullptr) device->setOutFrom(start);
  if (auto* const scope = source.scope(); scope != nullptr) scope->setOutFrom(start.camera);
}

void OptionsInput::drive(recorder::SampleSource& source, recorder::RunSettings& run) { driveDevice(source, run); }

void OptionsInput::record(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick) {
  recordDevice(source, writer, firstTick);
}

}  // namespace calot::apps
