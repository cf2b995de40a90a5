// Evaluating the conversion function for many records at once.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/search/batch.hpp"
#include "libcore/search/progress.hpp"
#include "libcore/search/work_queue.hpp"

namespace hapgrid {

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

  /// Calls work(model) for as many models as `queue` has work for, each in a thread of its own.
  /// When one of them throws, or cannot be started, the queue is stopped.
  /// @throw Error when a thread cannot be started; what `work` throws, when all threads have ended
  void run(WorkQueue& queue, const std::function<void(Model&)>& work);
  std::size_t models() const { return models_.size(); }
  /// A model for the caller's own thread, between calls of convert().
  const Model& model() const { return *models_.front(); }

 private:
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
