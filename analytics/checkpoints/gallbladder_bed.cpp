// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/gallbladder_bed.h"

namespace calot::analytics {

GallbladderBed::GallbladderBed(const AttemptContext& context) {
  const std::vector<SceneFacts::Connective>& tissues = context.scene.connective;
  for (std::size_t c = 0; c < tissues.size(); ++c) {
    if (tissues[c].holdsGallbladder) tissue_.push_back(c);
  }
  notApplicable_ = tissue_.empty() ? "no connective tissue holds a gallbladder in this scene" : whyTooOld(context, 2);
}

void GallbladderBed::take(const StepResult& result) {
  if (!notApplicable_.empty()) return;
  double attached = 0.0;
  double torn = 0.0;
  for (const std::size_t c : tissue_) {
    attached += result.connective[c].attached;
    torn += result.connective[c].torn;
  }
  attached_ = attached / static_cast<double>(tissue_.size());
  torn_ = torn / static_cast<double>(tissue_.size());
  any_ = true;
}

}  // namespace calot::analytics
