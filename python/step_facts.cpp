// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/step_facts.h"

#include <cstring>
#include <string_view>

#include "recorder/engine/state_fields.h"
#include "recorder/recording/recorded_columns.h"
#include "sim/scene/version.h"

namespace calot::python {

namespace {

template <class T>
void copyBytes(const std::vector<T>& values, Bytes& out) {
  out.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
}

/// Notes the unit of every visited field.
struct UnitNotes {
  std::map<std::string, std::string>& units;

  template <class T>
  void one(const ResultGroup& group, const ResultField& field, const T&) {
    note(group, field);
  }
  template <class Parts, class Member>
  void each(const ResultGroup& group, const ResultField& field, const Parts&, Member) {
    note(group, field);
  }

 private:
  void note(const ResultGroup& group, const ResultField& field) {
    const std::string path = std::string(group.path) + "/" + field.name;
    units[path.substr(std::string_view("/observables/").size())] = field.unit;
  }
};

}  // namespace

std::map<std::string, std::string> resultUnits() {
  std::map<std::string, std::string> units;
  const StepResult result;
  StepResult::fields(result, stepResultVersion, UnitNotes{units});
  return units;
}

void FactsObserver::observe(const recorder::StepRecord& record) {
  facts_.observation.clear();
  ByteWriter writer(facts_.observation);
  const auto both = [&](auto&& write) {
    for (const HandResult& hand : record.result.hand) write(hand);
  };
  both([&](const HandResult& h) { writer.write(h.tipSimulated); });
  both([&](const HandResult& h) {
    for (const double part : {h.orientation.w(), h.orientation.x(), h.orientation.y(), h.orientation.z()})
      writer.write(part);
  });
  both([&](const HandResult& h) { writer.write(h.jaw); });
  both([&](const HandResult& h) { writer.write(h.insertion); });
  both([&](const HandResult& h) { writer.write(h.contactForce); });
  both([&](const HandResult& h) {
    for (const double force : h.structureForce) writer.write(force);
  });
  both([&](const HandResult& h) { writer.write(h.graspForce); });
  for (const recorder::HandTick& hand : record.ticks.back().hand) writer.write(hand.force);
  writer.write(static_cast<double>(record.step + 1) * stepSeconds_);
}

void FactsObserver::onStep(const recorder::StepRecord& record) {
  facts_.step = record.step;
  observe(record);
  facts_.row.clear();
  recorder::appendResultRow(record.result, facts_.row);
  facts_.forces.resize(record.ticks.size() * handCount * 6 * sizeof(double));
  std::byte* at = facts_.forces.data();
  for (const recorder::TickOutcome& tick : record.ticks) {
    for (const recorder::HandTick& hand : tick.hand) {
      std::memcpy(at, hand.force.data(), 3 * sizeof(double));
      std::memcpy(at + 3 * sizeof(double), hand.torque.data(), 3 * sizeof(double));
      at += 6 * sizeof(double);
    }
  }
  copyBytes(record.digest.component, facts_.digest);
  const Judgement& judged = judge_.observe(record.result);
  facts_.events = recorder::packedEvents(judged.events);
  facts_.phase = static_cast<std::uint8_t>(judged.phase);
  facts_.criticalView = static_cast<std::uint8_t>(judged.criticalView());
  facts_.errors = judged.errors();
  facts_.criticalErrors = judged.errors(Severity::critical);
}

}  // namespace calot::python
