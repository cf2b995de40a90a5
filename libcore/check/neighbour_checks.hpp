// The invariants of a grid that are about the neighbours of its records, looked at as the records
// come.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "libcore/check/reachable.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/record_window.hpp"

namespace hapgrid {

struct RecordLinks {
  PointIndex point;
  Level level;
  std::uint32_t generation;
  const Level* links;     ///< 26
  const TearByte* tears;  ///< 26, or null
};

/// The rows of invariants.hpp with these names, and whether `distances` is proved.
class NeighbourChecks {
 public:
  /// @param spec outlives this. @param generation of the grid
  NeighbourChecks(const GridSpec& spec, std::uint32_t generation, bool has_tears);

  /// Adds the next record. @throw FormatError when the records are not a grid's.
  void add(const RecordLinks& record);
  /// After the last record. @throw FormatError when there are too few.
  void finish();

  Check coverage() const { return coverage_; }
  Check links() const { return links_; }
  bool has_tears() const { return has_tears_; }
  Check fractions() const { return fractions_; }
  /// Whether each generation is the distance from the seeds: each record behind the seeds has a
  /// link from a record of the generation before, so it is no farther than its generation says, and
  /// no link leads up by more than one generation, so it is no nearer.
  bool proves_distances() const { return proves_distances_; }
  /// The rows `reachable` and `generations` where that is proved.
  std::vector<Check> distances() { return distances_.finish(generation_); }

 private:
  /// A record that has tear fractions.
  struct Torn {
    PointIndex point;
    Level level;
    std::array<TearByte, kDirections> tears;
  };

  void look(PointIndex p);
  void check_links(PointIndex p, Level level, DirectionMask inside);
  void check_fractions(PointIndex p, Level level);
  bool is_one_way(PointIndex p, Level level, int q) const;
  bool is_at_distance(PointIndex p, Level level, DirectionMask inside) const;
  bool is_at_distance(PointIndex p) const;

  const GridSpec& spec_;
  const std::uint32_t generation_;
  const bool has_tears_;
  const Neighbourhood around_;
  InsideOfRun inside_of_;
  RecordWindow window_;
  Check coverage_, links_, fractions_;
  DistanceRows distances_;
  bool proves_distances_ = true;
  std::deque<Torn> torn_;  // that have not been looked at
};

}  // namespace hapgrid
