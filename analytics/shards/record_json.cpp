// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/record_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>
#include <vector>

#include "analytics/shards/row_text.h"
#include "recorder/recording/station_key.h"
#include "recorder/words.h"

namespace calot::analytics {
namespace {

using nlohmann::ordered_json;
using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::KeyRule;
using recorder::ObjectRule;

constexpr double maxUnsigned = 4294967295.0;
/// As the recording's own bound (s).
constexpr double maxStepSeconds = 1e6;

/// Texts of a record: key and where they are.
constexpr std::pair<const char*, std::string AttemptRecord::*> recordTexts[] = {
    {"parent", &AttemptRecord::parent},
    {"participant", &AttemptRecord::participant},
    {"scene", &AttemptRecord::scene},
    {"profile", &AttemptRecord::profile},
    {"profile_version", &AttemptRecord::profileVersion},
    {"purpose", &AttemptRecord::purpose},
    {"start_utc", &AttemptRecord::startUtc},
    {"device", &AttemptRecord::device},
    {"calibration", &AttemptRecord::calibration},
    {"station", &AttemptRecord::station},
    {"comparability_key", &AttemptRecord::comparabilityKey},
    {"file_name", &AttemptRecord::fileName}};

const ObjectRule& recordRule() {
  static const ObjectRule rule = [] {
    ObjectRule made{"record",
                    {{"uuid"},
                     {"scene_major", true, 0.0, maxUnsigned},
                     {"scene_minor", true, 0.0, maxUnsigned},
                     {"operator"},
                     {"mode"},
                     {"outcome"},
                     {"seed"},
                     {"simulation_version", true, 0.0, maxUnsigned},
                     {"synthetic"},
                     {"complete"},
                     countKey("steps"),
                     {"step_seconds", true, 0.0, maxStepSeconds, true},
                     {"chain_head"},
                     {"public_key", false},
                     {"signature", false},
                     {"verdict"}}};
    for (const char* text : {"verdict_text", "verdict_software"}) {
      for (KeyRule& key : textKeys(text)) made.keys.push_back(std::move(key));
    }
    for (const auto& text : recordTexts) {
      for (KeyRule& key : textKeys(text.first)) made.keys.push_back(std::move(key));
    }
    return made;
  }();
  return rule;
}

std::uint64_t seedFrom(const JsonPlace& place) {
  const std::string text = place.text(20);
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) place.fail("a whole number below 2^64 is wanted");
  return seed;
}

template <std::size_t N>
std::array<std::uint8_t, N> numbersOf(const std::array<std::byte, N>& bytes) {
  std::array<std::uint8_t, N> numbers{};
  std::transform(bytes.begin(), bytes.end(), numbers.begin(), [](std::byte b) { return static_cast<std::uint8_t>(b); });
  return numbers;
}

bool isSignedHead(const AttemptRecord& a) {
  return recorder::fits(numbersOf(a.signature->value), numbersOf(a.signature->publicKey), numbersOf(a.chainHead));
}

}  // namespace

ordered_json jsonOfRecord(const AttemptRecord& a) {
  ordered_json json = {{"uuid", a.uuid}};
  for (const auto& [key, text] : recordTexts) putText(json, key, a.*text);
  json["scene_major"] = a.sceneMajor;
  json["scene_minor"] = a.sceneMinor;
  json["operator"] = wordFor(a.operatorKind);
  json["mode"] = wordFor(a.mode);
  json["outcome"] = wordFor(a.outcome);
  json["seed"] = fmt::format("{}", a.seed);
  json["simulation_version"] = a.simulationVersion;
  json["synthetic"] = a.synthetic;
  json["complete"] = a.complete;
  json["steps"] = a.steps;
  json["step_seconds"] = a.stepSeconds;
  json["chain_head"] = hexOf(a.chainHead);
  if (a.signature) {
    json["public_key"] = hexOf(a.signature->publicKey);
    json["signature"] = hexOf(a.signature->value);
  }
  json["verdict"] = nameOf(a.verification.verdict);
  putText(json, "verdict_text", a.verification.text);
  putText(json, "verdict_software", a.verification.software);
  return json;
}

AttemptRecord recordFrom(const JsonPlace& place) {
  const JsonObject o = place.object(recordRule());
  AttemptRecord a;
  o.read("uuid", a.uuid, maxRowText);
  for (const auto& [key, text] : recordTexts) a.*text = takeText(o, key);
  o.read("scene_major", a.sceneMajor);
  o.read("scene_minor", a.sceneMinor);
  a.operatorKind = o.at("operator")
                       .word<recorder::OperatorKind>(
                           {{wordFor(recorder::OperatorKind::human), recorder::OperatorKind::human},
                            {wordFor(recorder::OperatorKind::kinematics), recorder::OperatorKind::kinematics},
                            {wordFor(recorder::OperatorKind::performer), recorder::OperatorKind::performer}});
  a.mode = o.at("mode").word<recorder::Mode>({{wordFor(recorder::Mode::practice), recorder::Mode::practice},
                                              {wordFor(recorder::Mode::assessment), recorder::Mode::assessment}});
  a.outcome = o.at("outcome").word<recorder::Outcome>(
      {{wordFor(recorder::Outcome::running), recorder::Outcome::running},
       {wordFor(recorder::Outcome::completed), recorder::Outcome::completed},
       {wordFor(recorder::Outcome::timeLimit), recorder::Outcome::timeLimit},
       {wordFor(recorder::Outcome::abandoned), recorder::Outcome::abandoned},
       {wordFor(recorder::Outcome::stopped), recorder::Outcome::stopped},
       {wordFor(recorder::Outcome::technicalFailure), recorder::Outcome::technicalFailure}});
  a.seed = seedFrom(o.at("seed"));
  o.read("simulation_version", a.simulationVersion);
  o.read("synthetic", a.synthetic);
  o.read("complete", a.complete);
  a.steps = takeCount(o, "steps");
  o.read("step_seconds", a.stepSeconds);
  takeHex(o.at("chain_head"), a.chainHead);
  if (o.has("public_key") != o.has("signature")) o.fail("a signature and its key are given together");
  if (o.has("signature")) {
    a.signature.emplace();
    takeHex(o.at("public_key"), a.signature->publicKey);
    takeHex(o.at("signature"), a.signature->value);
    if (!isSignedHead(a)) o.at("signature").fail("is not the key's signature of the chain head");
  }
  const std::pair<const char*, Verdict> verdicts[] = {{"verified", Verdict::verified},
                                                      {"diverged", Verdict::diverged},
                                                      {"not checkable here", Verdict::notCheckableHere}};
  a.verification.verdict = o.at("verdict").word<Verdict>({verdicts[0], verdicts[1], verdicts[2]});
  a.verification.text = takeText(o, "verdict_text");
  a.verification.software = takeText(o, "verdict_software");
  return a;
}

}  // namespace calot::analytics
