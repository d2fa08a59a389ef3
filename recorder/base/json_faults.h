// SPDX-License-Identifier: GPL-3.0-or-later
// All faults of a JSON file at once, rather than the first.
#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::recorder {

/// While one lives, objects that this thread reads note faults where reading can go on, instead of throwing the first:
/// unknown and missing keys, and values out of their range, which stay at their defaults.
class JsonFaults {
 public:
  JsonFaults();
  ~JsonFaults();
  JsonFaults(const JsonFaults&) = delete;
  JsonFaults& operator=(const JsonFaults&) = delete;

  /// In the order in which they were found, each once.
  [[nodiscard]] const std::vector<Error>& found() const { return found_; }
  void note(const Error& fault);

  /// Has this thread noted a fault at one of these places of a file, or within it?
  [[nodiscard]] static bool at(std::initializer_list<std::string_view> pointers);
  /// Notes the fault where faults are noted. @throws the fault where they are not
  static void report(const Error& fault);
  /// Runs a part of the reading whose fault does not keep other parts from being read.
  template <class Work>
  static void part(Work&& work) {
    try {
      work();
    } catch (const Error& fault) {
      report(fault);
    }
  }

 private:
  JsonFaults* outer_;
  std::vector<Error> found_;
};

}  // namespace calot::recorder
