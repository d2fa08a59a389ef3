// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/solid_model.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace calot {

namespace {

/// Window of rows of one colour that are sorted by number of blocks, so that the rows of a slice have similar lengths;
/// small enough to preserve locality.
constexpr std::size_t sortedRows = 128;

/// Sorts the rows of one colour, most blocks first. @param blocks number of blocks of a row
template <class Blocks>
void sortRows(std::vector<int>& rows, Blocks&& blocks) {
  for (std::size_t first = 0; first < rows.size(); first += sortedRows) {
    const std::size_t last = std::min(first + sortedRows, rows.size());
    std::stable_sort(rows.begin() + static_cast<std::ptrdiff_t>(first),
                     rows.begin() + static_cast<std::ptrdiff_t>(last),
                     [&](int a, int b) { return blocks(a) > blocks(b); });
  }
}

/// Free nodes that share an element with each, ascending.
std::vector<std::vector<int>> neighbours(const ElementCorners& elements, const std::vector<bool>& fixed) {
  std::vector<std::vector<int>> out(fixed.size());
  for (std::size_t e = 0; e < elements.count(); ++e) {
    for (const int a : elements.of(e)) {
      for (const int b : elements.of(e)) {
        if (a != b && !fixed[static_cast<std::size_t>(b)]) out[static_cast<std::size_t>(a)].push_back(b);
      }
    }
  }
  for (std::vector<int>& list : out) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return out;
}

}  // namespace

SolidSystem::SolidSystem(const ElementCorners& elements, const std::vector<bool>& fixed)
    : corners_(elements.areCubes() ? 8 : 4) {
  const std::size_t nodes = fixed.size();
  row_.assign(nodes, -1);
  std::vector<int> numberOf(nodes, -1);  // among those that have rows
  for (std::size_t node = 0; node < nodes; ++node) {
    if (fixed[node]) continue;
    numberOf[node] = static_cast<int>(node_.size());
    node_.push_back(static_cast<int>(node));
  }
  const std::vector<std::vector<int>> near = neighbours(elements, fixed);
  std::vector<std::vector<int>> graph(node_.size());
  for (std::size_t i = 0; i < node_.size(); ++i) {
    for (const int n : near[static_cast<std::size_t>(node_[i])]) {
      graph[i].push_back(numberOf[static_cast<std::size_t>(n)]);
    }
  }
  std::vector<std::vector<int>> colours = coloured(graph);
  std::vector<std::size_t> colourOf(node_.size());
  for (std::size_t c = 0; c < colours.size(); ++c) {
    for (const int i : colours[c]) colourOf[static_cast<std::size_t>(i)] = c;
  }
  std::vector<std::vector<int>> columns;
  for (std::size_t c = 0; c < colours.size(); ++c) {
    sortRows(colours[c], [&](int i) {
      const std::vector<int>& own = graph[static_cast<std::size_t>(i)];
      return std::count_if(own.begin(), own.end(), [&](int n) { return colourOf[static_cast<std::size_t>(n)] < c; });
    });
    colourStart_.push_back(nodeOf_.size());
    for (const int i : colours[c]) {
      const int node = node_[static_cast<std::size_t>(i)];
      row_[static_cast<std::size_t>(node)] = static_cast<int>(nodeOf_.size());
      nodeOf_.push_back(node);
    }
    nodeOf_.resize(laneGroups(nodeOf_.size()) * laneCount, -1);
  }
  colourStart_.push_back(nodeOf_.size());
  columns.resize(nodeOf_.size());
  for (std::size_t r = 0; r < nodeOf_.size(); ++r) {
    if (nodeOf_[r] < 0) continue;
    columns[r].push_back(static_cast<int>(r));
    for (const int n : near[static_cast<std::size_t>(nodeOf_[r])]) {
      const int column = row_[static_cast<std::size_t>(n)];
      if (column < static_cast<int>(r)) columns[r].push_back(column);
    }
    std::sort(columns[r].begin(), columns[r].end());
  }

  // Contributions to each block, in element order; incident corners of each node likewise.
  std::vector<std::vector<std::vector<Contribution>>> perSlot(columns.size());
  for (std::size_t r = 0; r < columns.size(); ++r) perSlot[r].resize(columns[r].size());
  std::vector<std::vector<Contribution>> perNode(nodes);
  for (std::size_t e = 0; e < elements.count(); ++e) {
    const std::span<const int> corner = elements.of(e);
    for (std::size_t a = 0; a < corner.size(); ++a) {
      const auto node = static_cast<std::size_t>(corner[a]);
      perNode[node].push_back({static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), 0});
      for (std::size_t b = 0; b < corner.size(); ++b) {
        const int c = row_[static_cast<std::size_t>(corner[b])];
        elementSlot_.push_back(none);
        if (row_[node] < 0 || c < 0 || c > row_[node]) continue;
        const auto r = static_cast<std::size_t>(row_[node]);
        const auto k =
            static_cast<std::size_t>(std::lower_bound(columns[r].begin(), columns[r].end(), c) - columns[r].begin());
        perSlot[r][k].push_back(
            {static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      }
    }
  }
  for (std::size_t r = 0; r < columns.size(); ++r) {
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      Slot slot{};
      slot.node = columns[r][k] == static_cast<int>(r) ? nodeOf_[r] : -1;
      for (const Contribution& c : perSlot[r][k]) {
        const auto e = static_cast<std::size_t>(c.element);
        elementSlot_[(e * corners_ + c.a) * corners_ + c.b] = static_cast<std::uint32_t>(slot_.size());
      }
      if (!elements.areCubes()) {
        slot.first = source_.size();
        for (const Contribution& c : perSlot[r][k]) {
          source_.push_back(static_cast<std::uint32_t>((static_cast<std::size_t>(c.element) * 4 + c.a) * 4 + c.b));
        }
        slot.last = slot.transposedFrom = source_.size();
        slot_.push_back(slot);
        continue;
      }
      slot.first = source_.size();
      for (const bool transposed : {false, true}) {
        for (const Contribution& c : perSlot[r][k]) {
          if ((c.a > c.b) != transposed) continue;
          source_.push_back(
              static_cast<std::uint32_t>(36 * static_cast<std::size_t>(c.element) +
                                         HexahedralElements::pairOf(std::min(c.a, c.b), std::max(c.a, c.b))));
        }
        if (!transposed) slot.transposedFrom = source_.size();
      }
      slot.last = source_.size();
      slot_.push_back(slot);
    }
  }
  incidentStart_.push_back(0);
  for (const std::vector<Contribution>& list : perNode) {
    incident_.insert(incident_.end(), list.begin(), list.end());
    incidentStart_.push_back(incident_.size());
  }
  buildMatrix(columns);
  locateElements();
  sumColumns();
}

SolidSystem::SolidSystem(const SolidSystem& whole, std::span<const std::uint8_t> present) : corners_(whole.corners_) {
  const auto isThere = [&](std::uint32_t block) { return present[block / 36] != 0; };
  std::vector<std::uint32_t> keeps(whole.slot_.size(), 0);  // contributions
  for (std::size_t s = 0; s < keeps.size(); ++s) {
    for (std::size_t c = whole.slot_[s].first; c < whole.slot_[s].last; ++c) {
      keeps[s] += isThere(whole.source_[c]) ? 1U : 0U;
    }
  }
  // A row's diagonal is the last of its slots.
  std::vector<std::uint32_t> blocks(whole.nodeOf_.size(), 0);
  for (std::size_t r = 0; r < blocks.size(); ++r) {
    for (std::size_t s = whole.rowSlot_[r]; s < whole.rowSlot_[r + 1]; ++s) blocks[r] += keeps[s] > 0 ? 1U : 0U;
  }
  row_.assign(whole.row_.size(), -1);
  std::vector<int> rowOf(whole.nodeOf_.size(), -1);  // new, of each old one
  std::vector<int> old;                              // of each new one; -1: padding
  for (std::size_t c = 0; c + 1 < whole.colourStart_.size(); ++c) {
    colourStart_.push_back(old.size());
    std::vector<int> rows;
    for (std::size_t r = whole.colourStart_[c]; r < whole.colourStart_[c + 1]; ++r) {
      if (blocks[r] > 0) rows.push_back(static_cast<int>(r));
    }
    sortRows(rows, [&](int r) { return blocks[static_cast<std::size_t>(r)]; });
    for (const int r : rows) {
      rowOf[static_cast<std::size_t>(r)] = static_cast<int>(old.size());
      old.push_back(r);
    }
    old.resize(laneGroups(old.size()) * laneCount, -1);
  }
  colourStart_.push_back(old.size());
  nodeOf_.assign(old.size(), -1);
  std::vector<std::vector<int>> columns(old.size());
  std::vector<std::uint32_t> slotOf(whole.slot_.size(), none);  // new, of each old one
  std::vector<std::pair<int, std::size_t>> order;               // new columns of a row, and their old slots
  for (std::size_t r = 0; r < old.size(); ++r) {
    if (old[r] < 0) continue;
    const auto from = static_cast<std::size_t>(old[r]);
    nodeOf_[r] = whole.nodeOf_[from];
    row_[static_cast<std::size_t>(nodeOf_[r])] = static_cast<int>(r);
    order.clear();
    for (std::size_t s = whole.rowSlot_[from]; s < whole.rowSlot_[from + 1]; ++s) {
      if (keeps[s] > 0) order.emplace_back(rowOf[static_cast<std::size_t>(whole.slotColumn_[s])], s);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [column, s] : order) {
      columns[r].push_back(column);
      slotOf[s] = static_cast<std::uint32_t>(slot_.size());
      const Slot& was = whole.slot_[s];
      Slot slot{};
      slot.node = was.node;
      slot.first = source_.size();
      for (std::size_t c = was.first; c < was.last; ++c) {
        if (c == was.transposedFrom) slot.transposedFrom = source_.size();
        if (isThere(whole.source_[c])) source_.push_back(whole.source_[c]);
      }
      slot.last = source_.size();
      if (was.transposedFrom == was.last) slot.transposedFrom = slot.last;
      slot_.push_back(slot);
    }
  }
  for (std::size_t node = 0; node < row_.size(); ++node) {
    if (row_[node] >= 0) node_.push_back(static_cast<int>(node));
  }
  elementSlot_ = whole.elementSlot_;
  for (std::uint32_t& s : elementSlot_) s = s == none ? none : slotOf[s];
  incidentStart_.push_back(0);
  for (std::size_t node = 0; node < row_.size(); ++node) {
    for (const Contribution& c : whole.incident(node)) {
      if (present[static_cast<std::size_t>(c.element)] != 0) incident_.push_back(c);
    }
    incidentStart_.push_back(incident_.size());
  }
  buildMatrix(columns);
  locateElements();
  sumColumns();
}

void SolidSystem::buildMatrix(const std::vector<std::vector<int>>& columns) {
  matrix_ = BlockMatrix(columns);
  for (std::size_t r = 0; r < columns.size(); ++r) {
    rowSlot_.push_back(slotColumn_.size());
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      slot_[slotColumn_.size()].offset = matrix_.slot(r, k);
      slotColumn_.push_back(columns[r][k]);
    }
  }
  rowSlot_.push_back(slotColumn_.size());
}

void SolidSystem::locateElements() {
  elementOffset_.resize(elementSlot_.size());
  for (std::size_t k = 0; k < elementSlot_.size(); ++k) {
    elementOffset_[k] = elementSlot_[k] == none ? noSlot : static_cast<std::uint32_t>(slot_[elementSlot_[k]].offset);
  }
}

/// Slices by their lowest node: slices of different colours then read the same elements in close succession.
std::vector<std::size_t> SolidSystem::slicesByNodes() const {
  std::vector<std::pair<std::int32_t, std::size_t>> order;
  for (std::size_t s = 0; s < matrix_.slices(); ++s) {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (std::size_t r = s * laneCount; r < (s + 1) * laneCount; ++r) {
      if (nodeOf_[r] >= 0) least = std::min(least, nodeOf_[r]);
    }
    order.emplace_back(least, s);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> slices;
  slices.reserve(order.size());
  for (const auto& [least, s] : order) slices.push_back(s);
  return slices;
}

void SolidSystem::sumColumns() {
  const bool areCubes = corners_ == 8;
  const std::size_t nothing = noElement(elementSlot_.size() / (corners_ * corners_));
  const auto noSource = static_cast<std::uint32_t>(areCubes ? 2 * 36 * nothing : 16 * nothing);
  std::array<const Slot*, laneCount> lane{};
  for (const std::size_t s : slicesByNodes()) {
    const std::size_t width = matrix_.lower(s).width;
    for (std::size_t k = 0; k <= width; ++k) {
      Column column{};
      column.offset = k == width ? matrix_.diagonal(s) : matrix_.lower(s).value() + k * 9 * laneCount;
      column.first = columnSource_.size();
      for (std::size_t l = 0; l < laneCount; ++l) {
        const std::span<const Slot> row = ofRow(s * laneCount + l);
        const bool isThere = k == width ? !row.empty() : k + 1 < row.size();
        lane[l] = isThere ? &row[k == width ? row.size() - 1 : k] : nullptr;
        if (isThere) column.count = std::max(column.count, lane[l]->last - lane[l]->first);
      }
      for (std::size_t c = 0; c < column.count; ++c) {
        for (const Slot* slot : lane) {
          if (slot == nullptr || slot->first + c >= slot->last) {
            columnSource_.push_back(noSource);
            continue;
          }
          const std::size_t at = slot->first + c;
          columnSource_.push_back(areCubes ? 2 * source_[at] + (at >= slot->transposedFrom ? 1U : 0U) : source_[at]);
        }
      }
      column_.push_back(column);
    }
  }
  if (!areCubes) source_ = {};  // no subsystem is ever built from these
}

std::uint32_t SolidSystem::blockOffset(int row, int column) const {
  const std::size_t first = rowSlot_[static_cast<std::size_t>(row)];
  const std::size_t last = rowSlot_[static_cast<std::size_t>(row) + 1];
  // Counting instead of searching takes a few vector operations and no unpredictable branch.
  std::uint32_t below = 0;
  for (std::size_t k = first; k < last; ++k) below += slotColumn_[k] < column ? 1U : 0U;
  const std::size_t found = first + below;
  if (found == last || slotColumn_[found] != column) return noSlot;
  return static_cast<std::uint32_t>(slot_[found].offset);
}

}  // namespace calot
