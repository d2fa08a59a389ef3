// SPDX-License-Identifier: GPL-3.0-or-later
// Phases, critical view of safety and mistakes of an attempt, as a WebAssembly module: the judge that all programs use,
// over results of steps in the protocol's form (schemas/engine.md), and the words for events.
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "gui/page/wasm/thrown.h"
#include "gui/words/event_words.h"
#include "recorder/engine/wire.h"
#include "recorder/formats/scene_assets.h"
#include "sim/judgement/judge.h"
#include "sim/scene/version.h"

namespace {

using namespace calot;
namespace wire = recorder::wire;

/// State of the judge for one attempt.
struct Begin {
  std::vector<wire::File> files;      ///< the scene file first
  std::vector<wire::Column> columns;  ///< of a row of results
  static void fields(auto& self, auto& visit) {
    visit("files", self.files);
    visit("columns", self.columns);
  }
};

struct Row {
  std::uint64_t step = 0;
  wire::Bytes results;
  std::vector<wire::Event> events;
  static void fields(auto& self, auto& visit) {
    visit("step", self.step);
    visit("results", self.results);
    visit("events", self.events);
  }
};

/// An event in words.
struct Told {
  std::uint64_t step = 0;
  std::uint8_t fault = 0;
  std::string text;
  static void fields(auto& self, auto& visit) {
    visit("step", self.step);
    visit("fault", self.fault);
    visit("text", self.text);
  }
};

struct Answer {
  std::vector<std::uint8_t> phase;  ///< of each step
  std::vector<Told> told;
  std::uint8_t criticalView = 0;     ///< points after the last step, of six
  std::vector<std::string> verdict;  ///< a sentence a severity, the gravest first
  static void fields(auto& self, auto& visit) {
    visit("phase", self.phase);
    visit("told", self.told);
    visit("critical view", self.criticalView);
    visit("verdict", self.verdict);
  }
};

/// Reads a row of results. How many parts there are of each kind is what the columns say.
struct ReadRow {
  const std::vector<wire::Column>& columns;
  ByteReader reader;
  std::size_t next = 0;

  [[nodiscard]] std::size_t width(const ResultGroup& group, const ResultField& field) {
    if (next == columns.size() || columns[next].path != std::string(group.path) + "/" + field.name) return 0;
    return columns[next++].width;
  }
  template <class T>
  void one(const ResultGroup& group, const ResultField& field, T& value) {
    const std::size_t wide = width(group, field);
    if (wide == 0) return;
    if constexpr (std::is_same_v<T, std::vector<double>>) {
      value.resize(wide);
      for (double& v : value) reader.read(v);
    } else if constexpr (std::is_same_v<T, Quat>) {
      wire::Rotation r{};
      reader.read(r);
      value = Quat(r[0], r[1], r[2], r[3]);
    } else {
      reader.read(value);
    }
  }
  template <class Part, class T>
  void each(const ResultGroup& group, const ResultField& field, std::vector<Part>& parts, T Part::*member) {
    const std::size_t wide = width(group, field);
    if (wide == 0) return;
    parts.resize(wide);
    for (Part& part : parts) reader.read(part.*member);
  }
};

struct Attempt {
  Begin begin;
  std::unique_ptr<Judge> judge;
  gui::SubjectNames names;
  double stepSeconds = 0.0;
  std::vector<std::string> missing;  ///< notAssessed()
  wire::Bytes answer;
};

Attempt& attempt() {
  static Attempt one;
  return one;
}

}  // namespace

extern "C" {

/// Takes the placed payload, a Begin. @return 1, or 0 if it is invalid
__attribute__((export_name("calot_begin"))) int calot_begin() {
  Attempt& a = attempt();
  a = {};
  if (!recorder::decode(page::placed(), a.begin)) return 0;
  std::vector<recorder::Asset> assets;
  for (wire::File& file : a.begin.files) assets.push_back({std::move(file.name), std::move(file.content)});
  const SceneDescription scene = recorder::sceneFromAssets(std::move(assets)).description;
  a.judge = std::make_unique<Judge>(scene);
  a.names = analytics::subjectNames(scene);
  a.stepSeconds = tickLength * static_cast<double>(scene.ticksPerStep);
  a.missing = notAssessed(scene, stepResultVersion);
  return 1;
}

/// Judges the next steps: placed are their rows. @return how many bytes calot_judged() has; 0 where they are no rows
__attribute__((export_name("calot_judge"))) std::uint32_t calot_judge() {
  Attempt& a = attempt();
  std::vector<Row> rows;
  if (a.judge == nullptr || !recorder::decode(page::placed(), rows)) return 0;
  Answer answer;
  for (const Row& row : rows) {
    StepResult result;
    result.step = row.step;
    ReadRow read{a.begin.columns, ByteReader(row.results)};
    StepResult::fields(result, stepResultVersion, read);
    if (!read.reader.complete()) return 0;
    for (const wire::Event& event : row.events) result.events.push_back(wire::fromWire(event));
    const Judgement& now = a.judge->observe(result);
    answer.phase.push_back(static_cast<std::uint8_t>(now.phase));
    for (const gui::Told& told : gui::tell(now, a.names))
      answer.told.push_back({row.step, static_cast<std::uint8_t>(told.marked() ? 1 : 0), told.text});
    answer.criticalView = static_cast<std::uint8_t>(now.criticalView());
    answer.verdict = analytics::verdictOf(now.errorList, a.names, a.stepSeconds, a.missing);
  }
  a.answer = recorder::encodePayload(answer);
  return static_cast<std::uint32_t>(a.answer.size());
}

__attribute__((export_name("calot_judged"))) const std::byte* calot_judged() { return attempt().answer.data(); }

}  // extern "C"
