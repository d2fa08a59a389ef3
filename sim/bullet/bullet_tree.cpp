// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/bullet/bullet_tree.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <algorithm>
#include <cstddef>

#include "sim/contact/broad_phase.h"

namespace calot {

namespace {

constexpr double maxCoordinate = 1e9;  // m

bool fits(const Box& box) {
  return (box.lower.array() >= -maxCoordinate).all() && (box.upper.array() <= maxCoordinate).all();
}

btDbvtVolume volumeOf(const Box& box) {
  static_assert(sizeof(btScalar) == sizeof(float));
  return btDbvtVolume::FromMM(btVector3(floatBelow(box.lower[0]), floatBelow(box.lower[1]), floatBelow(box.lower[2])),
                              btVector3(floatAbove(box.upper[0]), floatAbove(box.upper[1]), floatAbove(box.upper[2])));
}

struct Collect final : btDbvt::ICollide {
  std::vector<std::uint32_t>* found = nullptr;
  void Process(const btDbvtNode* leaf) override { found->push_back(static_cast<std::uint32_t>(leaf->dataAsInt)); }
};

}  // namespace

struct BulletTree::Tree {
  btDbvt tree;
  std::vector<btDbvtNode*> node;  ///< per leaf; null: not in the tree
  std::vector<Box> leaf;
  std::vector<std::uint32_t> outside;  ///< leaves that are not in the tree, ascending

  void put(std::uint32_t l, const Box& box) {
    leaf[l] = box;
    const auto place = std::lower_bound(outside.begin(), outside.end(), l);
    const bool wasOutside = place != outside.end() && *place == l;
    if (!fits(box)) {
      if (node[l] != nullptr) tree.remove(node[l]);
      node[l] = nullptr;
      if (!wasOutside) outside.insert(place, l);
      return;
    }
    if (wasOutside) outside.erase(place);
    btDbvtVolume volume = volumeOf(box);
    if (node[l] != nullptr) {
      tree.update(node[l], volume);
    } else {
      node[l] = tree.insert(volume, nullptr);
      node[l]->dataAsInt = static_cast<int>(l);
    }
  }
};

BulletTree::BulletTree() : tree_(std::make_unique<Tree>()) {}
BulletTree::~BulletTree() = default;

void BulletTree::update(std::span<const Box> leaves) {
  Tree& t = *tree_;
  if (leaves.size() != t.leaf.size()) {
    t.tree.clear();
    t.node.assign(leaves.size(), nullptr);
    t.leaf.assign(leaves.size(), Box{});
    t.outside.clear();
  }
  for (std::uint32_t l = 0; l < leaves.size(); ++l) t.put(l, leaves[l]);
}

void BulletTree::refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) {
  for (const std::uint32_t l : changed) tree_->put(l, leaves[l]);
}

void BulletTree::pairs(std::span<const Box> queries, std::vector<Pair>& out) const {
  const Tree& t = *tree_;
  out.clear();
  std::vector<std::uint32_t> found;
  Collect collect;
  collect.found = &found;
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    const std::size_t start = out.size();
    const auto offer = [&](std::uint32_t l) {
      if (queries[q].overlaps(t.leaf[l])) out.push_back({q, l});
    };
    if (fits(queries[q])) {
      found.clear();
      t.tree.collideTV(t.tree.m_root, volumeOf(queries[q]), collect);
      for (const std::uint32_t l : found) offer(l);
      for (const std::uint32_t l : t.outside) offer(l);
    } else {
      for (std::uint32_t l = 0; l < t.leaf.size(); ++l) offer(l);
    }
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(start), out.end());
  }
}

}  // namespace calot
