#include "libcore/search/converter.hpp"

#include <algorithm>
#include <bit>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

thread_local CurrentConversion current;

}  // namespace

/// Conversions of a batch that one thread makes: `count` of them, from those that `todo` leaves of
/// record `i` on.
struct Converter::Stretch {
  std::size_t i = 0;
  DirectionMask todo = 0;
  std::uint64_t count = 0;
  std::uint64_t done = 0;
};

/// Deals out the conversions of a batch in ascending order, and remembers the first that failed.
/// Which one that is does not depend on the threads: no conversion behind one that failed is given
/// out, and all before it are.
class Converter::Dealer {
 public:
  Dealer(const Batch& batch, std::size_t models, bool one_by_one, const Progress& progress)
      : batch_(batch), progress_(progress) {
    for (std::size_t i = 0; i < batch.size(); ++i)
      left_ += static_cast<std::uint64_t>(std::popcount(batch.todo(i)));
    threads_ = std::min<std::uint64_t>(models, left_);
    if (batch.size() > 0) rest_.todo = batch.todo(0);
    // Long enough to make taking one cheap, short enough that the last ones do not wait for a
    // single thread. Of a process, an answer that takes long holds up nothing else.
    constexpr std::uint64_t kMaxStretch = 16 * kDirections;
    if (!one_by_one) stretch_ = std::clamp<std::uint64_t>(left_ / (8 * models), 1, kMaxStretch);
  }

  std::uint64_t threads() const { return threads_; }

  /// Steps to the next conversion, a tag that names(), or answers false.
  bool next(Stretch& mine, bool idle, std::uint64_t& tag) {
    if (progress_.stopped() || (mine.count == 0 && !take(mine, idle))) return false;
    while (mine.todo == 0) mine.todo = batch_.todo(++mine.i);
    tag = mine.i * 32 + static_cast<unsigned>(std::countr_zero(mine.todo));
    if (tag > failed_.load(std::memory_order_relaxed)) return false;
    mine.todo &= mine.todo - 1;
    --mine.count;
    return true;
  }

  void fail(std::uint64_t tag, std::string_view why) {
    const std::lock_guard lock(mutex_);
    if (tag >= failed_) return;
    failed_ = tag;
    why_ = why;
  }
  /// Gives out nothing more.
  void stop() {
    const std::lock_guard lock(mutex_);
    left_ = 0;
  }
  /// @throw Stopped; ModelError for the first conversion that failed
  void require_success(const Box& box) const {
    if (progress_.stopped()) throw Stopped();
    if (failed_ == kNone) return;
    throw ModelError("conversion at " +
                     describe(box, batch_.point(failed_ / 32), batch_.level(failed_ / 32)) +
                     ", direction " + std::to_string(failed_ % 32) + ": " + why_);
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  bool take(Stretch& mine, bool idle) {
    const std::lock_guard lock(mutex_);
    // The last ones are for models that have nothing to do, not for a second place in a queue.
    if (left_ == 0 || (!idle && left_ < threads_)) return false;
    mine.i = rest_.i;
    mine.todo = rest_.todo;
    mine.count = std::min(stretch_, left_);
    left_ -= mine.count;
    for (std::uint64_t skip = mine.count; left_ > 0 && skip > 0;) {
      const auto here = static_cast<std::uint64_t>(std::popcount(rest_.todo));
      if (here > skip) {
        for (; skip > 0; --skip) rest_.todo &= rest_.todo - 1;
      } else {
        skip -= here;
        rest_.todo = batch_.todo(++rest_.i);
      }
    }
    return true;
  }

  const Batch& batch_;
  const Progress& progress_;
  std::uint64_t stretch_ = 1;
  std::uint64_t threads_ = 0;
  std::mutex mutex_;
  std::uint64_t left_ = 0;
  Stretch rest_;
  std::atomic<std::uint64_t> failed_{kNone};  // a tag: 32 i + direction
  std::string why_;
};

std::unique_ptr<Model> create_model(const ModelSource& source, const GridSpec& spec) {
  std::unique_ptr<Model> model = source.create(spec.parameters, spec.stored);
  const ModelInfo& info = model->info();
  const auto require = [&](bool same, const std::string& what) {
    if (!same)
      throw ModelError("model " + spec.model + ": " + what + "; was the " + source.kind() +
                       " changed since the grid was seeded?");
  };
  require(info.state_size == spec.state_size, "states of " + std::to_string(info.state_size) +
                                                  " components, the grid has " +
                                                  std::to_string(spec.state_size));
  require(info.tolerance == spec.tolerance && info.tolerance_unit == spec.tolerance_unit,
          "another tolerance than the grid's");
  require(info.equality == spec.equality, "another tolerance function than the grid's");
  require(info.stored == spec.stored && (!spec.stored.shape || info.spheres == spec.spheres),
          "keeps other forces or shapes with its states than the grid does");
  return model;
}

Converter::Converter(const ModelSource& source, const GridSpec& spec, unsigned threads,
                     Progress& progress)
    : neighbourhood_(spec.box), box_(spec.box), progress_(progress) {
  for (unsigned i = 0; i < std::max(threads, 1u); ++i)
    models_.push_back(create_model(source, spec));
}

Converter::~Converter() {
  for (const auto& model : models_) model->hang_up();  // before the first of them is waited for
}

CurrentConversion& current_conversion() noexcept { return current; }

void Converter::count(Stretch& stretch) {
  progress_.conversions.fetch_add(stretch.done, std::memory_order_relaxed);
  progress_.frontier_done.fetch_add(std::exchange(stretch.done, 0), std::memory_order_relaxed);
}

/// This is the search's inner loop: it has no calls but the dealer's, inlined, and the model's.
void Converter::ask_plugin(Batch& batch, Dealer& dealer, Model& model) {
  const std::size_t width = model.row_size();
  Stretch mine;
  std::size_t record = batch.size();  // that the next three belong to
  const double* state = nullptr;
  Vec3 x{};
  double* reached = nullptr;
  for (std::uint64_t tag = 0; dealer.next(mine, true, tag);) {
    if (record != mine.i) {
      record = mine.i;
      state = batch.state(record);
      x = box_.position(batch.point(record));
      reached = batch.reached(record);
      current = {batch.point(record), batch.level(record), -1};
    }
    const auto q = static_cast<unsigned>(tag % 32);
    current.q = static_cast<int>(q);
    if (model.convert(state, x, neighbourhood_.shift(current.q), reached + q * width))
      ++mine.done;
    else
      dealer.fail(tag, model.error());
    if (mine.count == 0) count(mine);
  }
  current.q = -1;
  count(mine);
}

void Converter::ask_process(Batch& batch, Dealer& dealer, Model& model) {
  const std::size_t width = model.row_size();
  Stretch mine;
  model.convert_all(
      [&](Conversion& conversion, bool idle) {
        std::uint64_t tag = 0;
        if (!dealer.next(mine, idle, tag)) return false;
        const auto q = static_cast<unsigned>(tag % 32);
        conversion = {batch.state(mine.i), box_.position(batch.point(mine.i)),
                      neighbourhood_.shift(static_cast<int>(q)), batch.reached(mine.i) + q * width,
                      tag};
        return true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        if (!error.empty()) return dealer.fail(conversion.tag, error);
        mine.done = 1;
        count(mine);
      });
}

void Converter::work(std::uint64_t threads, const std::function<void(Model&)>& work,
                     const std::function<void()>& stop) {
  std::vector<std::jthread> others;
  try {
    for (std::uint64_t k = 1; k < threads; ++k) others.emplace_back([&, k] { work(*models_[k]); });
  } catch (...) {  // nobody waits for the work of the others
    stop();
    throw;
  }
  if (threads > 0) work(*models_.front());
}

void Converter::convert(Batch& batch) {
  const bool is_process = models_.front()->is_process();
  Dealer dealer(batch, models_.size(), is_process, progress_);
  work(
      dealer.threads(),
      [&](Model& model) {
        is_process ? ask_process(batch, dealer, model) : ask_plugin(batch, dealer, model);
      },
      [&] { dealer.stop(); });
  dealer.require_success(box_);
}

}  // namespace hapgrid
