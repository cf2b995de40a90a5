// Evaluating the conversion function for many records at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/batch.hpp"

namespace hapgrid {

/// What a search has done so far. Another thread may read it meanwhile, to show it.
struct Progress {
  std::atomic<std::uint64_t> conversions{0};           ///< done in this run
  std::atomic<std::uint64_t> frontier_conversions{0};  ///< asked for by the current frontier
  std::atomic<std::uint64_t> frontier_done{0};         ///< of these, done
  std::atomic<std::uint64_t> frontier_records{0};
  std::atomic<std::uint64_t> records{0};  ///< records of the grid so far
  std::atomic<std::uint32_t> generation{0};
  std::atomic<std::uint64_t> links{0};             ///< whose tear fractions are asked for
  std::atomic<std::uint64_t> links_done{0};        ///< of these, done
  std::atomic<std::uint64_t> tear_conversions{0};  ///< made for them; not among `conversions`
  /// Whether the work is to end soon. Null: it goes on to its end. A signal's handler may set it.
  const std::atomic<int>* stop = nullptr;

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed) != 0; }
};

/// Thrown out of work that Progress::stop has ended.
class Stopped : public Error {
 public:
  explicit Stopped(const std::string& what_is_kept = "") : Error("interrupted" + what_is_kept) {}
};

/// What a thread has asked its plug-in for, so that a crash handler can name it.
struct CurrentConversion {
  PointIndex point = 0;
  Level level = 0;
  int q = -1;  ///< -1: nothing
};
/// Of the calling thread. May be called in a signal's handler.
CurrentConversion& current_conversion() noexcept;

/// Each thread has a model of its own; the answers do not depend on how many threads there are.
class Converter {
 public:
  /// @param threads >= 1. @throw ModelError when the model refuses the spec's parameters, or says
  /// other things of itself than the grid's header (state size, tolerance function, what is
  /// stored).
  Converter(const ModelSource& source, const GridSpec& spec, unsigned threads, Progress& progress);
  ~Converter();

  /// Computes all conversions of a batch. @throw Stopped;
  /// ModelError naming point, level and direction of the first that failed.
  void convert(Batch& batch);

  /// Calls work(model) for `threads` of the models, each in a thread of its own. When a thread
  /// cannot be started, it calls stop() and throws what the system says.
  void work(std::uint64_t threads, const std::function<void(Model&)>& work,
            const std::function<void()>& stop);
  std::size_t models() const { return models_.size(); }
  /// A model for the caller's own thread, between calls of convert().
  const Model& model() const { return *models_.front(); }

 private:
  class Dealer;
  struct Stretch;

  // What one thread does.
  void ask_plugin(Batch& batch, Dealer& dealer, Model& model);
  void ask_process(Batch& batch, Dealer& dealer, Model& model);
  void count(Stretch& stretch);

  Neighbourhood neighbourhood_;
  Box box_;
  std::vector<std::unique_ptr<Model>> models_;
  Progress& progress_;
};

/// A model that fits the header of a grid.
/// @throw ModelError as the Converter does.
std::unique_ptr<Model> create_model(const ModelSource& source, const GridSpec& spec);

}  // namespace hapgrid
