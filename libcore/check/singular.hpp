// Places in which a model is singular: near a pole of its force, energy or state, a grid of any
// spacing is wrong, and so is one across a jump that is no snap.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// Follows from the steps of a walk those where something is largest, and where the force changes
/// most:
/// - From where the force, the energy or a number of the state is largest it climbs on, by shifts
///   along the axes that get smaller and smaller. What is finite and smooth hardly grows any more
///   when the shifts are small against the spacing. Near a pole it doubles with each halving.
/// - A step in which the force changes much, and that leads back to where it came from, is halved
///   again and again, towards the half with the larger change. What is continuous changes less and
///   less. At a snap the state changes too, and does not come back.
class SingularPlaces {
 public:
  /// @param spec, model outlive this
  SingularPlaces(const GridSpec& spec, Model& model);

  /// A place of the walk, with the HIP at x.
  void visit(const Vec3& x, const std::vector<double>& row);
  /// A step of the walk from `from` at x to `to` at x + d that leads back.
  void pass(const Vec3& x, const Vec3& d, const std::vector<double>& from,
            const std::vector<double>& to);
  /// @param deadline no further place is followed after it
  Findings search(std::chrono::steady_clock::time_point deadline);

 private:
  using Row = std::vector<double>;
  struct Place {
    Vec3 x{};
    Row row;
    double value = 0;
  };
  struct Step {
    Vec3 x{}, d{};
    Row from, to;
    double change = 0;
  };
  enum Quantity { kForce, kEnergy, kState, kQuantities };

  bool has(Quantity quantity) const;
  Vec3 force(const Vec3& x, const Row& row) const;
  double value(Quantity quantity, const Vec3& x, const Row& row) const;
  bool move(const Place& from, const Vec3& d, Quantity quantity, Place& to);
  void climb(Quantity quantity, Place place);
  void halve(Step step);
  void offend(const Vec3& x, const std::string& what);

  const GridSpec& spec_;
  Model& model_;
  Vec3 low_{}, high_{};  // of the box
  std::vector<Place> largest_[kQuantities];
  std::vector<Step> steepest_;
  double largest_force_ = 0;
  Findings found_;
};

}  // namespace hapgrid
