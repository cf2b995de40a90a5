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
    : box_(spec.box), progress_(progress) {
  for (unsigned i = 0; i < std::max(threads, 1u); ++i)
    models_.push_back(create_model(source, spec));
}

Converter::~Converter() {
  for (Model& model : models_) model.hang_up();  // before the first of them is waited for
}

/// Conversions are given out one by one, so that a process that answers slowly holds up nothing but
/// what it has. Which failure is named does not depend on the processes: no conversion behind one
/// that failed is given out, and all before it are.
void Converter::convert_by_processes(Wavefront& wave, Wavefront::Slot begin, Wavefront::Slot end) {
  std::uint64_t left = 0;
  for (Wavefront::Slot slot = begin; slot < end; ++slot)
    left += static_cast<std::uint64_t>(std::popcount(wave.todo(slot)));
  const std::uint64_t workers = std::min<std::uint64_t>(models_.size(), left);
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::mutex mutex;
  Wavefront::Slot slot = begin;
  DirectionMask todo = begin < end ? wave.todo(begin) : 0;
  std::uint64_t failed = kNone;  // a tag: 32 slot + direction
  std::string failure;

  const auto next = [&](Conversion& conversion, bool idle) {
    const std::lock_guard lock(mutex);
    // The last ones are for those that have nothing to do, not for a second place in a queue.
    if (left == 0 || (!idle && left < workers)) return false;
    while (todo == 0) todo = wave.todo(++slot);
    const int q = std::countr_zero(todo);
    const std::uint64_t tag = slot * 32 + static_cast<unsigned>(q);
    if (tag > failed) return false;
    todo &= todo - 1;
    --left;
    conversion = {wave.state(slot), box_.position(wave.point(slot)), wave.neighbourhood().shift(q),
                  wave.reached(slot, q), tag};
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
    failure = describe(box_, wave.point(failed / 32), wave.level(failed / 32)) + ", direction " +
              std::to_string(failed % 32) + ": " + error;
  };
  {
    std::vector<std::jthread> threads;
    try {
      for (std::uint64_t i = 1; i < workers; ++i)
        threads.emplace_back([&, i] { models_[i].convert(next, done); });
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

void Converter::convert(Wavefront& wave, Wavefront::Slot begin, Wavefront::Slot end) {
  if (models_.front().is_process()) return convert_by_processes(wave, begin, end);
  const std::size_t width = models_.front().row_size();
  // A unit is a direction of a slot: where there are few records, threads share one.
  const std::uint64_t last = end * kDirections;
  const std::uint64_t share = std::clamp<std::uint64_t>(
      (end - begin) * kDirections / (8 * models_.size()), 1, kMaxShare * kDirections);
  std::atomic<std::uint64_t> next{begin * kDirections};
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
      for (Wavefront::Slot slot = from / kDirections; slot * kDirections < to; ++slot) {
        const std::uint64_t first = slot * kDirections;
        DirectionMask left = wave.todo(slot);
        if (first < from) left &= kAllDirections << (from - first);
        if (first + kDirections > to) left &= (1u << (to - first)) - 1;
        if (left == 0) continue;
        const Vec3 x = box_.position(wave.point(slot));
        const double* state = wave.state(slot);
        const PointIndex point = wave.point(slot);
        const Level level = wave.level(slot);
        double* const reached = wave.reached(slot, 0);
        for (; left; left &= left - 1) {
          const int q = std::countr_zero(left);
          current = {point, level, q};
          if (!model.convert(state, x, wave.neighbourhood().shift(q), reached + q * width)) {
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

  if (models_.size() == 1 || begin == end) {
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
