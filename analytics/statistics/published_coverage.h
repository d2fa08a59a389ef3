// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the intervals in reports: the table of docs/explanation/coverage.md; a test keeps both in agreement.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace calot::analytics {

enum class CoveredInterval : std::uint8_t {
  areaScore,
  shift,
  hedges,
  baseline,
  cut,
  iccSingle,
  iccAverage,
  alpha,
  limits,
  deming,
  sdc,
  borderline,
  spearman
};

/// One row: per cent of simulated intervals at 95 % that hold the truth, with 5, 10, 20 and 40 people in each group (of
/// agreement this many rated attempts, of consistency this many people).
struct PublishedCoverage {
  CoveredInterval interval;
  const char* name;        ///< as the page has it: "g, non-central t"
  const char* population;  ///< "exponential, 0.8"
  std::array<double, 4> percent;
};

inline constexpr std::array<std::size_t, 4> coverageSizes{5, 10, 20, 40};
/// Below this many per cent a report warns.
inline constexpr double coverageWanted = 93.0;

std::span<const PublishedCoverage> publishedCoverage();

struct CoverageDoubt {
  bool known = true;  ///< false: a group is smaller than any that was simulated
  double percent = 0.0;
  std::size_t size = 0;  ///< the simulated size per group
  const char* population = "";
};

/// The worst cell below coverageWanted at the simulated sizes on either side of the smaller group (beyond the largest:
/// at the largest). @returns whether coverage is doubtful; else `doubt` is unchanged.
bool doubtful(CoveredInterval interval, std::size_t nx, std::size_t ny, CoverageDoubt& doubt);

}  // namespace calot::analytics
