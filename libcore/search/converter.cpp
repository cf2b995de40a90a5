#include "libcore/search/converter.hpp"

#include <algorithm>
#include <bit>
#include <mutex>
#include <string>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {
// A thread takes the directions of this many records at a time at most: enough to make taking them
// cheap, few enough that the last ones do not wait for a single thread.
constexpr std::uint64_t kMaxShare = 16;

thread_local CurrentConversion current;
}  // namespace

Model create_model(const ModelSource& source, const GridSpec& spec) {
  Model model = source.create(spec.parameters);
  const std::string changed =
      std::string("; was the ") + source.kind() + " changed since the grid was seeded?";
  const hapgrid_model_info& info = model.info();
  if (info.state_size != spec.state_size)
    throw ModelError("model " + spec.model + ": states of " + std::to_string(info.state_size) +
                     " components, the grid has " + std::to_string(spec.state_size) + changed);
  if (info.tolerance != spec.tolerance || spec.tolerance_unit != info.tolerance_unit)
    throw ModelError("model " + spec.model + ": another tolerance than the grid's" + changed);
  if (!(model.equality() == spec.equality))
    throw ModelError("model " + spec.model + ": another tolerance function than the grid's" +
                     changed);
  if (!(model.stored() == spec.stored) || (spec.stored.shape && model.spheres() != spec.spheres))
    throw ModelError("model " + spec.model +
                     ": keeps other forces or shapes with its states than the grid does" + changed);
  return model;
}

Converter::Converter(const ModelSource& source, const GridSpec& spec, unsigned threads,
                     Progress& progress)
    : neighbourhood_(spec.box), box_(spec.box), progress_(progress) {
  for (unsigned i = 0; i < std::max(threads, 1u); ++i)
    models_.push_back(create_model(source, spec));
}

Converter::~Converter() {
  for (Model& model : models_) model.hang_up();  // before the first of them is waited for
}

/// Conversions are given out one by one, so that a process that answers slowly holds up nothing but
/// what it has. Which failure is named does not depend on the processes: no conversion behind one
/// that failed is given out, and all before it are.
void Converter::convert_by_processes(Batch& batch) {
  std::uint64_t left = 0;
  for (std::size_t i = 0; i < batch.size(); ++i)
    left += static_cast<std::uint64_t>(std::popcount(batch.todo(i)));
  const std::uint64_t workers = std::min<std::uint64_t>(models_.size(), left);
  const std::size_t width = models_.front().row_size();
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::mutex mutex;
  std::size_t i = 0;
  DirectionMask todo = batch.size() > 0 ? batch.todo(0) : 0;
  std::uint64_t failed = kNone;  // a tag: 32 i + direction
  std::string failure;

  const auto next = [&](Conversion& conversion, bool idle) {
    const std::lock_guard lock(mutex);
    // The last ones are for those that have nothing to do, not for a second place in a queue.
    if (left == 0 || (!idle && left < workers)) return false;
    while (todo == 0) todo = batch.todo(++i);
    const int q = std::countr_zero(todo);
    const std::uint64_t tag = i * 32 + static_cast<unsigned>(q);
    if (tag > failed) return false;
    todo &= todo - 1;
    --left;
    conversion = {batch.state(i), box_.position(batch.point(i)), neighbourhood_.shift(q),
                  batch.reached(i) + static_cast<unsigned>(q) * width, tag};
    return true;
  };
  const auto done = [&](const Conversion& conversion, const std::string& error) {
    if (error.empty()) {
      progress_.conversions.fetch_add(1, std::memory_order_relaxed);
      progress_.frontier_done.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    const std::lock_guard lock(mutex);
    if (conversion.tag >= failed) return;
    failed = conversion.tag;
    failure = describe(box_, batch.point(failed / 32), batch.level(failed / 32)) + ", direction " +
              std::to_string(failed % 32) + ": " + error;
  };
  {
    std::vector<std::jthread> threads;
    try {
      for (std::uint64_t k = 1; k < workers; ++k)
        threads.emplace_back([&, k] { models_[k].convert(next, done); });
    } catch (...) {  // as below
      const std::lock_guard lock(mutex);
      left = 0;
      throw;
    }
    if (workers > 0) models_.front().convert(next, done);
  }
  if (failed != kNone) throw ModelError("conversion at " + failure);
}

const CurrentConversion& current_conversion() noexcept { return current; }

void Converter::convert(Batch& batch) {
  if (models_.front().is_process()) return convert_by_processes(batch);
  const std::size_t width = models_.front().row_size();
  // A unit is a direction of a record: where there are few records, threads share one.
  const std::uint64_t last = batch.size() * kDirections;
  const std::uint64_t share =
      std::clamp<std::uint64_t>(last / (8 * models_.size()), 1, kMaxShare * kDirections);
  std::atomic<std::uint64_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::string failure;
  std::uint64_t failed = last;  // a unit

  // A stretch that was taken is done to its end or its failure, so the first failure is found.
  const auto work = [&](Model& model) {
    while (!stop.load(std::memory_order_relaxed)) {
      const std::uint64_t from = next.fetch_add(share);
      if (from >= last) return;
      const std::uint64_t to = std::min(from + share, last);
      std::uint64_t done = 0;
      for (std::uint64_t i = from / kDirections; i * kDirections < to; ++i) {
        const std::uint64_t first = i * kDirections;
        DirectionMask left = batch.todo(i);
        if (first < from) left &= kAllDirections << (from - first);
        if (first + kDirections > to) left &= (1u << (to - first)) - 1;
        if (left == 0) continue;
        const PointIndex point = batch.point(i);
        const Level level = batch.level(i);
        const Vec3 x = box_.position(point);
        const double* state = batch.state(i);
        double* const reached = batch.reached(i);
        for (; left; left &= left - 1) {
          const int q = std::countr_zero(left);
          current = {point, level, q};
          if (!model.convert(state, x, neighbourhood_.shift(q), reached + q * width)) {
            stop = true;
            const std::lock_guard lock(mutex);
            const std::uint64_t unit = first + static_cast<unsigned>(q);
            if (unit < failed) {
              failed = unit;
              failure = describe(box_, point, level) + ", direction " + std::to_string(q) + ": " +
                        model.error();
            }
            return;
          }
          ++done;
        }
      }
      current.q = -1;
      progress_.conversions.fetch_add(done, std::memory_order_relaxed);
      progress_.frontier_done.fetch_add(done, std::memory_order_relaxed);
    }
  };

  if (models_.size() == 1 || last == 0) {
    work(models_.front());
  } else {
    std::vector<std::jthread> threads;
    try {
      for (Model& model : models_) threads.emplace_back([&work, &model] { work(model); });
    } catch (...) {  // one cannot be started: nobody waits for the work of the others
      stop = true;
      throw;
    }
  }
  if (failed != last) throw ModelError("conversion at " + failure);
}

}  // namespace hapgrid
