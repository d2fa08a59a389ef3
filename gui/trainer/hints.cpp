// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "gui/words/event_words.h"
#include "sim/instruments/instruments.h"

namespace calot::gui {
namespace {

bool acts(const AttemptFigures::Hand& hand, InstrumentAction action) {
  return instrumentOf(hand.instrument).action == action;
}

/// What to mount first, or nothing where a hand has an instrument that does this.
std::string take(const AttemptFigures& figures, InstrumentAction action) {
  if (std::any_of(figures.hand.begin(), figures.hand.end(), [action](const auto& h) { return acts(h, action); }))
    return "";
  for (const InstrumentDefinition* instrument : instruments()) {
    if (instrument->action == action) return fmt::format("Take the {}. ", instrument->word);
  }
  return "";
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
                         take(figures, InstrumentAction::clip), spoken(wanted.vessel), vessel->clips, clips,
                         wanted.patient);
    }
    return fmt::format("{}Cut the {} between its clips, {} on the side that stays.",
                       take(figures, InstrumentAction::cut), spoken(wanted.vessel), wanted.patient);
  }
  return {};
}

/// What the critical view still lacks, or nothing where it is satisfactory.
std::string viewHint(const SceneDescription& scene, const AttemptFigures& figures) {
  const ProcedureStatus& p = figures.procedure;
  if (p.criticalViewFrozen || p.criticalView() >= JudgementRules().satisfactory) return {};
  const std::string hook = take(figures, InstrumentAction::burn);
  if (p.triangleCleared < 2) return hook + "Carve the fat off Calot's triangle: pull it tight and press the cut pedal.";
  if (p.twoStructures < 2) return hook + "Free the vessels that enter the gallbladder of the fat around them.";
  return fmt::format("{}Free the lower third of the {}: {:.0f} % of that third is still attached.", hook,
                     spoken(scene.procedure.bed), std::ceil(100.0 * p.lowerThirdAttached));
}

}  // namespace

std::string whatIsUndone(const SceneDescription& scene, const AttemptFigures& figures) {
  if (!figures.touched) return "nothing was touched";
  if (scene.procedure.specimen.empty() || figures.procedure.phase == Phase::done) return {};
  const std::string phase = wordFor(figures.procedure.phase);
  return phase.empty() ? "the procedure is not done" : "the procedure was still at its phase " + phase;
}

std::string hintFor(const SceneDescription& scene, const std::string& summary, const AttemptFigures& figures) {
  if (scene.procedure.specimen.empty()) return summary;
  if (figures.procedure.phase == Phase::done) return "All is done. End the attempt when you are content.";
  for (std::size_t h = 0; h < handCount; ++h) {
    if (figures.hand[h].cautery == Cautery::withoutContact)
      return fmt::format("The {} {} burns in the air: press the pedal on tissue only.", handNames[h],
                         instrumentOf(figures.hand[h].instrument).word);
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
                     take(figures, InstrumentAction::burn), spoken(scene.procedure.specimen),
                     std::ceil(100.0 * figures.attached));
}

}  // namespace calot::gui
