// The last seconds of play as curves, and the newest numbers as a line of text.
#pragma once

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
    double time_s = 0;
    double force;          ///< newtons, the magnitude, as sent; NaN before the first frame
    double energy;         ///< in the scene's unit; NaN if there is none
    bool snapped = false;  ///< whether the state snapped after the frame before
  };

  /// Frames come in the order of ticks. When the time goes back, the curves start anew.
  void add(const Frame& frame);
  const std::deque<Sample>& samples() const { return samples_; }
  /// The kSeconds before the newest sample in `count` equal parts, the few columns that a terminal
  /// has: of each the largest force and the last energy. A part without a sample has the values of
  /// the part before.
  std::vector<Sample> columns(int count) const;

 private:
  std::deque<Sample> samples_;
  std::uint64_t jumps_ = 0;
};

/// "t 3.24 s   force 0.513 N   energy 12.3 kJ/mol   model alone 9.1   psi +67°": the energy, with
/// that of the model itself, if the model has one; the torsion that has turned farthest, if one
/// has.
std::string status_text(const Scene& scene, const Frame& frame);

}  // namespace hapgrid
