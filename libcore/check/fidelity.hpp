// Condition b) of Sect. 2.2, tested on the model itself: the state that is stored where a link
// leads must be C(s, x, d). For a costly model a repeatable sample of the records has to do.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libcore/check/invariants.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// What these checks ask of a model. One is used by one thread at a time.
struct ModelFunctions {
  /// C(s, x, d) and what is stored with it into `row`; answers false and says why in `error` when
  /// it fails.
  std::function<bool(const double* s, const Vec3& x, const Vec3& d, double* row,
                     std::string& error)>
      convert;
  /// Only set for a model process, which takes many questions at once.
  std::function<void(const NextConversion&, const ConversionDone&)> convert_many;
  /// Fills in what is stored with the state at the beginning of `row`, for the HIP at x.
  std::function<bool(const Vec3& x, double* row, std::string& error)> complete;
  SameState same;
};

/// The functions of `model`, which lives as long as they do.
ModelFunctions model_functions(std::unique_ptr<Model> model);

/// `count` of the records that are not in the frontier, ascending; all of them when there are no
/// more. Depends on the grid's records, `count` and `seed` only, not on the platform.
std::vector<RecordIndex> sample_records(const Grid& grid, std::uint64_t count, std::uint64_t seed);

/// `stored`: evaluates force, energy and shape of `records` again and compares them with what is
/// stored. Arguments as below.
Check check_stored(const Grid& grid, std::span<const RecordIndex> records,
                   const std::function<ModelFunctions()>& make_model, int threads);

/// `fidelity`: evaluates C in all settled directions of `records` and compares what it reaches
/// with what is stored there. Counts conversions; one that fails is an offender with the model's
/// own words. Directions that lead nowhere are left to `links`, and states that are not
/// finite, here or there, to `finite`.
/// @param make_model is called once a thread, from the calling thread.
/// @param threads at least 1; the result does not depend on it.
/// @param records_done counts up meanwhile, for whoever shows it.
Check check_fidelity(const Grid& grid, std::span<const RecordIndex> records,
                     const std::function<ModelFunctions()>& make_model, int threads,
                     std::atomic<std::uint64_t>& records_done);

}  // namespace hapgrid
