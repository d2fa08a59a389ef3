// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_patches.h"

#include <algorithm>
#include <map>
#include <utility>

namespace calot {

namespace {

void halve(std::vector<std::pair<Vec3, Index3>>& items, std::size_t first, std::size_t last,
           std::vector<ContactSurface::Patch>& patches) {
  if (last - first <= ContactSurface::largestPatch) {
    patches.push_back({first, last});
    return;
  }
  Box box;
  for (std::size_t i = first; i < last; ++i) box.include(items[i].first);
  const Vec3 size = box.upper - box.lower;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : (size[1] >= size[2] ? 1 : 2);
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(first), items.begin() + static_cast<std::ptrdiff_t>(last),
            [axis](const auto& a, const auto& b) {
              if (a.first[axis] != b.first[axis]) return a.first[axis] < b.first[axis];
              return std::lexicographical_compare(a.second.data(), a.second.data() + 3, b.second.data(),
                                                  b.second.data() + 3);
            });
  const std::size_t middle = first + (last - first) / 2;
  halve(items, first, middle, patches);
  halve(items, middle, last, patches);
}

}  // namespace

ContactSurface::ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles) {
  std::vector<std::pair<Vec3, Index3>> items;
  items.reserve(triangles.size());
  for (const Index3& t : triangles) {
    const Vec3 centre = (rest[static_cast<std::size_t>(t[0])] + rest[static_cast<std::size_t>(t[1])] +
                         rest[static_cast<std::size_t>(t[2])]) /
                        3.0;
    items.emplace_back(centre, t);
  }
  if (!items.empty()) halve(items, 0, items.size(), patch_);
  triangle_.reserve(items.size());
  for (const auto& item : items) triangle_.push_back(item.second);

  std::map<std::pair<int, int>, int> opposite;  // directed edge -> third corner
  std::vector<std::vector<int>> neighbours(rest.size());
  for (const Index3& t : triangle_) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      opposite[{a, b}] = t[(k + 2) % 3];
      neighbours[static_cast<std::size_t>(a)].push_back(b);
      neighbours[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  for (const Index3& t : triangle_) {
    Index3 o;
    for (int k = 0; k < 3; ++k) {
      const auto found = opposite.find({t[(k + 1) % 3], t[k]});
      o[k] = found == opposite.end() ? -1 : found->second;
    }
    opposite_.push_back(o);
  }
  neighbourStart_.push_back(0);
  for (std::size_t n = 0; n < neighbours.size(); ++n) {
    std::vector<int>& list = neighbours[n];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    neighbour_.insert(neighbour_.end(), list.begin(), list.end());
    neighbourStart_.push_back(neighbour_.size());
    if (!list.empty()) node_.push_back(static_cast<int>(n));
  }
}

void patchBounds(const ContactSurface& surface, std::span<const Vec3> position, double margin, std::vector<Box>& out) {
  out.resize(surface.patches().size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    Box box;
    for (std::size_t t = surface.patches()[p].first; t < surface.patches()[p].last; ++t) {
      for (int k = 0; k < 3; ++k) box.include(position[static_cast<std::size_t>(surface.triangles()[t][k])]);
    }
    // Coordinates are below 8 m: 1e-6 m is more than one unit in the last place of float there.
    box.grow(margin + 1e-6);
    out[p] = box;
  }
}

}  // namespace calot
