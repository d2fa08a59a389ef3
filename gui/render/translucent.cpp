// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/translucent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gui/render/mesh.h"
#include "sim/math/random.h"

namespace calot::gui {
namespace {

constexpr std::array<double, 5> rows{0.0, 0.13, 0.5, 0.87, 1.0};  // along a strand
constexpr double sag = 0.13;             // largest deviation of a strand from its chord, over its length
constexpr double thinningLength = 4e-3;  // m; longer tissue is stretched, and thinner
constexpr double tuftLength = 2.8e-3, tuftWidth = 2.2e-3;
constexpr double stumpLength = 0.9e-3, stumpWidth = 1.5e-3;
constexpr double goneAlpha = 0.2;  // where a strand in the hook's heat looks burnt through

Vec3 unitOr(const Vec3& v, const Vec3& other) {
  const double length = v.norm();
  return length > 1e-12 ? Vec3(v / length) : other;
}

/// A strand bent between its ends, in C.
struct Curve {
  std::array<Vec3, rows.size()> point, along;
  double length = 0.0;  // of the chord
  double alpha = 0.0;
};

class SheetBuilder {
 public:
  explicit SheetBuilder(const CameraSample& camera)
      : origin_(camera.position), toCamera_(camera.orientation.normalized().conjugate().toRotationMatrix()) {}

  void add(const ConnectiveView& view) {
    std::vector<Curve> curves;
    curves.reserve(view.strand.size());
    for (std::size_t s = 0; s < view.strand.size(); ++s) curves.push_back(curveOf(view, s));
    for (std::size_t p = 0; p < view.sheet.size(); ++p) {
      const auto [i, j] = view.sheet[p];
      if (view.condition[i] != StrandCondition::attached || view.condition[j] != StrandCondition::attached) continue;
      addSheet(curves[i], curves[j], p);
    }
    for (std::size_t s = 0; s < view.strand.size(); ++s) {
      if (view.condition[s] == StrandCondition::attached) continue;
      const bool burned = view.condition[s] == StrandCondition::burned;
      for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) addRemnant(view, s, end, burned);
    }
  }

  SheetList finish() {
    std::sort(piece_.begin(), piece_.end(), [](const Piece& a, const Piece& b) {
      return a.depth != b.depth ? a.depth > b.depth : a.firstVertex < b.firstVertex;
    });
    for (const Piece& piece : piece_)
      for (std::uint32_t r = 0; r + 1 < piece.rows; ++r)
        for (std::uint32_t c = 0; c + 1 < piece.columns; ++c) {
          const std::uint32_t v = piece.firstVertex + r * piece.columns + c;
          list_.index.insert(list_.index.end(),
                             {v, v + 1, v + piece.columns, v + 1, v + piece.columns + 1, v + piece.columns});
        }
    return std::move(list_);
  }

 private:
  struct Piece {
    double depth = 0.0;  // z of its middle in C
    std::uint32_t firstVertex = 0;
    std::uint32_t rows = 0, columns = 0;
  };

  [[nodiscard]] Vec3 toCamera(const Vec3& p_W) const { return toCamera_ * (p_W - origin_); }

  [[nodiscard]] Curve curveOf(const ConnectiveView& view, std::size_t s) const {
    Curve curve;
    const Vec3 a = view.strand[s][0], chord = view.strand[s][1] - a;
    Random random(s);
    const Vec3 any(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double skew = random.uniform(-0.6, 0.6);
    curve.length = chord.norm();
    curve.alpha = static_cast<double>(view.alpha[s]);
    const Vec3 direction = unitOr(chord, Vec3::UnitZ());
    const Vec3 aside = sag * curve.length * (any - any.dot(direction) * direction);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double v = rows[r];
      curve.point[r] = toCamera(a + v * chord + 4.0 * v * (1.0 - v) * (1.0 + skew * (2.0 * v - 1.0)) * aside);
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Vec3 step = curve.point[std::min(r + 1, rows.size() - 1)] - curve.point[r == 0 ? 0 : r - 1];
      curve.along[r] = unitOr(step, Vec3::UnitZ());
    }
    return curve;
  }

  void begin(const Vec3& middle, std::size_t rowCount, std::size_t columnCount) {
    piece_.push_back({middle.z(), static_cast<std::uint32_t>(list_.vertex.size()), static_cast<std::uint32_t>(rowCount),
                      static_cast<std::uint32_t>(columnCount)});
  }

  void vertex(const Vec3& p, const Vec3& normal, const Vec3& along, const std::array<double, 4>& look, double erosion) {
    SheetVertex v{};
    for (int a = 0; a < 3; ++a) {
      v.position[a] = static_cast<float>(p[a]);
      v.normal[a] = static_cast<float>(normal[a]);
      v.along[a] = static_cast<float>(along[a]);
    }
    for (std::size_t a = 0; a < look.size(); ++a) v.look[a] = static_cast<float>(look[a]);
    v.erosion = static_cast<float>(erosion);
    list_.vertex.push_back(v);
  }

  void addSheet(const Curve& left, const Curve& right, std::size_t number) {
    Random random(number, 1);
    const double s = random.uniform(), t = random.uniform();
    const double across = (random.uniform() < 0.5 ? -1.0 : 1.0) * random.uniform(0.09, 0.15);
    const double shear = random.uniform(-0.05, 0.05), wear = random.uniform(-0.10, 0.22);
    begin(0.25 * (left.point.front() + left.point.back() + right.point.front() + right.point.back()), rows.size(), 2);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Vec3 between = right.point[r] - left.point[r];
      const Vec3 normal = unitOr(between.cross(left.along[r] + right.along[r]), Vec3::UnitZ());
      const double foot = std::abs(2.0 * rows[r] - 1.0);  // matted where it is attached, worn in the middle
      const double feather = r == 0 || r + 1 == rows.size() ? 0.3 : 1.0;
      for (const Curve* curve : {&left, &right}) {
        const double burnt = std::clamp((1.0 - curve->alpha) / (1.0 - goneAlpha), 0.0, 1.0);
        const double thinned = std::sqrt(thinningLength / (thinningLength + curve->length));
        const bool second = curve == &right;
        vertex(curve->point[r], normal, curve->along[r],
               {s + (second ? across : 0.0) + shear * rows[r], t + 0.36 * rows[r], curve->alpha * thinned * feather,
                burnt},
               wear + 0.28 * burnt + 0.16 - 0.42 * foot * foot * foot);
      }
    }
  }

  /// Stump of a strand: a ribbon that faces the camera, frayed towards its tip.
  void addRemnant(const ConnectiveView& view, std::size_t s, std::size_t end, bool burned) {
    Random random(2 * s + end, 2);
    const Vec3 from = view.strand[s][end], chord = view.strand[s][1 - end] - from;
    const Vec3 any(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double alpha = burned ? 0.75 : 0.8 * static_cast<double>(view.alpha[s]);
    const double burnt =
        burned ? 1.0 : std::clamp((1.0 - static_cast<double>(view.alpha[s])) / (1.0 - goneAlpha), 0.0, 1.0);
    const double length = (burned ? stumpLength : tuftLength) * random.uniform(0.6, 1.2);
    const double width = (burned ? stumpWidth : tuftWidth) * random.uniform(0.7, 1.2);
    const Vec3 direction = toCamera_ * unitOr(unitOr(chord, Vec3::UnitZ()) + 0.45 * any, Vec3::UnitZ());
    const Vec3 droop = toCamera_ * (0.35 * Vec3(any.y(), any.z(), any.x()));
    const Vec3 root = toCamera(from);
    const Vec3 aside = unitOr(direction.cross(root), Vec3::UnitX());
    const double texS = random.uniform(), texT = random.uniform();
    begin(root + 0.5 * length * direction, 3, 3);
    for (int r = 0; r < 3; ++r) {
      const double v = 0.5 * r;
      const Vec3 middle = root + length * (v * direction + v * v * droop);
      const Vec3 along = unitOr(direction + 2.0 * v * droop, direction);
      const Vec3 normal = unitOr(along.cross(aside), Vec3::UnitZ());
      for (int c = -1; c <= 1; ++c)
        vertex(middle + 0.5 * c * width * (1.0 - 0.35 * v) * aside, normal, along,
               {texS + 0.11 * c, texT + 0.10 * v, alpha, burnt},
               burned ? -0.5 + 1.1 * v * v + 0.7 * c * c : -0.2 + 0.85 * v + 0.55 * c * c);
    }
  }

  Vec3 origin_;
  Mat3 toCamera_;
  SheetList list_;
  std::vector<Piece> piece_;
};

constexpr double fullEnergy = 4.0;                    // J, of the densest puff
constexpr double riseTime = 0.8;                      // s, over which a puff slows down
constexpr double rise = 0.030, aside = 0.012;         // m, in the end
constexpr double puffRadius = 0.0022, grown = 0.016;  // radius (m), at first and added in the end
constexpr double densest = 0.45;                      // opacity

}  // namespace

SheetList makeSheetList(const SceneView& view) {
  SheetBuilder builder(view.camera);
  for (const ConnectiveView& connective : view.connective) builder.add(connective);
  return builder.finish();
}

void SmokeTrail::add(double time, std::span<const Event> events) {
  while (!puff_.empty() && -puff_.front().age < time - smokeSeconds) puff_.pop_front();
  std::uint32_t nth = 0;
  for (const Event& event : events) {
    if (event.kind != EventKind::smoke) continue;
    const auto number = static_cast<std::uint32_t>(event.step) * 8U + nth++;
    puff_.push_back({event.position, -time, std::sqrt(std::clamp(event.value / fullEnergy, 0.0, 1.0)), number});
  }
}

std::vector<Puff> SmokeTrail::at(double time) const {
  std::vector<Puff> puffs(puff_.begin(), puff_.end());
  for (Puff& puff : puffs) puff.age += time;
  std::erase_if(puffs, [](const Puff& puff) { return puff.age >= smokeSeconds; });
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
