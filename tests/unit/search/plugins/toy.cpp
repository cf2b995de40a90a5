// toy.hpp as a plug-in. Parameters: those of toy::Toy; `milliseconds` (0) that a conversion takes;
// `d_max` (2); `fail` (-1): convert() fails at points whose x has this value. It knows the state
// 0 0 0 ... everywhere.
#include "tests/unit/search/toy.hpp"

#include <chrono>
#include <cstdio>
#include <thread>

#include "libcore/model/plugin.hpp"

namespace {

class ToyModel {
 public:
  explicit ToyModel(hapgrid::PluginParameters& parameters)
      : milliseconds_(parameters.number("milliseconds", 0)),
        d_max_(parameters.number("d_max", 2)),
        fail_(parameters.number("fail", -1)) {
    toy_.state_size = static_cast<std::uint32_t>(parameters.number("state_size", 1));
    toy_.salt = static_cast<std::uint64_t>(parameters.number("salt", 0));
    toy_.amplitude = parameters.number("amplitude", 1);
    toy_.tolerance = parameters.number("tolerance", 0.25);
    toy_.memory = parameters.number("memory", 1);
    parameters.finish();
  }
  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = toy_.state_size;
    info.d_max = d_max_;
    info.tolerance = toy_.tolerance;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "turns");
    return info;
  }
  std::vector<double> known_states(const double*) const {
    return std::vector<double>(toy_.state_size, 0.0);
  }
  void convert(const double* s, const double* x, const double* d, double* result) const {
    if (x[0] == fail_) throw std::runtime_error("told to fail");
    if (milliseconds_ > 0)
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(milliseconds_));
    toy::convert(toy_, s, x, d, result);
  }
  bool equal(const double* a, const double* b) const { return toy::equal(toy_, a, b); }

 private:
  toy::Toy toy_;
  double milliseconds_;
  double d_max_;
  double fail_;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(ToyModel, "no physics: states depend on the way")
