// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/patch_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/contact/broad_phase.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

/// Per group, a bit for each box whose squared distance from a point is at most `maximum`.
CALOT_LANE_KERNEL void ballKernel(const BoxLanes* const* boxes, std::size_t count, const float* lower,
                                  const float* upper, float maximum, std::uint8_t* hit) {
  for (std::size_t g = 0; g < count; ++g) {
    EightFloats sum{};
    for (std::size_t a = 0; a < 3; ++a) {
      EightFloats below;
      EightFloats above;
      readVector(boxes[g]->lower[a], below);
      readVector(boxes[g]->upper[a], above);
      below -= upper[a];
      above = lower[a] - above;
      EightFloats d = below < above ? above : below;
      d = d >= 0.0F ? d : EightFloats{};
      sum += d * d;
    }
    const EightInts bits = (sum <= maximum) & EightInts{1, 2, 4, 8, 16, 32, 64, 128};
    const FourInts four =
        __builtin_shufflevector(bits, bits, 0, 1, 2, 3) | __builtin_shufflevector(bits, bits, 4, 5, 6, 7);
    hit[g] = static_cast<std::uint8_t>((four[0] | four[1]) | (four[2] | four[3]));
  }
}

/// More than two units in the last place: a value scaled outward by this is rounded outward.
constexpr float outward = 2.5e-7F;

float below(double x) {
  const auto f = static_cast<float>(x);
  return f - std::abs(f) * outward;
}
float above(double x) {
  const auto f = static_cast<float>(x);
  return f + std::abs(f) * outward;
}

void empty(BoxLanes& boxes) {
  std::fill_n(&boxes.lower[0][0], 3 * laneCount, std::numeric_limits<float>::infinity());
  std::fill_n(&boxes.upper[0][0], 3 * laneCount, -std::numeric_limits<float>::infinity());
}

}  // namespace

PatchTriangles::Ball::Ball(const Vec3& p, double distance)
    : squared(static_cast<float>(distance * distance) * (1.0F + 4e-6F)) {
  for (int a = 0; a < 3; ++a) {
    lower[static_cast<std::size_t>(a)] = floatBelow(p[a]);
    upper[static_cast<std::size_t>(a)] = floatAbove(p[a]);
  }
}

void PatchTriangles::within(std::span<const BoxLanes* const> boxes, const Ball& ball, std::vector<std::uint8_t>& hit) {
  hit.resize(boxes.size());
  ballKernel(boxes.data(), boxes.size(), ball.lower.data(), ball.upper.data(), ball.squared, hit.data());
}

void PatchTriangles::begin(const ContactSurface& surface, std::span<const Vec3> position) {
  surface_ = &surface;
  position_ = position;
  patch_.resize(surface.patches().size());
  for (Patch& patch : patch_) patch.made = false;
}

void PatchTriangles::make(std::uint32_t patch) {
  Patch& own = patch_[patch];
  own.made = true;
  const std::size_t first = surface_->patches()[patch].first;
  const std::size_t last = surface_->patches()[patch].last;
  own.count = laneGroups(last - first);
  empty(own.whole);
  for (std::size_t g = 0; g < own.count; ++g) {
    Group& group = own.group[g];
    std::array<std::uint32_t, laneCount> triangle{};
    group.first = first + g * laneCount;
    const std::size_t count = std::min<std::size_t>(laneCount, last - group.first);
    std::iota(triangle.begin(), triangle.end(), static_cast<std::uint32_t>(group.first));
    gatherTriangles(*surface_, position_, {triangle.data(), count}, group.triangles);
    BoundsLanes exact;
    boxesOf(group.triangles, exact);
    group.slivers = 0;
    for (std::size_t l = 0; l < laneCount; ++l) group.slivers |= (isSliver(group.triangles, l) ? 1U : 0U) << l;
    empty(group.box);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t l = 0; l < count; ++l) {
        group.box.lower[a][l] = below(exact.lower[a][l]);
        group.box.upper[a][l] = above(exact.upper[a][l]);
      }
      own.whole.lower[a][g] = *std::min_element(group.box.lower[a], group.box.lower[a] + laneCount);
      own.whole.upper[a][g] = *std::max_element(group.box.upper[a], group.box.upper[a] + laneCount);
    }
  }
}

void PatchTriangles::choose(std::span<const std::uint32_t> patches, const Box& box) {
  chosen_.clear();
  chosenBoxes_.clear();
  std::array<float, 3> lower{};
  std::array<float, 3> upper{};
  for (std::size_t a = 0; a < 3; ++a) {
    lower[a] = below(box.lower[static_cast<int>(a)]);
    upper[a] = above(box.upper[static_cast<int>(a)]);
  }
  for (const std::uint32_t p : patches) {
    const Patch& patch = of(p);
    for (std::size_t g = 0; g < patch.count; ++g) {
      bool out = false;
      for (std::size_t a = 0; a < 3; ++a) {
        out |= patch.whole.upper[a][g] < lower[a];
        out |= patch.whole.lower[a][g] > upper[a];
      }
      if (out) continue;
      const std::size_t lane = chosen_.size() % laneCount;
      if (lane == 0) empty(chosenBoxes_.emplace_back());
      for (std::size_t a = 0; a < 3; ++a) {
        chosenBoxes_.back().lower[a][lane] = patch.whole.lower[a][g];
        chosenBoxes_.back().upper[a][lane] = patch.whole.upper[a][g];
      }
      chosen_.push_back({p, static_cast<std::uint32_t>(g), &patch.group[g]});
    }
  }
  whole_.clear();
  for (const BoxLanes& boxes : chosenBoxes_) whole_.push_back(&boxes);
}

}  // namespace calot
