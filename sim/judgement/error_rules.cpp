// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/judgement/error_rules.h"

#include <algorithm>
#include <array>

namespace calot {
namespace {

constexpr const char* spared = "A duct or an artery that stays is injured.";
// Strasberg, Hertl, Soper: An analysis of the problem of biliary injury during laparoscopic cholecystectomy.
constexpr const char* injuries = "Strasberg, Hertl, Soper 1995";
// Strasberg, Brunt: Rationale and use of the critical view of safety in laparoscopic cholecystectomy.
constexpr const char* view = "Strasberg, Brunt 2010";
// Tang, Hanna, Joice, Cuschieri: Identification and categorization of technical errors during laparoscopic
// cholecystectomy.
constexpr const char* technical = "Tang, Hanna, Joice, Cuschieri 2004";
// Zehetner, Shamiyeh, Wayand: Lost gallstones in laparoscopic cholecystectomy.
constexpr const char* spill = "Zehetner, Shamiyeh, Wayand 2007";
constexpr const char* own = "own; the scene's clips";
// New device with force sensors for laparoscopic liver resection: investigation of grip force and histological damage.
// Surgeons gripped with 3.38 N at most; the harm to the lobules grew with the force.
constexpr const char* grip = "Minim Invasive Ther Allied Technol 2022;31:28-33";

constexpr auto critical = Severity::critical, major = Severity::major, minor = Severity::minor;
constexpr auto structure = ErrorSubject::structure;

constexpr std::array<ErrorRuleText, 26> rules{{
    {ErrorRule::sparedCut, critical, "spared-cut", structure, "cut, though it must be spared", spared, injuries},
    {ErrorRule::sparedBurned, critical, "spared-burned", structure, "burned through, though it must be spared", spared,
     injuries},
    {ErrorRule::sparedTorn, critical, "spared-torn", structure, "torn, though it must be spared", spared, injuries},
    {ErrorRule::sparedClipped, critical, "spared-clipped", structure, "clipped, though it must be spared", spared,
     injuries},
    {ErrorRule::sparedHeated, critical, "spared-heated", structure, "wall burned, though it must be spared",
     "A burned wall leaks or narrows weeks later.", injuries},
    {ErrorRule::leftOpen, critical, "left-open", structure, "left open",
     "No clip closes its end on the side that stays: a duct leaks bile, an artery bleeds.", injuries},
    {ErrorRule::notIdentified, critical, "not-identified", structure, "divided without identification",
     "The critical view had fewer than three of six points when it was divided.", view},
    {ErrorRule::tooFewClips, critical, "too-few-clips", structure, "cut with too few clips",
     "The side that stays has fewer clips than the scene asks for.", own},
    {ErrorRule::cutThroughClip, critical, "cut-through-clip", structure, "cut through a clip",
     "A clip that is cut does not hold.", technical},
    {ErrorRule::burnedThrough, major, "burned-through", structure, "burned through instead of cut",
     "It is to be clipped and cut.", technical},
    {ErrorRule::torn, major, "torn", structure, "torn instead of cut", "It is to be clipped and cut.", technical},
    {ErrorRule::viewIncomplete, major, "view-incomplete", structure,
     "divided before the critical view was satisfactory",
     "The critical view had three or four of six points when it was divided, where five are satisfactory.", view},
    {ErrorRule::perforated, major, "perforated", structure, "perforated", "A hole spills bile and stones.", spill},
    {ErrorRule::organTorn, major, "organ-torn", structure, "torn", "A liver that tears bleeds.", technical},
    {ErrorRule::openTowardsSpecimen, major, "open-towards-specimen", structure, "left open towards the specimen",
     "The gallbladder spills bile and stones through it.", spill},
    {ErrorRule::tooFewTowardsSpecimen, major, "too-few-clips-towards-specimen", structure,
     "cut with too few clips towards the specimen", "The side that goes has fewer clips than the scene asks for.", own},
    {ErrorRule::clipHalfOn, major, "clip-half-on", structure, "clipped in part only",
     "A clip that does not enclose the whole vessel does not close it.", technical},
    {ErrorRule::clipLost, major, "clip-lost", ErrorSubject::none, "clip lost",
     "A clip that closes on nothing falls into the abdomen.", technical},
    {ErrorRule::burnedAndSealed, minor, "burned-and-sealed", structure, "burned through and sealed instead of clipped",
     "It is to be clipped and cut; coagulation closed it.", technical},
    {ErrorRule::heated, minor, "heated", structure, "wall burned", "A clip holds less well on a burned wall.",
     technical},
    {ErrorRule::clipOnClip, minor, "clip-on-clip", structure, "clipped over another clip",
     "Clips that overlap do not close.", own},
    {ErrorRule::clipTooNear, minor, "clip-too-near", structure,
     "clipped too near to another clip, a junction or an end", "There is no space to cut, or the clip slips off.", own},
    {ErrorRule::tornFromJaws, minor, "torn-from-jaws", structure, "torn out of the jaws",
     "It was pulled harder than it holds.", technical},
    {ErrorRule::slipped, minor, "slipped", structure, "slipped in the jaws",
     "It was pulled harder than the grip holds.", technical},
    {ErrorRule::pressedHard, minor, "pressed-hard", structure, "pressed hard",
     "The liver bleeds where an instrument presses with more force than surgeons grip it with.", grip},
    {ErrorRule::strandsTorn, minor, "strands-torn", ErrorSubject::connective, "torn instead of burned",
     "Blunt tearing opens the gallbladder or the liver.", technical},
}};

/// Place in the table: the gravest rule first.
std::size_t rankOf(ErrorRule rule) {
  const auto* const at =
      std::find_if(rules.begin(), rules.end(), [rule](const ErrorRuleText& text) { return text.rule == rule; });
  return static_cast<std::size_t>(at - rules.begin());
}

bool concernsSame(const JudgedError& a, const JudgedError& b) {
  return textOf(a.rule).subject == textOf(b.rule).subject &&
         (textOf(a.rule).subject == ErrorSubject::none || a.event.subject == b.event.subject);
}

}  // namespace

std::span<const ErrorRuleText> errorRules() { return rules; }

const ErrorRuleText& textOf(ErrorRule rule) { return rules[rankOf(rule)]; }

void ErrorList::add(std::span<const JudgedError> errors) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const auto again = [&](std::size_t j) { return concernsSame(errors[i], errors[j]); };
    bool known = false;
    for (std::size_t j = 0; j < i && !known; ++j) known = again(j);
    if (known) continue;
    AttemptError found;
    JudgedError gravest = errors[i];
    for (std::size_t j = i; j < errors.size(); ++j) {
      if (!again(j)) continue;
      const ErrorRule rule = errors[j].rule;
      if (std::find(found.rules.begin(), found.rules.end(), rule) == found.rules.end()) found.rules.push_back(rule);
      if (rankOf(rule) < rankOf(gravest.rule)) gravest = errors[j];
    }
    std::sort(found.rules.begin(), found.rules.end(), [](ErrorRule a, ErrorRule b) { return rankOf(a) < rankOf(b); });
    found.subject = gravest.event.subject;
    found.first = found.last = found.worst = gravest.event.step;
    found.value = gravest.event.value;
    const auto line = std::find_if(all_.begin(), all_.end(), [&](const AttemptError& e) {
      return e.rules == found.rules &&
             (e.subject == found.subject || textOf(found.rules.front()).subject == ErrorSubject::none);
    });
    if (line == all_.end()) {
      all_.push_back(std::move(found));
      continue;
    }
    // Tissue slips and tears step after step: that is one occasion.
    line->count += found.first - line->last > sameOccasion_ ? 1 : 0;
    line->last = found.last;
    if (found.value > line->value) {
      line->value = found.value;
      line->worst = found.worst;
    }
  }
  sort();
}

void ErrorList::goOn(const JudgedError& error) {
  for (AttemptError& line : all_) {
    if (line.subject != error.event.subject ||
        std::find(line.rules.begin(), line.rules.end(), error.rule) == line.rules.end())
      continue;
    line.last = error.event.step;
    if (error.event.value > line.value) {
      line.value = error.event.value;
      line.worst = error.event.step;
    }
  }
}

void ErrorList::takeBack(ErrorRule rule, std::uint16_t subject) {
  for (AttemptError& line : all_) {
    if (line.subject == subject) std::erase(line.rules, rule);
  }
  std::erase_if(all_, [](const AttemptError& line) { return line.rules.empty(); });
  sort();
}

void ErrorList::sort() {
  std::stable_sort(all_.begin(), all_.end(), [](const AttemptError& a, const AttemptError& b) {
    return a.severity() != b.severity() ? a.severity() > b.severity() : a.first < b.first;
  });
}

std::uint32_t ErrorList::count(Severity severity) const {
  std::uint32_t sum = 0;
  for (const AttemptError& line : all_) sum += line.severity() == severity ? line.count : 0;
  return sum;
}

std::vector<std::string> notAssessed(const SceneDescription& scene, std::uint32_t resultVersion) {
  std::vector<std::string> missing;
  const ProcedureDescription& procedure = scene.procedure;
  if (!procedure.divide.empty() && procedure.fat.empty() && procedure.bed.empty())
    missing.emplace_back("identification (nothing hides the vessels of this scene)");
  if (!procedure.spare.empty() && resultVersion < 5)
    missing.emplace_back("burned walls (the recording's simulation does not tell)");
  if (!scene.vessels.empty()) missing.emplace_back("bleeding (nothing bleeds in the simulation)");
  return missing;
}

}  // namespace calot
