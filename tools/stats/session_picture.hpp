// A session as curves over time: force, HIP, energy, lateness, compute time, and flags.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/session/session.hpp"
#include "libcore/session/statistics.hpp"
#include "tools/stats/session_report.hpp"

namespace hapgrid {

/// The curves of a session in some 1500 columns, each with the range of every curve, so that a peak
/// of one tick is seen however long the session is.
class SessionCurves {
 public:
  /// For ticks with numbers from `first` to `last`.
  SessionCurves(SessionHeader header, std::uint64_t first, std::uint64_t last, EnergyUnit unit);

  void add(const TickRecord& tick);

  /// A script for run_gnuplot().
  std::string script(const std::string& subtitle) const;

 private:
  static constexpr std::size_t kSeries = 10;  // force as sent, of the model, HIP, energy
  struct Range {
    double low = 0;
    double high = 0;
    bool any = false;
    void add(double value);
  };
  struct Column {
    std::uint64_t first = 0;  ///< number
    std::uint64_t last = 0;   ///< number
    bool any = false;
    std::array<Range, kSeries> series;
    std::uint32_t flags = 0;
    double lateness_us = 0;
    double compute_us = 0;
  };

  double time_end(std::size_t column) const;
  bool gap_before(std::size_t column, std::size_t before) const;
  void append_series(std::string& script, std::size_t series) const;
  void append_times(std::string& script, const char* name, double Column::*member) const;
  void append_flag(std::string& script, std::size_t flag) const;
  Range range(std::size_t first_series, std::size_t last_series) const;
  Range time_range() const;
  std::string force_panel() const;
  std::string hip_panel() const;
  std::string energy_panel() const;
  std::string time_panel() const;
  std::string flag_panel(const std::vector<std::size_t>& flags) const;

  SessionHeader header_;
  std::uint64_t first_;
  std::uint64_t last_;
  EnergyUnit unit_;
  HandEnergy energy_;
  std::vector<Column> columns_;
};

}  // namespace hapgrid
