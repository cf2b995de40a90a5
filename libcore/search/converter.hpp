// Evaluating the conversion function for many records at once.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// What a search has done so far. Another thread may read it meanwhile, to show it.
struct Progress {
  std::atomic<std::uint64_t> conversions{0};           ///< done in this run
  std::atomic<std::uint64_t> frontier_conversions{0};  ///< asked for by the current frontier
  std::atomic<std::uint64_t> frontier_done{0};         ///< of these, done
  std::atomic<std::uint64_t> frontier_records{0};
  std::atomic<std::uint64_t> records{0};  ///< records of the grid so far
  std::atomic<std::uint64_t> points{0};   ///< points that have one
  std::atomic<std::uint32_t> generation{0};
  /// Not 0 when the work must end soon. Null when nothing stops it. A signal's handler may set it.
  const std::atomic<int>* stop = nullptr;

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed) != 0; }
};

/// Thrown by work that Progress::stop has ended.
class Stopped : public Error {
 public:
  explicit Stopped(const std::string& what_is_kept = "") : Error("interrupted" + what_is_kept) {}
};

/// A record, and conversions from it: those that are asked for, or were made.
struct FrontierRecord {
  PointIndex point = 0;
  Level level = 0;
  const double* state = nullptr;
  DirectionMask todo = 0;  ///< the directions
};

/// Records with the directions to be expanded, and room for what each conversion reaches. There are
/// enough records to keep the threads busy, and so few that the rows reached stay near the caches.
class Batch {
 public:
  /// One conversion: the number of a record in the batch, and a direction.
  using Item = std::pair<std::uint16_t, std::uint16_t>;

  explicit Batch(const GridSpec& spec)
      : n_(spec.state_size),
        row_size_(spec.row_size()),
        capacity_(std::clamp<std::size_t>(kBytes / (sizeof(double) * kDirections * row_size_), 1,
                                          kMaxRecords)),
        records_(std::make_unique_for_overwrite<FrontierRecord[]>(capacity_)),
        states_(std::make_unique_for_overwrite<double[]>(capacity_ * n_)),
        reached_(std::make_unique_for_overwrite<double[]>(capacity_ * kDirections * row_size_)),
        items_(std::make_unique_for_overwrite<Item[]>(capacity_ * kDirections)) {}

  std::size_t size() const { return size_; }
  bool is_full() const { return size_ == capacity_; }
  void clear() { size_ = count_ = 0; }

  /// Adds a record to a batch that is not full, and keeps a copy of its state.
  void add(const FrontierRecord& record) {
    double* const state = &states_[size_ * n_];
    std::copy_n(record.state, n_, state);
    records_[size_] = {record.point, record.level, state, record.todo};
    for (DirectionMask left = record.todo; left; left &= left - 1)
      items_[count_++] = {static_cast<std::uint16_t>(size_),
                          static_cast<std::uint16_t>(std::countr_zero(left))};
    ++size_;
  }

  const FrontierRecord& record(std::size_t i) const { return records_[i]; }
  /// What the conversions of a record reach: 26 rows of row_size() numbers.
  double* reached(std::size_t i) { return &reached_[i * kDirections * row_size_]; }

  /// The conversions of all records, ascending by (record, direction).
  std::size_t conversions() const { return count_; }
  Item conversion(std::size_t c) const { return items_[c]; }

 private:
  static constexpr std::size_t kBytes = 8 << 20;
  static constexpr std::size_t kMaxRecords = 2048;

  std::uint32_t n_;
  std::uint32_t row_size_;
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::size_t count_ = 0;  // conversions
  // Not initialised: a small frontier touches little of it.
  std::unique_ptr<FrontierRecord[]> records_;
  std::unique_ptr<double[]> states_;   // capacity x n
  std::unique_ptr<double[]> reached_;  // capacity x 26 x row_size
  std::unique_ptr<Item[]> items_;      // capacity x 26
};

/// The conversion that the plug-in of a thread is making, so that a crash handler can name it.
struct CurrentConversion {
  PointIndex point = 0;
  Level level = 0;
  int q = -1;                   ///< -1: the plug-in makes no conversion
  const char* while_what = "";  ///< more for the message, with a blank before it
};
/// Of the calling thread. May be called in a signal's handler.
CurrentConversion& current_conversion() noexcept;

/// Each thread has a model of its own; the answers do not depend on how many threads there are.
class Converter {
 public:
  /// @param threads >= 1. @throw ModelError when the model refuses the spec's parameters, or
  /// describes itself otherwise than the grid's header does (state size, tolerance function, what
  /// is stored).
  Converter(const ModelSource& source, const GridSpec& spec, unsigned threads, Progress& progress);
  /// With one model, which is there already.
  Converter(std::unique_ptr<Model> model, const GridSpec& spec, Progress& progress);
  ~Converter();
  /// Gives its one model back. It converts nothing afterwards.
  std::unique_ptr<Model> take_model();

  /// Computes all conversions of a batch. @throw Stopped;
  /// ModelError naming point, level and direction of the first that failed.
  void convert(Batch& batch);

  std::size_t models() const { return models_.size(); }
  /// A model for the caller's own thread, between calls of convert().
  const Model& model() const { return *models_.front(); }

 private:
  class WorkQueue;
  /// Makes the conversions in as many threads as `queue` has work for. When one of them throws, or
  /// cannot be started, the queue is stopped.
  /// @throw Error when a thread cannot be started; what the others throw, when all have ended
  void run(Batch& batch, WorkQueue& queue);
  /// What one thread does.
  void make_conversions(Batch& batch, WorkQueue& queue, Model& model);

  Neighbourhood neighbourhood_;
  Box box_;
  std::vector<std::unique_ptr<Model>> models_;
  Progress& progress_;
};

/// A model that fits the header of a grid.
/// @throw ModelError as the Converter does.
std::unique_ptr<Model> create_model(const ModelSource& source, const GridSpec& spec);

}  // namespace hapgrid
