// A model as the tools use it (Sect. 2.1 of the paper: C, the tolerance function, F). Behind it
// stands a plug-in (plugin_model.hpp) or a process (process_model.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// Whether a model can have this name: only letters, digits, '-' and '_' are allowed, so that a
/// name is never a path.
bool is_valid_name(const std::string& name);

/// The most questions that a process may have at a time.
inline constexpr std::uint32_t kMaxInFlight = 1024;

/// What a model says of itself.
struct ModelInfo : ModelDescription {
  double d_max = 0;               ///< conversions are defined for |d| up to this
  std::uint32_t in_flight = 0;    ///< questions that a process wants at a time; 0: it does not say
  std::uint32_t processes = 0;    ///< the most models that may work side by side; 0: any number
  std::vector<Torsion> torsions;  ///< of the spheres

  /// @throw ModelError when a number is out of its range.
  void validate() const;
  friend bool operator==(const ModelInfo&, const ModelInfo&) = default;
};

/// @throw ModelError when no model can have a shape of so many spheres.
void require_possible_shape(std::size_t spheres);

/// A conversion to be made: C(s, x, d) into `row`. The caller keeps what the pointers point to
/// until the conversion is done.
struct Conversion {
  const double* s = nullptr;
  Vec3 x{};
  Vec3 d{};
  double* row = nullptr;
  std::uint64_t tag = 0;  ///< the caller's own
};
/// Fills in the next conversion and returns true. `idle` says that the model has nothing to do.
/// Returns false when no conversion is left, or when the last ones are kept for idle models; the
/// caller then asks again after its next answer.
using NextConversion = std::function<bool(Conversion&, bool idle)>;
/// Is called with each conversion that is done, in any order. `error` is one line, and empty after
/// success.
using ConversionDone = std::function<void(const Conversion&, std::string_view error)>;

/// One model, for one thread at a time. This class itself is a model process as it describes
/// itself: it can only compare states, and no process is started.
class Model {
 public:
  explicit Model(ModelInfo info) : info_(std::move(info)), row_size_(info_.row_size()) {}
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const ModelInfo& info() const { return info_; }
  std::uint32_t state_size() const { return info_.state_size; }
  /// How many numbers a grid of this model keeps for each state (GridSpec says in which order).
  std::uint32_t row_size() const { return row_size_; }
  /// Whether answers come from a process: slowly, and several at a time.
  bool is_process() const { return info_.equality.is_declared(); }

  /// The states known a priori at x, one after the other (count x n doubles).
  /// @throw ModelError
  virtual std::vector<double> known_states(const Vec3& x);
  /// Writes C(s, x, d), and what is stored with the state reached, into `row` (row_size() doubles).
  /// Returns whether it succeeded and every number is finite. After a failure error() says what
  /// went wrong. It throws nothing, because this is the inner loop of the search.
  virtual bool convert(const double* s, const Vec3& x, const Vec3& d, double* row);
  /// Makes all conversions that `next` gives.
  virtual void convert_all(const NextConversion& next, const ConversionDone& done);
  /// Fills in what is stored with the state at the beginning of `row`, for the HIP at x. Returns
  /// the same as convert().
  virtual bool complete(const Vec3& x, double* row);
  /// The message of the last call that failed.
  const std::string& error() const { return error_; }
  /// Tells the model that no question follows: a process can then end while others still work.
  virtual void hang_up() {}
  /// Makes the current and all later questions to a process fail within 0.1 s. May be called by any
  /// thread.
  virtual void abandon() noexcept {}

  /// Resident bytes of the program that the model runs in; 0 where they are not known.
  virtual std::uint64_t memory_bytes() const;

  /// The tolerance function. Real-time safe.
  virtual bool equal(const double* a, const double* b) const;

  /// Whether the model can be asked for them in the haptic loop. A process cannot.
  virtual bool has_force() const { return false; }
  virtual bool has_energy() const { return false; }
  virtual bool has_shape() const { return false; }
  virtual bool has_own_energy() const { return false; }
  /// Whether the model can check its parameters. check() returns one line for each problem.
  virtual bool has_check() const { return false; }
  virtual std::vector<std::string> check() { return {}; }
  /// F(x, s) in newtons; needs has_force(). As real-time safe as the model.
  virtual Vec3 force(const Vec3& x, const double* s) const;
  /// The energy of state s with the HIP at x, in info().energy_unit; needs has_energy().
  virtual double energy(const Vec3& x, const double* s) const;
  /// The energy of state s alone, without the HIP; needs has_own_energy().
  virtual double own_energy(const double* s) const;
  /// The centres of info().spheres in state s with the HIP at x, x y z by sphere; needs
  /// has_shape().
  virtual void shape(const Vec3& x, const double* s, std::span<float> centres) const;

 protected:
  std::string error_;

 private:
  ModelInfo info_;
  std::uint32_t row_size_;
};

using MakeModel = std::function<std::unique_ptr<Model>()>;

/// A model for each of `threads`, or for fewer where no more may work side by side.
std::vector<std::unique_ptr<Model>> make_models(const MakeModel& make_model, int threads);

/// Where models come from: a plug-in, or a command that the user allowed.
class ModelSource {
 public:
  virtual ~ModelSource() = default;
  /// "plug-in" or "process", for messages.
  virtual const char* kind() const = 0;
  /// Makes a model for one thread. All calls of create() come from one thread.
  /// @param store what the model shall store with each state, beside what it stores by itself.
  /// @throw ModelError when the model refuses the parameters, cannot store that, or describes
  /// itself with impossible numbers.
  virtual std::unique_ptr<Model> create(const std::vector<Parameter>& parameters,
                                        const Stored& store) const = 0;
  std::unique_ptr<Model> create(const std::vector<Parameter>& parameters) const {
    return create(parameters, {});
  }
};

/// A model process as the header of a grid describes it.
std::unique_ptr<Model> declared_model(const GridSpec& spec);

}  // namespace hapgrid
