// SPDX-License-Identifier: GPL-3.0-or-later
// Headline figures of a run, by the names of docs/reference/benchmarks.md.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace calot::bench {

class Figures {
 public:
  /// A figure of one repetition; the map holds the median over the repetitions.
  void add(const std::string& name, double value) { value_[name].push_back(value); }
  /// A bound that no repetition may exceed: the map holds the largest.
  void addLargest(const std::string& name, double value) { largest_[name].push_back(value); }

  /// One flat JSON object: name to number, in order of the names.
  [[nodiscard]] std::string json() const;

 private:
  std::map<std::string, std::vector<double>> value_;
  std::map<std::string, std::vector<double>> largest_;
};

/// The figures of this run.
Figures& figures();

}  // namespace calot::bench
