// The log of a play: a session (session_log.hpp), a text (text_log.hpp), or none.
#pragma once

#include <optional>
#include <string>

#include "tools/play/prepared.hpp"
#include "tools/play/session_log.hpp"
#include "tools/play/text_log.hpp"

namespace hapgrid {

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
