#include "libcore/search/converter.hpp"

#include <algorithm>
#include <mutex>
#include <string>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {
// A thread takes this many records at a time at most: enough to make taking them cheap, few enough
// that the last ones do not wait for a single thread.
constexpr std::uint64_t kMaxShare = 16;
}  // namespace

Model create_model(const Plugin& plugin, const GridSpec& spec) {
  Model model = plugin.create(spec.parameters);
  const hapgrid_model_info& info = model.info();
  if (info.state_size != spec.state_size)
    throw ModelError("model " + spec.model + ": states of " + std::to_string(info.state_size) +
                     " components, the grid has " + std::to_string(spec.state_size) +
                     "; was the plug-in changed since the grid was seeded?");
  if (info.tolerance != spec.tolerance || spec.tolerance_unit != info.tolerance_unit)
    throw ModelError("model " + spec.model +
                     ": another tolerance than the grid's; was the plug-in changed since the grid "
                     "was seeded?");
  return model;
}

Converter::Converter(const Plugin& plugin, const GridSpec& spec, unsigned threads,
                     Progress& progress)
    : box_(spec.box), progress_(progress) {
  for (unsigned i = 0; i < std::max(threads, 1u); ++i)
    models_.push_back(create_model(plugin, spec));
}

void Converter::convert(Wavefront& wave, Wavefront::Slot begin, Wavefront::Slot end) {
  const std::uint64_t count = end - begin;
  const std::uint64_t share = std::clamp<std::uint64_t>(count / (8 * models_.size()), 1, kMaxShare);
  std::atomic<Wavefront::Slot> next{begin};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::string failure;
  Wavefront::Slot failed = end;

  const auto work = [&](Model& model) {
    while (!stop.load(std::memory_order_relaxed)) {
      const Wavefront::Slot from = next.fetch_add(share);
      if (from >= end) return;
      std::uint64_t done = 0;
      for (Wavefront::Slot slot = from; slot < std::min(from + share, end); ++slot) {
        const Vec3 x = box_.position(wave.point(slot));
        const double* state = wave.state(slot);
        for (DirectionMask left = wave.todo(slot); left; left &= left - 1) {
          const int q = std::countr_zero(left);
          if (!model.convert(state, x, wave.neighbourhood().shift(q), wave.reached(slot, q))) {
            stop = true;
            const std::lock_guard lock(mutex);
            if (slot < failed) {
              failed = slot;
              failure = describe(box_, wave.point(slot), wave.level(slot)) + ", direction " +
                        std::to_string(q) + ": " + model.error();
            }
            return;
          }
          ++done;
        }
      }
      progress_.conversions.fetch_add(done, std::memory_order_relaxed);
      progress_.frontier_done.fetch_add(done, std::memory_order_relaxed);
    }
  };

  if (models_.size() == 1 || count == 1) {
    work(models_.front());
  } else {
    std::vector<std::jthread> threads;
    for (Model& model : models_) threads.emplace_back([&work, &model] { work(model); });
  }
  if (failed != end) throw ModelError("conversion at " + failure);
}

}  // namespace hapgrid
