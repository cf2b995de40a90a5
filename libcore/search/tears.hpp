// Tear fractions (grid/tear.hpp): one more round over a grid without frontier. No fraction depends
// on another one, so the links are shared out in any way.
//
// Each part of expand loads the whole grid in this round, because a bisection needs the records at
// both ends of a link. In the rounds before, a part reads the grid as a stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

struct OneWayLink {
  RecordIndex record = 0;
  std::uint8_t q = 0;
};

/// A part of a grid's one-way links, ascending by (record, direction).
std::vector<OneWayLink> one_way_links(const Grid& grid, Part part = {});

/// The tear fractions of `links`, by five bisections each: C, carried on from the last state that
/// was still on the branch of the record, goes to the middle of the interval in which the model
/// snaps. A conversion back tells whether the state reached is still on the branch. It is not made
/// where that state is at least 4 times nearer to one of the two states that bracket it than to the
/// other.
/// @throw ModelError naming the first link with a conversion that failed.
std::vector<TearByte> find_tears(const Grid& grid, std::span<const OneWayLink> links,
                                 Converter& converter, Progress& progress);

/// Writes `tears` of `links` as a shard. @throw std::system_error
void write_tears(const Grid& grid, std::span<const OneWayLink> links,
                 std::span<const TearByte> tears, SectionWriter& out);

/// Writes a grid with the tear fractions of all its one-way links. @throw std::system_error
void write_torn_grid(const Grid& grid, std::span<const OneWayLink> links,
                     std::span<const TearByte> tears, SectionWriter& out);

/// Merges the tear fractions of a grid without frontier, which must be there for each of its
/// one-way links. `out` was begun with the header of a grid that has them. Memory: the whole grid.
/// @throw FormatError when tear fractions are missing (it counts them), contradict each other, or
/// belong to no one-way link; std::system_error.
void merge_tears(const Section& section, std::span<const Section> shards, SectionWriter& out,
                 Progress& progress);

}  // namespace hapgrid
