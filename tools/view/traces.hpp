// The last seconds of play as curves, and the newest numbers as a line of text.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Force and energy of the last kSeconds of play.
class Traces {
 public:
  static constexpr double kSeconds = 10;
  /// Play writes fewer frames in that time; of a faster stream the newest are kept.
  static constexpr std::size_t kMaxSamples = 4096;

  struct Sample {
    double time_s;
    double force;   ///< newtons, the magnitude, as sent
    double energy;  ///< in the scene's unit; NaN if there is none
    /// Whether the state snapped after the frame before.
    bool snapped;
    double own_energy;  ///< of the model by itself; NaN if there is none
  };

  /// Frames come in the order of ticks. When the time goes back, the curves start anew.
  void add(const Frame& frame);
  const std::deque<Sample>& samples() const { return samples_; }

 private:
  std::deque<Sample> samples_;
  std::uint64_t jumps_ = 0;
};

/// The lowest and the highest finite value of a curve; never equal.
struct Extent {
  double low = 0;
  double high = 0;

  /// Where a value is: 0 at the low end, 1 at the high one.
  double operator()(double value) const { return (value - low) / (high - low); }
};

/// From zero to the largest force; 0 to 1 when there is no force at all.
Extent force_extent(const Traces& traces);
/// The extent of both energies. Low and high are NaN when none is finite.
Extent energy_extent(const Traces& traces);

/// One of the few columns that a terminal has for a curve.
struct Column {
  double force;   ///< the largest; NaN before the first sample
  double energy;  ///< the last; NaN if there is none
  bool snapped = false;
};

/// The kSeconds before the newest sample, in `count` equal parts. A part without a sample has the
/// values of the part before.
std::vector<Column> columns(const Traces& traces, int count);

/// "t 3.24 s   force 0.513 N   energy 12.3 kJ/mol   model alone 9.1   psi +67°": the energy, with
/// that of the model itself, if the model has one; the torsion that has turned farthest, if one
/// has.
std::string status_text(const Scene& scene, const Frame& frame);

}  // namespace hapgrid
