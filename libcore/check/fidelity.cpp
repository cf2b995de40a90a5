#include "libcore/check/fidelity.hpp"

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <utility>

#include "libcore/check/text.hpp"

namespace hapgrid {

namespace {

// Records that a thread takes at once: up to 1664 conversions, so that the shared counter costs
// nothing, and still few enough to keep all threads busy until the end with a slow model.
constexpr std::size_t kBlock = 64;

/// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between
/// implementations, and the sample must not.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  /// A number below `bound`; the bias of the remainder is below 2^-32 for 32-bit bounds.
  std::uint64_t below(std::uint64_t bound) {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) % bound;
  }

 private:
  std::uint64_t state_;
};

void recompute(const Grid& grid, RecordIndex r, const ModelFunctions& model,
               std::vector<double>& reached, Findings& found) {
  if (!is_finite(grid.state(r))) return;
  const Vec3 x = grid.box().position(grid.point(r));
  std::string error;
  for (int q = 0; q < kDirections; ++q) {
    const RecordIndex target = grid.destination(r, q);
    if (target == Grid::kNoRecord || !is_finite(grid.state(target))) continue;
    ++found.counted;
    if (!model.convert(grid.state(r).data(), x, grid.neighbourhood().shift(q), reached.data(),
                       error)) {
      found.offend([&] { return describe_link(grid, r, q) + ": conversion failed: " + error; });
    } else if (!model.same(reached.data(), grid.state(target).data())) {
      found.offend([&] {
        return describe_link(grid, r, q) + ": C gives " + state_text(reached) +
               ", stored at level " + std::to_string(grid.level(target)) + " is " +
               state_text(grid.state(target));
      });
    }
  }
}

}  // namespace

ModelFunctions model_functions(Model model_to_own) {
  const auto model = std::make_shared<Model>(std::move(model_to_own));
  ModelFunctions functions;
  functions.convert = [model](const double* s, const Vec3& x, const Vec3& d, double* result,
                              std::string& error) {
    const bool converted = model->convert(s, x, d, result);
    if (!converted) error = model->error();
    return converted;
  };
  functions.same = [model](const double* a, const double* b) { return model->equal(a, b); };
  return functions;
}

std::vector<RecordIndex> sample_records(const Grid& grid, std::uint64_t count, std::uint64_t seed) {
  std::vector<RecordIndex> records;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    if (!grid.in_frontier(r)) records.push_back(r);
  if (count >= records.size()) return records;
  // Floyd's algorithm (Bentley, Floyd: CACM 30 (1987) 754): each subset with the same probability,
  // from `count` random numbers.
  SplitMix64 random(seed);
  std::vector<bool> is_chosen(records.size());
  for (std::uint64_t last = records.size() - count; last < records.size(); ++last) {
    const std::uint64_t pick = random.below(last + 1);
    is_chosen[is_chosen[pick] ? last : pick] = true;
  }
  std::vector<RecordIndex> sample;
  sample.reserve(count);
  for (std::size_t i = 0; i < records.size(); ++i)
    if (is_chosen[i]) sample.push_back(records[i]);
  return sample;
}

Check check_fidelity(const Grid& grid, const std::vector<RecordIndex>& records,
                     const std::function<ModelFunctions()>& make_model, int threads,
                     std::atomic<std::uint64_t>& records_done) {
  Check check{
      "fidelity", "conversions", "links to a state that C, evaluated again, does not reach", {}};
  // Findings are kept by block and joined in order, so that the threads leave no trace.
  std::vector<Findings> blocks((records.size() + kBlock - 1) / kBlock);
  std::atomic<std::size_t> next_block{0};
  const auto work = [&](const ModelFunctions& model) {
    std::vector<double> reached(grid.state_size());
    for (std::size_t b; (b = next_block++) < blocks.size();) {
      const std::size_t end = std::min(records.size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < end; ++i)
        recompute(grid, records[i], model, reached, blocks[b]);
      records_done += end - b * kBlock;
    }
  };
  std::vector<std::future<void>> others;
  for (int t = 1; t < threads; ++t)
    others.push_back(std::async(std::launch::async, work, make_model()));
  work(make_model());
  for (std::future<void>& other : others) other.get();
  for (Findings& found : blocks) check.found.add(std::move(found));
  return check;
}

}  // namespace hapgrid
