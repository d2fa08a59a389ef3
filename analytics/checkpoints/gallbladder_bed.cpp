// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/gallbladder_bed.h"

namespace calot::analytics {

GallbladderBed::GallbladderBed(const AttemptContext& context) {
  const std::vector<SceneFacts::Connective>& tissues = context.scene.connective;
  for (std::size_t c = 0; c < tissues.size(); ++c) {
    if (!tissues[c].holdsGallbladder) continue;
    tissue_.push_back(c);
    areas_.push_back(tissues[c].area);
    area_ += tissues[c].area;
  }
  notApplicable_ = tissue_.empty() ? "no connective tissue holds a gallbladder in this scene" : whyTooOld(context, 2);
}

void GallbladderBed::take(const StepResult& result) {
  if (!notApplicable_.empty()) return;
  double attached = 0.0;
  double torn = 0.0;
  freedArea_ = 0.0;
  for (std::size_t i = 0; i < tissue_.size(); ++i) {
    const ConnectiveResult& tissue = result.connective[tissue_[i]];
    attached += tissue.attached;
    torn += tissue.torn;
    freedArea_ += (1.0 - tissue.attached) * areas_[i];
  }
  attached_ = attached / static_cast<double>(tissue_.size());
  torn_ = torn / static_cast<double>(tissue_.size());
  any_ = true;
}

}  // namespace calot::analytics
