// The ticks of a run as text, a line each.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/haptic/loop.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// Ticks are kept as numbers in storage that is allocated beforehand; formatting and writing happen
/// in flush() only, outside the tick.
class TextLog {
 public:
  /// @param fields for the column of energies, which is there if they have any.
  /// @param capacity ticks between two flushes.
  TextLog(const std::string& file, const GridSpec& spec, const Fields& fields, double rate_hz,
          std::size_t capacity);

  bool full() const { return size_ == capacity_; }
  /// Real-time safe; not when full().
  void add(const Tick& tick) noexcept;
  /// @throw std::system_error
  void flush();
  /// Makes the file appear. @throw std::system_error
  void commit() { output_.commit(); }

 private:
  void append(double value, const char* separator);

  OutputFile output_;
  const GridSpec& spec_;
  const Fields& fields_;
  double rate_hz_;
  std::size_t columns_;  // t, the HIP, the force, the state, the raw force
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<double> numbers_;
  std::vector<std::array<Level, 8>> levels_;
  std::vector<double> energies_;  // where they are stored; else
  std::vector<Vec3> positions_;   // where they belong to: they are computed when they are written
  std::string text_;
};

/// The columns, for a help text.
inline constexpr const char* kTextLogHelp =
    "  t          time of the tick in seconds: its number divided by --rate, or by 1000\n"
    "             without it; missed ticks count\n"
    "  x y z      HIP as the device gave it; outside the box it is held at the box's edge,\n"
    "             where state and force belong to\n"
    "  fx fy fz   force in newtons as it was sent\n"
    "  l0 ... l7  levels in the corners i + 2j + 4k of the cell\n"
    "  s0 ...     interpolated state, in the model's units\n"
    "  energy     of that state with the HIP there, in the model's unit; only if the grid or\n"
    "             its model has energies\n"
    "  rx ry rz   force in newtons as the model gave it, before the safety core; nan where the\n"
    "             model was not asked\n";

}  // namespace hapgrid
