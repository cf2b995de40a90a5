// The log of a play: a session (session_log.hpp), a text, or none.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/loop/loop.hpp"
#include "tools/play/prepared.hpp"
#include "tools/play/session_log.hpp"

namespace hapgrid {

/// A line for each tick; tools/man/play.h2m describes the columns. Keeps ticks as numbers in
/// storage that is allocated beforehand. Only flush(), outside of ticks, formats and writes them.
class TextLog {
 public:
  /// @param fields for the column of energies; without energies there is no such column.
  /// @param capacity ticks between two flushes.
  TextLog(const std::string& file, const GridSpec& spec, const Fields& fields, double rate_hz,
          std::size_t capacity);

  bool full() const { return size_ == capacity_; }
  /// Not to be called when full(). Real-time safe.
  void add(const Tick& tick) noexcept;
  /// @throw std::system_error
  void flush();
  /// Puts the file in its place. @throw std::system_error
  void commit() { output_.commit(); }

 private:
  void append(double value, const char* separator);

  OutputFile output_;
  const GridSpec& spec_;
  const Fields& fields_;
  double rate_hz_;
  std::size_t columns_;  // t, the HIP, the force before and after the safety core, the state
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<double> numbers_;
  std::vector<std::array<Level, 8>> levels_;
  std::vector<unsigned char> snaps_;  // whether the model snapped
  std::vector<double> energies_;      // of a grid that stores them
  std::vector<Vec3> positions_;       // of other grids, whose energies are computed when written
  std::string text_;
};

class Log {
 public:
  /// @param file empty: no log. @param ticks the number of ticks to come, for a text.
  /// @throw std::system_error
  Log(const std::string& file, const PlayedGrid& grid, double rate_hz, bool paced,
      std::size_t ticks, const PlayedWith& with);

  /// Real-time safe when paced. @throw std::system_error when not.
  void add(const Tick& tick);
  /// Writes what is left. @throw std::system_error
  void finish();

 private:
  std::optional<SessionRecorder> session_;
  std::optional<TextLog> text_;
};

}  // namespace hapgrid
