// What happened in the last seconds, for curves, and the newest numbers as a line of text.
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
  /// More than play writes in that time; of a stream that has more the newest are kept.
  static constexpr std::size_t kMaxSamples = 4096;

  struct Sample {
    double time_s;
    double force;   ///< newtons, the magnitude, as sent
    double energy;  ///< in the scene's unit; NaN: none
    /// The levels in the cell's corners are others than in the frame before.
    bool switched;
  };

  /// Frames come in the order of ticks; where the time goes back all the same, curves start anew.
  void add(const Frame& frame);
  const std::deque<Sample>& samples() const { return samples_; }

 private:
  std::deque<Sample> samples_;
  std::array<std::uint8_t, 8> levels_{};
};

/// The lowest and the highest finite value of a curve, apart even where all are the same.
struct Extent {
  double low = 0;
  double high = 0;

  /// Where a value is: 0 at the low end, 1 at the high one.
  double operator()(double value) const { return (value - low) / (high - low); }
};

/// From zero on. Of no sample, and of nothing but zeros, 0 .. 1.
Extent force_extent(const Traces& traces);
/// Without a finite energy low and high are NaN.
Extent energy_extent(const Traces& traces);

/// A column of a curve with few of them, as a terminal has.
struct Column {
  double force;   ///< the largest; NaN before the first sample
  double energy;  ///< the last; NaN where there is none
  bool switched = false;
};

/// The kSeconds up to the newest sample in `count` equal parts; one without a sample has the values
/// of the one before.
std::vector<Column> columns(const Traces& traces, int count);

/// A number for people, three significant digits: "0.513", "1.2e+06".
std::string three_digits(double value);

/// "t 3.24 s   force 0.513 N   energy 12.3 kJ/mol   levels 0 1   dropped 2": energy only if there
/// is one, the levels that the cell's corners have, and how many frames were never drawn.
std::string status_text(const Scene& scene, const Frame& frame, std::uint64_t dropped);

}  // namespace hapgrid
