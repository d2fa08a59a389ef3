// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace calot::gui {
namespace {

bool mounted(const AttemptFigures& figures, InstrumentKind kind) {
  return std::any_of(figures.hand.begin(), figures.hand.end(), [kind](const auto& h) { return h.instrument == kind; });
}

std::string take(const AttemptFigures& figures, InstrumentKind kind) {
  return mounted(figures, kind) ? "" : fmt::format("Take the {}. ", nameOf(kind));
}

const AttemptFigures::Vessel* vesselNamed(const SceneDescription& scene, const AttemptFigures& figures,
                                          const std::string& name) {
  for (std::size_t v = 0; v < scene.vessels.size() && v < figures.vessel.size(); ++v) {
    if (scene.vessels[v].name == name) return &figures.vessel[v];
  }
  return nullptr;
}

/// The first vessel that is still to be clipped or cut, or nothing.
std::string vesselHint(const SceneDescription& scene, const AttemptFigures& figures) {
  for (const DivideDescription& wanted : scene.procedure.divide) {
    const AttemptFigures::Vessel* const vessel = vesselNamed(scene, figures, wanted.vessel);
    if (vessel == nullptr || vessel->partings > 0) continue;
    const std::uint32_t clips = wanted.patient + wanted.specimen;
    if (vessel->clips < clips) {
      return fmt::format("{}Clip the {}: {} of {} clips are on, {} stay with the patient.",
                         take(figures, InstrumentKind::clipApplier), spoken(wanted.vessel), vessel->clips, clips,
                         wanted.patient);
    }
    return fmt::format("{}Cut the {} between its clips, {} on the side that stays.",
                       take(figures, InstrumentKind::scissors), spoken(wanted.vessel), wanted.patient);
  }
  return {};
}

/// What the critical view still lacks, or nothing where it is satisfactory.
std::string viewHint(const SceneDescription& scene, const AttemptFigures& figures) {
  const ProcedureStatus& p = figures.procedure;
  if (p.criticalViewFrozen || p.criticalView() >= JudgementRules().satisfactory) return {};
  const std::string hook = take(figures, InstrumentKind::hook);
  if (p.triangleCleared < 2) return hook + "Carve the fat off Calot's triangle: pull it tight and press the cut pedal.";
  if (p.twoStructures < 2) return hook + "Free the vessels that enter the gallbladder of the fat around them.";
  return fmt::format("{}Free the lower third of the {}: {:.0f} % of that third is still attached.", hook,
                     spoken(scene.procedure.bed), std::ceil(100.0 * p.lowerThirdAttached));
}

}  // namespace

const char* nameOf(InstrumentKind kind) {
  switch (kind) {
    case InstrumentKind::none:
      return "nothing";
    case InstrumentKind::grasper:
      return "grasper";
    case InstrumentKind::hook:
      return "hook";
    case InstrumentKind::clipApplier:
      return "clip applier";
    case InstrumentKind::scissors:
      return "scissors";
  }
  return "";
}

bool isDone(const SceneDescription& scene, const AttemptFigures& figures) {
  return scene.procedure.specimen.empty() || figures.procedure.phase == Phase::done;
}

std::string hintFor(const SceneDescription& scene, const std::string& summary, const AttemptFigures& figures) {
  if (scene.procedure.specimen.empty()) return summary;
  if (figures.procedure.phase == Phase::done) return "All is done. End the attempt when you are content.";
  for (std::size_t h = 0; h < handCount; ++h) {
    if (figures.hand[h].cautery == Cautery::withoutContact)
      return fmt::format("The {} hook burns in the air: press the pedal on tissue only.", handNames[h]);
  }
  const bool toDivide =
      std::any_of(scene.procedure.divide.begin(), scene.procedure.divide.end(), [&](const DivideDescription& d) {
        const AttemptFigures::Vessel* const vessel = vesselNamed(scene, figures, d.vessel);
        return vessel != nullptr && vessel->partings == 0;
      });
  if (toDivide) {
    const std::string view = viewHint(scene, figures);
    return view.empty() ? vesselHint(scene, figures) : view;
  }
  return fmt::format("{}Take the {} off its bed: pull it away and burn what is stretched. {:.0f} % is still attached.",
                     take(figures, InstrumentKind::hook), spoken(scene.procedure.specimen),
                     std::ceil(100.0 * figures.attached));
}

}  // namespace calot::gui
