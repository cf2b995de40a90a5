// Stores each distinct set of links once, because most records of a grid have the same links as
// their neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/grid/direction.hpp"

namespace hapgrid {

/// The links of a record. Half a cache line.
struct alignas(32) Links {
  std::array<Level, kDirections> level;  ///< the destination level in each direction
  /// Directions whose link may lead to a record.
  DirectionMask usable = 0;

  friend bool operator==(const Links&, const Links&) = default;
};

/// @param levels 26 @param inside the directions that stay in the box
Links make_links(const Level* levels, DirectionMask inside);

/// Distinct Links, numbered in the order in which they came.
class LinkTable {
 public:
  /// The number of an entry that equals `links`, which is added if there is none.
  std::uint32_t add(const Links& links);
  const Links& operator[](std::uint32_t number) const { return entries_[number]; }
  std::size_t size() const { return entries_.size(); }
  /// Frees what only add() needs.
  void finish();

 private:
  void grow();

  std::vector<Links> entries_;
  std::vector<std::uint32_t> slots_;  // open addressing: number + 1, or 0; a power of two
  std::uint32_t last_ = 0;
};

}  // namespace hapgrid
