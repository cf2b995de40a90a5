// What check-model notes beside its trials: no fault of the search, but most likely the owner's.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// `felt`: a model without a force, or with one that no hand notices.
std::optional<Check> note_felt(bool has_force, double largest_newtons, std::uint64_t forces);

/// `spread`: states that count as the same, and are more than a tenth of the tolerance apart.
/// @param distances of such states, in the unit of the tolerance
std::optional<Check> note_spread(const std::vector<double>& distances, const GridSpec& spec);

/// `memory`: a model whose memory grows as long as it is asked.
class MemoryLog {
 public:
  /// @param bytes are asked for some times in all, because they take a while
  template <class Bytes>
  void look(std::uint64_t steps, Bytes&& bytes) {
    if (steps % every_ == 0) add(steps, bytes());
  }
  std::optional<Check> note() const;

 private:
  struct Look {
    std::uint64_t steps, bytes;
  };
  void add(std::uint64_t steps, std::uint64_t bytes);

  std::vector<Look> looks_;
  std::uint64_t every_ = 1;  // steps
};

/// What the verdict says of `snaps` when so few were seen that a model that leaps would pass, too.
std::string remark_on_snaps(const Findings& snaps);

}  // namespace hapgrid
