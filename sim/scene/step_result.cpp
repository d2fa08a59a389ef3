// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/step_result.h"

#include <span>

#include "sim/math/fields.h"
#include "sim/scene/version.h"

namespace calot {

namespace {

/// All numbers of a result as bytes, lists after their lengths.
struct ResultBytes {
  ByteWriter writer;

  template <class T>
  void one(const ResultGroup&, const ResultField&, const T& value) {
    writer.write(value);
  }
  template <class Part, class T>
  void each(const ResultGroup&, const ResultField&, const std::vector<Part>& parts, T Part::*member) {
    writer.write(static_cast<std::uint64_t>(parts.size()));
    for (const Part& part : parts) writer.write(part.*member);
  }
};

std::vector<std::byte> bytesOfResult(const StepResult& result) {
  std::vector<std::byte> bytes;
  ResultBytes visit{ByteWriter(bytes)};
  visit.writer.write(result.step);
  StepResult::fields(result, stepResultVersion, visit);
  visit.writer.write(static_cast<std::uint64_t>(result.events.size()));
  for (const Event& event : result.events) visit.writer.write(event);
  return bytes;
}

}  // namespace

bool StepResult::isSameAs(const StepResult& other) const { return bytesOfResult(*this) == bytesOfResult(other); }

}  // namespace calot
