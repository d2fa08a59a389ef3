// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/smoke.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "gui/render/mesh.h"
#include "sim/math/random.h"

namespace calot::gui {
namespace {

constexpr double fullEnergy = 4.0;                    // J, of the densest puff
constexpr double riseTime = 0.8;                      // s, over which a puff slows down
constexpr double rise = 0.030, aside = 0.012;         // m, in the end
constexpr double puffRadius = 0.0022, grown = 0.016;  // radius (m), at first and added in the end
constexpr double densest = 0.45;                      // opacity

}  // namespace

void SmokeTrail::add(double time, std::span<const Event> events) {
  while (!source_.empty() && source_.front().time < time - smokeSeconds) source_.pop_front();
  std::uint32_t nth = 0;
  for (const Event& event : events) {
    if (event.kind != EventKind::smoke) continue;
    const auto number = static_cast<std::uint32_t>(event.step) * 8U + nth++;
    source_.push_back({event.position, time, std::sqrt(std::clamp(event.value / fullEnergy, 0.0, 1.0)), number});
  }
}

std::vector<Puff> SmokeTrail::at(double time) const {
  std::vector<Puff> puffs;
  for (const Source& source : source_)
    if (const double age = time - source.time; age < smokeSeconds)
      puffs.push_back({source.p_W, age, source.strength, source.number});
  return puffs;
}

SmokeList makeSmokeList(const CameraSample& camera, const Vec3& down, std::span<const Puff> puffs) {
  const Quat up = upright(down);
  const Mat3 toCamera = camera.orientation.normalized().conjugate().toRotationMatrix();
  struct Seen {
    Vec3 p_C = Vec3::Zero();
    double radius = 0.0, opacity = 0.0, offset = 0.0;
  };
  std::vector<Seen> seen;
  for (const Puff& puff : puffs) {
    if (!(puff.age >= 0.0 && puff.age < smokeSeconds)) continue;
    Random random(puff.number, 3);
    const double x = random.uniform(-1.0, 1.0);
    const double y = random.uniform(-1.0, 1.0);
    const double offset = random.uniform();
    const double gone = 1.0 - std::exp(-puff.age / riseTime);  // of its way
    const Vec3 p_W = puff.p_W + gone * (up * Vec3(aside * x, aside * y, rise));
    const double left = 1.0 - puff.age / smokeSeconds;
    const double opacity = densest * puff.strength * left * left * std::min(1.0, puff.age / 0.06);
    seen.push_back({toCamera * (p_W - camera.position), puffRadius + grown * gone, opacity, offset});
  }
  std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.p_C.z() > b.p_C.z(); });
  SmokeList list;
  for (const Seen& s : seen) {
    const auto first = static_cast<std::uint32_t>(list.vertex.size());
    for (const auto& [u, v] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}}) {
      SmokeVertex vertex{};
      const Vec3 p = s.p_C + s.radius * Vec3(u, v, 0.0);
      for (int a = 0; a < 3; ++a) vertex.position[a] = static_cast<float>(p[a]);
      vertex.corner[0] = static_cast<float>(u);
      vertex.corner[1] = static_cast<float>(v);
      vertex.opacity = static_cast<float>(s.opacity);
      vertex.offset = static_cast<float>(s.offset);
      list.vertex.push_back(vertex);
    }
    list.index.insert(list.index.end(), {first, first + 1, first + 2, first + 1, first + 3, first + 2});
  }
  return list;
}

}  // namespace calot::gui
