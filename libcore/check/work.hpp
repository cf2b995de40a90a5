// What the force gives the hand along links: what the search for closed walks that gain energy
// asks (energy.hpp).
#pragma once

#include <optional>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

struct Link {
  RecordIndex from;
  int q;
};

/// Links that are asked for lead somewhere.
class Work {
 public:
  /// @param grid outlives this.
  explicit Work(const Grid& grid) : grid_(grid) {}
  virtual ~Work() = default;

  /// Whether walks take links in direction q.
  virtual bool takes(int q) const = 0;
  /// In newtons times the model's unit of length.
  virtual double gain(const Link& link) const = 0;
  /// How much more than what play gains this may be.
  virtual double allowance(const Link& link) const = 0;

  /// The energy of the record's state, if the work is known to come from one: where the potential
  /// begins.
  virtual std::optional<double> energy(RecordIndex) const { return std::nullopt; }

  bool is_reversible(const Link& link) const { return !grid_.is_one_way(link.from, link.q); }
  /// In the model's unit of length.
  double length(const Link& link) const;

 protected:
  const Grid& grid_;
};

}  // namespace hapgrid
