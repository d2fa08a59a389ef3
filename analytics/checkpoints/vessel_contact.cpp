// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/vessel_contact.h"

#include <fmt/format.h>

namespace calot::analytics {

VesselContact::VesselContact(const AttemptContext& context, bool (*chosen)(const SceneFacts::Vessel&))
    : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {
  const std::vector<SceneFacts::Vessel>& vessels = context.scene.vessel;
  for (std::size_t v = 0; v < vessels.size(); ++v) {
    const std::size_t structure = context.scene.organ.size() + v;
    if (!chosen(vessels[v])) continue;
    bit_.push_back(std::uint32_t{1} << structure);
    names_.push_back(vessels[v].name);
  }
  steps_.resize(names_.size(), 0);
}

void VesselContact::add(const StepResult& result) {
  bool any = false;
  for (const HandResult& hand : result.hand) {
    for (std::size_t v = 0; v < bit_.size(); ++v) {
      if ((hand.contacts() & bit_[v]) == 0) continue;
      ++steps_[v];
      any = true;
    }
  }
  united_ += any ? 1 : 0;
}

double VesselContact::sum() const {
  std::uint64_t steps = 0;
  for (const std::uint64_t one : steps_) steps += one;
  return seconds(steps);
}

std::string VesselContact::parts() const {
  std::string text;
  for (std::size_t v = 0; v < steps_.size(); ++v)
    text += fmt::format("{}{} {:.2f} s", v == 0 ? "" : ", ", names_[v], seconds(steps_[v]));
  return text;
}

double VesselContact::seconds(std::uint64_t steps) const {
  return static_cast<double>(steps * ticksPerStep_) * tickSeconds_;
}

}  // namespace calot::analytics
