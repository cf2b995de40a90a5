// What a plug-in in C++ includes: it writes a class and one macro line, and the table of plugin.h
// is filled from the class. Header-only, so that a plug-in links nothing of hapgrid.
//
//   class Spring {
//    public:
//     explicit Spring(hapgrid::PluginParameters& parameters);   // throws std::exception
//     hapgrid_model_info info() const;
//     std::vector<double> known_states(const double* x) const;  // states row after row
//     void convert(const double* s, const double* x, const double* d, double* result);
//     bool equal(const double* a, const double* b) const;
//     void force(const double* x, const double* s, double* f);  // each may be left out
//     double energy(const double* x, const double* s);
//     void spheres(hapgrid_sphere* spheres) const;                // both or none
//     void shape(const double* s, float* centres);                // or shape(x, s, centres)
//     double own_energy(const double* s);
//     void torsions(hapgrid_torsion* torsions) const;
//     std::vector<std::string> check();
//     void periods(double* periods) const;  // angles and orientations among the components of s
//   };
//   HAPGRID_MODEL_PLUGIN(Spring, "a mass on a spring")
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin.h"  // the two lie side by side, here and in <hapgrid/>

namespace hapgrid {

/// The parameters as a constructor reads them: each key is asked for once, and finish() refuses
/// the keys that nobody asked for.
class PluginParameters {
 public:
  PluginParameters(const hapgrid_parameter* parameters, std::size_t count)
      : parameters_(parameters), count_(count) {}

  /// Whether the definition gives the key, with any type.
  bool has(const std::string& key) {
    asked_.insert(key);
    return std::any_of(parameters_, parameters_ + count_,
                       [&](const hapgrid_parameter& p) { return key == p.key; });
  }
  /// @throw std::runtime_error when the key is there with another type.
  double number(const std::string& key, double default_value) {
    const hapgrid_parameter* p = find(key, HAPGRID_NUMBER, "a number");
    return p ? p->numbers[0] : default_value;
  }
  /// A number > 0. @throw std::runtime_error when it is not.
  double positive(const std::string& key, double default_value) {
    const double value = number(key, default_value);
    if (!(value > 0)) throw std::runtime_error("parameter " + key + " must be positive");
    return value;
  }
  bool boolean(const std::string& key, bool default_value) {
    const hapgrid_parameter* p = find(key, HAPGRID_BOOLEAN, "true or false");
    return p ? p->numbers[0] != 0 : default_value;
  }
  std::string text(const std::string& key, const std::string& default_value) {
    const hapgrid_parameter* p = find(key, HAPGRID_TEXT, "a text");
    return p ? p->texts[0] : default_value;
  }
  std::vector<double> numbers(const std::string& key) {
    const hapgrid_parameter* p = find(key, HAPGRID_NUMBERS, "an array of numbers");
    return p ? std::vector<double>(p->numbers, p->numbers + p->count) : std::vector<double>();
  }
  std::vector<std::string> texts(const std::string& key) {
    const hapgrid_parameter* p = find(key, HAPGRID_TEXTS, "an array of texts");
    return p ? std::vector<std::string>(p->texts, p->texts + p->count) : std::vector<std::string>();
  }
  /// @throw std::runtime_error that names the keys that are given but unknown, and those known.
  void finish() const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (asked_.count(parameters_[i].key)) continue;
      std::string known;
      for (const std::string& key : asked_) known += (known.empty() ? "" : ", ") + key;
      throw std::runtime_error(std::string("unknown parameter ") + parameters_[i].key +
                               " (known: " + known + ")");
    }
  }

 private:
  const hapgrid_parameter* find(const std::string& key, int type, const char* expected) {
    asked_.insert(key);
    for (std::size_t i = 0; i < count_; ++i) {
      if (key != parameters_[i].key) continue;
      if (parameters_[i].type != type)
        throw std::runtime_error("parameter " + key + " must be " + expected);
      return &parameters_[i];
    }
    return nullptr;
  }

  const hapgrid_parameter* parameters_;
  std::size_t count_;
  std::set<std::string> asked_;
};

/// Orientations. In a state, an orientation is the first two columns of its rotation matrix R, six
/// numbers that periods() marks with HAPGRID_ROTATION. A place b of the body lies at R b.
/// Quaternions would have two signs for each orientation, and angles of rotations have seams;
/// columns have neither.
namespace orientation {

/// Makes six numbers orthonormal: the first column keeps its direction. The columns must not be
/// parallel or zero.
inline void normalise(double* columns) {
  double* const p = columns;
  double* const q = columns + 3;
  const double first = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  for (int k = 0; k < 3; ++k) p[k] /= first;
  const double along = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  for (int k = 0; k < 3; ++k) q[k] -= along * p[k];
  const double second = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  for (int k = 0; k < 3; ++k) q[k] /= second;
}

/// R b, for the body's place b.
inline void apply(const double* columns, const double* b, double* out) {
  const double *p = columns, *q = columns + 3;
  const double r[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                       p[0] * q[1] - p[1] * q[0]};
  for (int k = 0; k < 3; ++k) out[k] = p[k] * b[0] + q[k] * b[1] + r[k] * b[2];
}

/// Turns the body by the rotation vector `turn`: around its direction, by its length in radians.
inline void turn(double* columns, const double* turn) {
  const double angle = std::sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
  if (angle == 0) return;
  const double n[3] = {turn[0] / angle, turn[1] / angle, turn[2] / angle};
  const double c = std::cos(angle), s = std::sin(angle);
  for (double* v = columns; v < columns + 6; v += 3) {  // Rodrigues' formula
    const double along = (n[0] * v[0] + n[1] * v[1] + n[2] * v[2]) * (1 - c);
    const double across[3] = {n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2],
                              n[0] * v[1] - n[1] * v[0]};
    for (int k = 0; k < 3; ++k) v[k] = c * v[k] + s * across[k] + along * n[k];
  }
  normalise(columns);
}

}  // namespace orientation

namespace plugin_detail {

template <class F>
int guarded(char* error, std::size_t error_size, F&& f) noexcept {
  try {
    f();
    return 0;
  } catch (const std::exception& e) {
    std::snprintf(error, error_size, "%s", e.what());
  } catch (...) {
    std::snprintf(error, error_size, "unknown exception");
  }
  return 1;
}

template <class Model>
hapgrid_model_table table(const char* summary) {
  hapgrid_model_table t{};
  t.interface_version = HAPGRID_MODEL_INTERFACE;
  t.summary = summary;
  t.create = [](const hapgrid_parameter* parameters, std::size_t count, char* error,
                std::size_t error_size) -> hapgrid_model* {
    Model* model = nullptr;
    guarded(error, error_size, [&] {
      PluginParameters p(parameters, count);
      model = new Model(p);
    });
    return reinterpret_cast<hapgrid_model*>(model);
  };
  t.destroy = [](hapgrid_model* m) { delete reinterpret_cast<Model*>(m); };
  t.info = [](const hapgrid_model* m, hapgrid_model_info* info) {
    *info = reinterpret_cast<const Model*>(m)->info();
  };
  t.known_states = [](hapgrid_model* m, const double* x, double* states, std::size_t capacity,
                      std::size_t* count, char* error, std::size_t error_size) -> int {
    return guarded(error, error_size, [&] {
      const Model& model = *reinterpret_cast<const Model*>(m);
      const std::vector<double> known = model.known_states(x);
      const std::size_t n = model.info().state_size;
      *count = known.size() / n;
      // A loop: of std::copy_n GCC 14 warns where it sees how many states there are.
      for (std::size_t i = 0; i < std::min(*count, capacity) * n; ++i) states[i] = known[i];
    });
  };
  t.convert = [](hapgrid_model* m, const double* s, const double* x, const double* d,
                 double* result, char* error, std::size_t error_size) -> int {
    return guarded(error, error_size,
                   [&] { reinterpret_cast<Model*>(m)->convert(s, x, d, result); });
  };
  t.equal = [](const hapgrid_model* m, const double* a, const double* b) -> int {
    return reinterpret_cast<const Model*>(m)->equal(a, b);
  };
  if constexpr (requires(Model & m, const double* x, double* f) { m.force(x, x, f); })
    t.force = [](hapgrid_model* m, const double* x, const double* s, double* f) {
      reinterpret_cast<Model*>(m)->force(x, s, f);
    };
  if constexpr (requires(Model & m, const double* x) { m.energy(x, x); })
    t.energy = [](hapgrid_model* m, const double* x, const double* s) -> double {
      return reinterpret_cast<Model*>(m)->energy(x, s);
    };
  constexpr bool shaped_by_state = requires(Model & m, const double* s, float* centres) {
    m.shape(s, centres);
  };
  constexpr bool shaped_by_place = requires(Model & m, const double* x, float* centres) {
    m.shape(x, x, centres);
  };
  if constexpr (shaped_by_state || shaped_by_place) {
    t.spheres = [](const hapgrid_model* m, hapgrid_sphere* spheres) {
      reinterpret_cast<const Model*>(m)->spheres(spheres);
    };
    t.shape = [](hapgrid_model* m, [[maybe_unused]] const double* x, const double* s,
                 float* centres) {
      if constexpr (shaped_by_place)
        reinterpret_cast<Model*>(m)->shape(x, s, centres);
      else
        reinterpret_cast<Model*>(m)->shape(s, centres);
    };
  }
  if constexpr (requires(Model & m, const double* s) { m.own_energy(s); })
    t.own_energy = [](hapgrid_model* m, const double* s) -> double {
      return reinterpret_cast<Model*>(m)->own_energy(s);
    };
  if constexpr (requires(const Model& m, hapgrid_torsion* t) { m.torsions(t); })
    t.torsions = [](const hapgrid_model* m, hapgrid_torsion* torsions) {
      reinterpret_cast<const Model*>(m)->torsions(torsions);
    };
  if constexpr (requires(const Model& m, double* p) { m.periods(p); })
    t.periods = [](const hapgrid_model* m, double* periods) {
      reinterpret_cast<const Model*>(m)->periods(periods);
    };
  if constexpr (requires(Model & m) { m.check(); })
    t.check = [](hapgrid_model* m, void (*tell)(void*, const char*), void* context) {
      char error[512];
      const int failed = guarded(error, sizeof error, [&] {
        for (const std::string& line : reinterpret_cast<Model*>(m)->check())
          tell(context, line.c_str());
      });
      if (failed) tell(context, error);
    };
  return t;
}

}  // namespace plugin_detail
}  // namespace hapgrid

#define HAPGRID_MODEL_PLUGIN(Model, summary)                                                \
  extern "C" __attribute__((visibility("default"))) const hapgrid_model_table*              \
  hapgrid_model_plugin(void) {                                                              \
    static const hapgrid_model_table table = hapgrid::plugin_detail::table<Model>(summary); \
    return &table;                                                                          \
  }
