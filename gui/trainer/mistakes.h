// SPDX-License-Identifier: GPL-3.0-or-later
// Events that a trainee may want to undo.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/step_result.h"

namespace calot::gui {

/// So long before a mistake a branch sets out (s).
inline constexpr double goBackBy = 2.0;

/// What went wrong in one step with one structure, or again and again within a second.
struct Mistake {
  double time = 0.0;      ///< of the attempt, when it first happened (s)
  bool critical = false;  ///< fails an assessment
  std::string text;       ///< one line: "cystic duct: clip half on"

  /// Where the branch leaves (s): goBackBy earlier, or the end of the first step.
  [[nodiscard]] double branchTime(double stepSeconds) const;
};

/// The mistakes of an attempt in the order of time: clips that are dropped, half on, on one another or too near; cuts
/// through a clip, with too few clips, or that leave a vessel open; vessels burned through or torn; perforations;
/// tissue that slipped or tore out of the jaws; connective tissue that tore; and whatever is done to a vessel that must
/// be spared.
class MistakeList {
 public:
  /// @param structures names by the events' subjects; @param connective names of connective tissues
  MistakeList(std::vector<std::string> structures, std::vector<std::string> connective, double stepSeconds);

  /// The events of one step. @returns whether something was added
  bool add(std::span<const Event> events);

  [[nodiscard]] const std::vector<Mistake>& all() const { return all_; }

 private:
  [[nodiscard]] std::string nameOf(const Event& event) const;

  std::vector<std::string> structures_, connective_;
  double stepSeconds_;
  std::vector<Mistake> all_;
  std::vector<double> last_;  ///< per mistake, when it last happened (s)
};

/// "cystic-duct" as people write it.
[[nodiscard]] std::string spoken(std::string name);

}  // namespace calot::gui
