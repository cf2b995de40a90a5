// A model as the tools use it: a plug-in that was found by its plain name, loaded, and created
// from a grid's parameters (Sect. 2.1 of the paper: C, the tolerance function, F).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/grid/spec.hpp"
#include "libcore/model/plugin.h"
#include "libcore/model/process_model.hpp"

namespace hapgrid {

/// Whether a model can have this name: only letters, digits, '-' and '_', so that it never is a
/// path.
bool is_plain(const std::string& name);

/// The directories in which plug-ins are looked for, in this order: `given` (--model-path), the
/// entries of the environment's HAPGRID_MODEL_PATH, then ../models beside the running program.
std::vector<std::filesystem::path> model_path(const std::vector<std::string>& given);

class Model;

/// Where models come from: a plug-in, or a command that the user allowed (process_source.hpp).
class ModelSource {
 public:
  virtual ~ModelSource() = default;
  /// "plug-in" or "process", for messages.
  virtual const char* kind() const = 0;
  /// One model of several that are used at a time, for one thread each; called by one thread.
  /// @throw ModelError when the model refuses the parameters or describes itself impossibly.
  virtual Model create(const std::vector<Parameter>& parameters) const = 0;
};

/// A loaded plug-in. Names come from shards, which are hostile: only letters, digits, '-' and '_'
/// are taken, so that a name never is a path.
class Plugin : public ModelSource {
 public:
  /// @throw ModelError when the name is not plain, no directory has NAME.so, or what is there is
  /// no plug-in of this interface version.
  Plugin(const std::string& name, const std::vector<std::filesystem::path>& directories);

  const std::string& name() const { return name_; }
  const std::string& summary() const { return summary_; }

  const char* kind() const override { return "plug-in"; }
  Model create(const std::vector<Parameter>& parameters) const override;

 private:
  friend class Model;
  std::string name_;
  std::string summary_;
  std::shared_ptr<void> library_;
  const hapgrid_model_table* table_ = nullptr;
};

/// One model, for one thread at a time. Movable; keeps its plug-in loaded.
class Model {
 public:
  /// One that is a process, or nothing but what a shard says of one.
  explicit Model(std::unique_ptr<ProcessModel> process);

  const hapgrid_model_info& info() const { return info_; }
  std::uint32_t state_size() const { return info_.state_size; }
  bool has_force() const { return table_->force != nullptr; }
  bool has_energy() const { return table_->energy != nullptr; }
  bool has_shape() const { return table_->shape != nullptr; }

  /// The states known a priori at x, row after row (count x n).
  /// @throw ModelError
  std::vector<double> known_states(const Vec3& x) const;

  /// What a grid of this model keeps beside each state, and how many numbers a row has with it
  /// (GridSpec says in which order).
  Stored stored() const;
  std::uint32_t row_size() const { return row_size_; }

  /// C(s, x, d), and what is stored with the state reached, into `row` (row_size() doubles).
  /// Answers whether it succeeded and every number is finite; error() then says what went wrong.
  /// No exception: this is the search's inner loop.
  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row);
  /// Fills in what is stored with the state at the beginning of `row`, for the HIP at x. As above.
  bool complete(const Vec3& x, double* row);
  /// What the last call that failed said.
  const std::string& error() const { return error_; }

  /// A process is asked for many conversions at once, and not for one after the other.
  bool is_process() const { return process_ != nullptr; }
  /// Of a process: all conversions that `next` gives, in its own order.
  void convert(const NextConversion& next, const ConversionDone& done) {
    process_->convert(next, done);
  }
  /// Of a process: says that nothing more will be asked, so that it ends while others still work.
  void hang_up() {
    if (process_) process_->hang_up();
  }
  /// The tolerance function in words, where the model has it in words.
  Equality equality() const { return process_ ? process_->description().equality : Equality{}; }

  /// The tolerance function. Real-time safe.
  bool equal(const double* a, const double* b) const {
    return table_->equal(model_.get(), a, b) != 0;
  }
  /// F(x, s) in newtons; needs has_force(). As real-time safe as the model.
  Vec3 force(const Vec3& x, const double* s) const {
    Vec3 f{0, 0, 0};
    table_->force(model_.get(), x.data(), s, f.data());
    return f;
  }
  /// The energy of state s with the HIP at x, in info().energy_unit; needs has_energy().
  double energy(const Vec3& x, const double* s) const {
    return table_->energy(model_.get(), x.data(), s);
  }
  /// The info().spheres spheres that show a state; empty without has_shape().
  std::vector<Sphere> spheres() const;
  /// The centres of the spheres in state s, x y z by sphere; needs has_shape().
  void shape(const double* s, std::span<float> centres) const {
    table_->shape(model_.get(), s, centres.data());
  }

 private:
  friend class Plugin;
  Model(const Plugin& plugin, hapgrid_model* model);

  std::shared_ptr<void> library_;  // declared first: outlives the model
  const hapgrid_model_table* table_;
  std::unique_ptr<hapgrid_model, void (*)(hapgrid_model*)> model_;
  ProcessModel* process_ = nullptr;  // what model_ is then
  hapgrid_model_info info_;
  std::uint32_t row_size_;
  std::vector<float> centres_;  // a shape on its way into a row
  std::string error_;
};

}  // namespace hapgrid
