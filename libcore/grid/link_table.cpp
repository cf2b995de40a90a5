#include "libcore/grid/link_table.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

#include "libcore/base/digest.hpp"

namespace hapgrid {

namespace {
std::uint64_t hash(const Links& links) {
  // The bytes behind `usable` are padding, which has any value.
  const auto bytes = std::as_bytes(std::span(&links, 1));
  return hash_of(bytes.first(offsetof(Links, usable) + sizeof(links.usable)));
}
}  // namespace

Links make_links(const Level* levels, DirectionMask inside) {
  Links links;
  std::copy_n(levels, kDirections, links.level.begin());
  for (int q = 0; q < kDirections; ++q)
    if (links.level[q] < kMaxLevels) links.usable |= DirectionMask{1} << q;
  links.usable &= inside;
  return links;
}

std::uint32_t LinkTable::add(const Links& links) {
  // Neighbours are mostly alike.
  if (last_ < entries_.size() && entries_[last_] == links) return last_;
  if (2 * (entries_.size() + 1) > slots_.size()) grow();
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = hash(links) & mask;; i = (i + 1) & mask) {
    if (slots_[i] == 0) {
      entries_.push_back(links);
      slots_[i] = static_cast<std::uint32_t>(entries_.size());
      return last_ = slots_[i] - 1;
    }
    if (entries_[slots_[i] - 1] == links) return last_ = slots_[i] - 1;
  }
}

void LinkTable::grow() {
  slots_.assign(slots_.empty() ? 64 : 2 * slots_.size(), 0);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t n = 0; n < entries_.size(); ++n) {
    std::size_t i = hash(entries_[n]) & mask;
    while (slots_[i] != 0) i = (i + 1) & mask;
    slots_[i] = static_cast<std::uint32_t>(n + 1);
  }
}

void LinkTable::finish() {
  slots_ = {};
  entries_.shrink_to_fit();
}

}  // namespace hapgrid
