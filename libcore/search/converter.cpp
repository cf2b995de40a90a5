#include "libcore/search/converter.hpp"

#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

thread_local CurrentConversion current;

}  // namespace

/// Hands out the numbers [0, items) in ascending order, and remembers the first item that failed.
/// Which one that is does not depend on the threads: no item behind a failed one is handed out, and
/// all items before it are.
class Converter::WorkQueue {
 public:
  /// Items [next, end) that one thread has taken and not begun yet.
  struct Slice {
    std::uint64_t next = 0;
    std::uint64_t end = 0;
    bool is_empty() const { return next == end; }
  };

  /// @param slice items that a thread takes at a time, at least 1
  WorkQueue(std::uint64_t items, std::size_t models, std::uint64_t slice, const Progress& progress)
      : progress_(progress),
        slice_(slice),
        threads_(static_cast<std::size_t>(std::min<std::uint64_t>(models, items))),
        left_{0, items} {}

  /// How many of the models have something to do.
  std::size_t threads() const { return threads_; }

  /// The next item of `mine`, which is filled again when it is empty. False when the work is over,
  /// or when the last items are kept for models that are idle.
  bool next(Slice& mine, bool idle, std::uint64_t& item) {
    if (progress_.stopped() || (mine.is_empty() && !refill(mine, idle))) return false;
    if (mine.next > failed_.load(std::memory_order_relaxed)) return false;
    item = mine.next++;
    return true;
  }

  void fail(std::uint64_t item, std::string_view why) {
    const std::lock_guard lock(mutex_);
    if (item >= failed_) return;
    failed_ = item;
    why_ = why;
  }

  /// Hands out nothing more.
  void stop() {
    const std::lock_guard lock(mutex_);
    left_.next = left_.end;
  }

  /// @param describe says what an item is
  /// @throw Stopped; ModelError for the first item that failed
  template <class Describe>
  void require_success(const Describe& describe) const {
    if (progress_.stopped()) throw Stopped();
    if (failed_ != kNone) throw ModelError(format("{}: {}", describe(failed_), why_));
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  bool refill(Slice& mine, bool idle) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t left = left_.end - left_.next;
    // The last items are for models that have nothing to do, not for a second place in a queue.
    if (left == 0 || (!idle && left < threads_)) return false;
    mine.next = left_.next;
    mine.end = left_.next += std::min(slice_, left);
    return true;
  }

  const Progress& progress_;
  std::uint64_t slice_;
  std::size_t threads_;
  std::mutex mutex_;
  Slice left_;
  std::atomic<std::uint64_t> failed_{kNone};
  std::string why_;
};

std::unique_ptr<Model> create_model(const ModelSource& source, const GridSpec& spec) {
  std::unique_ptr<Model> model = source.create(spec.parameters, spec.stored);
  ModelDescription said = model->info();
  // These are for people and pictures, and change no record.
  said.length_unit = spec.length_unit;
  said.energy_unit = spec.energy_unit;
  said.hip_radius = spec.hip_radius;
  said.force_scale = spec.force_scale;
  if (const std::string found = difference(said, spec); !found.empty())
    throw ModelError(
        format("model {}: it and the grid differ in {}; was the {} changed since the grid was "
               "seeded?",
               spec.model, found, source.kind()));
  return model;
}

Converter::Converter(const ModelSource& source, const GridSpec& spec, unsigned threads,
                     Progress& progress)
    : neighbourhood_(spec.box), box_(spec.box), progress_(progress) {
  models_ = make_models([&] { return create_model(source, spec); }, static_cast<int>(threads));
}

Converter::Converter(std::unique_ptr<Model> model, const GridSpec& spec, Progress& progress)
    : neighbourhood_(spec.box), box_(spec.box), progress_(progress) {
  models_.push_back(std::move(model));
}

std::unique_ptr<Model> Converter::take_model() {
  std::unique_ptr<Model> model = std::move(models_.back());
  models_.clear();
  return model;
}

Converter::~Converter() {
  for (const auto& model : models_) model->hang_up();  // before the first of them is waited for
}

CurrentConversion& current_conversion() noexcept { return current; }

void Converter::make_conversions(Batch& batch, WorkQueue& queue, Model& model) {
  const std::size_t width = model.row_size();
  const bool is_process = model.is_process();
  WorkQueue::Slice mine;
  std::size_t record = batch.size();  // that the next three belong to
  Vec3 x{};
  const double* state = nullptr;
  double* reached = nullptr;
  std::uint64_t made = 0;  // and not counted yet
  const auto count = [&] {
    progress_.conversions.fetch_add(made, std::memory_order_relaxed);
    progress_.frontier_done.fetch_add(std::exchange(made, 0), std::memory_order_relaxed);
  };
  const auto next = [&](Conversion& conversion, bool idle) {
    if (mine.is_empty()) count();
    std::uint64_t item = 0;
    if (!queue.next(mine, idle, item)) return false;
    const auto [i, q] = batch.conversion(item);
    if (record != i) {
      record = i;
      const FrontierRecord& from = batch.record(i);
      x = box_.position(from.point);
      state = from.state;
      reached = batch.reached(i);
      if (!is_process) current = {from.point, from.level, -1};
    }
    if (!is_process) current.q = q;
    conversion = {state, x, neighbourhood_.shift(q), reached + q * width, item};
    return true;
  };
  const auto done = [&](const Conversion& conversion, std::string_view error) {
    if (!error.empty()) return queue.fail(conversion.tag, error);
    ++made;
  };
  if (is_process) {
    model.convert_all(next, done);
  } else {
    // The inner loop of the search: convert_all() would add two indirect calls to each conversion.
    for (Conversion c; next(c, true);)
      done(c, model.convert(c.s, c.x, c.d, c.row) ? std::string_view() : model.error());
  }
  current.q = -1;
  count();
}

void Converter::run(Batch& batch, WorkQueue& queue) {
  const auto guarded = [&](std::size_t k) {
    try {
      make_conversions(batch, queue, *models_[k]);
    } catch (...) {  // nobody waits for the work of the others
      queue.stop();
      throw;
    }
  };
  std::vector<std::future<void>> others;
  for (std::size_t k = 1; k < queue.threads(); ++k) try {
      others.push_back(std::async(std::launch::async, guarded, k));
    } catch (const std::system_error& e) {
      queue.stop();
      throw Error(
          format("thread {} of {} cannot be started: {}; have fewer (-j), or raise the limit "
                 "(ulimit -u)",
                 k + 1, queue.threads(), e.code().message()));
    }
  if (queue.threads() > 0) guarded(0);
  for (std::future<void>& other : others) other.get();
}

void Converter::convert(Batch& batch) {
  // Long enough to make taking a slice cheap, short enough that the last ones do not wait for a
  // single thread. Of a process, an answer that takes long holds up nothing else.
  constexpr std::uint64_t kMaxSlice = 16 * kDirections;
  const std::uint64_t slice =
      models_.front()->is_process()
          ? 1
          : std::clamp<std::uint64_t>(batch.conversions() / (8 * models_.size()), 1, kMaxSlice);
  WorkQueue queue(batch.conversions(), models_.size(), slice, progress_);
  run(batch, queue);
  queue.require_success([&](std::uint64_t item) {
    const auto [i, q] = batch.conversion(item);
    return format("conversion at {}, direction {}",
                  describe(box_, batch.record(i).point, batch.record(i).level), q);
  });
}

}  // namespace hapgrid
