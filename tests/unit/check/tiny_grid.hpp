// A grid that can be checked by hand: four points in a row and a model like the hung ball's. At
// both ends the state is 0; between them a body is pushed to +1 by who comes from the left and to
// -1 by who comes from the right, and keeps its side until an end is reached.
//
//   point       0    1    2    3       generation
//   level 0     0   +1   -1    0       0 1 1 0
//   level 1         -1   +1              2 2
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "libcore/check/fidelity.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid::tiny {

inline std::vector<std::string> texts(const Findings& found) {
  std::vector<std::string> texts;
  for (const Offender& offender : found.first) texts.push_back(offender.text);
  return texts;
}

inline double figure(const Check& check, const std::string& name) {
  for (const Figure& f : check.figures)
    if (f.name == name) return f.value;
  return 0;
}

inline constexpr int kLeft = 12;   // (-1, 0, 0)
inline constexpr int kRight = 13;  // (+1, 0, 0)

inline GridSpec spec() {
  GridSpec spec;
  spec.box = {{0.5, 0, 0}, 0.25, {4, 1, 1}};
  spec.model = "tiny";
  spec.parameters = {{"name", std::string("x\xff\n")}, {"probe.radius", 0.1}};
  spec.tolerance = 1e-6;
  spec.tolerance_unit = "m";
  return spec;
}

/// Appends a record whose links left and right are given; all others leave the box.
inline void add(RecordColumns& c, PointIndex point, Level level, std::uint32_t generation,
                double state, Level left, Level right) {
  c.point.push_back(point);
  c.level.push_back(level);
  c.generation.push_back(generation);
  c.rows.push_back(state);
  for (int q = 0; q < kDirections; ++q)
    c.links.push_back(q == kLeft ? left : q == kRight ? right : kLeavesBox);
}

/// The complete grid, written by the third round.
inline constexpr std::uint32_t kGeneration = 3;
inline RecordColumns records() {
  RecordColumns c;
  add(c, 0, 0, 0, 0, kLeavesBox, 0);
  add(c, 1, 0, 1, +1, 0, 1);
  add(c, 1, 1, 2, -1, 0, 0);
  add(c, 2, 0, 1, -1, 1, 0);
  add(c, 2, 1, 2, +1, 0, 0);
  add(c, 3, 0, 0, 0, 0, kLeavesBox);
  return c;
}
inline Level& link(RecordColumns& c, RecordIndex r, int q) {
  return c.links[std::size_t{r} * kDirections + static_cast<std::size_t>(q)];
}

inline Grid grid() { return Grid(spec(), kGeneration, records()); }

/// After the first round: the ends are expanded, the middle waits.
inline Grid after_one_round() {
  RecordColumns c;
  add(c, 0, 0, 0, 0, kLeavesBox, 0);
  add(c, 1, 0, 1, +1, kUnsettled, kUnsettled);
  add(c, 2, 0, 1, -1, kUnsettled, kUnsettled);
  add(c, 3, 0, 0, 0, 0, kLeavesBox);
  return Grid(spec(), 1, c);
}

/// A model of which a test gives C. Two states are the same where their first components are.
class TestModel final : public Model {
 public:
  /// Answers false and says why in `error` when it fails.
  using Convert = std::function<bool(const double* s, const Vec3& x, const Vec3& d, double* row,
                                     std::string& error)>;
  TestModel(const ModelDescription& description, Convert convert)
      : Model({description, 1, 0, 0, {}}), convert_(std::move(convert)) {}

  std::vector<double> known_states(const Vec3&) override { return {}; }
  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row) override {
    return convert_(s, x, d, row, error_);
  }
  bool complete(const Vec3&, double*) override { return true; }
  bool equal(const double* a, const double* b) const override {
    return std::abs(*a - *b) <= info().tolerance;
  }

 private:
  Convert convert_;
};

inline std::unique_ptr<Model> model(double tolerance = 1e-6) {
  GridSpec description = spec();
  description.tolerance = tolerance;
  return std::make_unique<TestModel>(
      description, [](const double* s, const Vec3& x, const Vec3& d, double* result, std::string&) {
        const double target = (x[0] - 0.5 + d[0]) / 0.25;
        const bool is_end = target < 0.5 || target > 2.5;
        *result = is_end ? 0 : *s != 0 ? *s : d[0] > 0 ? 1 : -1;
        return true;
      });
}

}  // namespace hapgrid::tiny
