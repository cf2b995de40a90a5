#include "tools/stats/session_picture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/stats/gnuplot.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMostColumns = 1500;
constexpr double kLargest = 1e30;  // more is no curve that anybody looks at
constexpr double kLeastMicroseconds = 0.01;

// Pixels.
constexpr double kWidth = 1300;
constexpr double kLeft = 165;
constexpr double kRight = 190;  // for the legends
constexpr double kTop = 75;
constexpr double kPanel = 230;
constexpr double kGap = 30;
constexpr double kFlagRow = 22;
constexpr double kBottom = 65;

/// Okabe and Ito's, dark for x y z, and lighter ones of the same hues.
constexpr std::array kAxisColours{"#0072b2", "#d55e00", "#009e73"};
constexpr std::array kLightColours{"#9fd3f0", "#f7c39a", "#9fdcc8"};

/// A panel's place: its upper and lower edge in pixels from the picture's top.
std::string place(double height, double top, double bottom) {
  const auto y = [&](double pixels) { return rounded(1 - pixels / height); };
  return "set lmargin at screen " + rounded(kLeft / kWidth) + "\nset rmargin at screen " +
         rounded(1 - kRight / kWidth) + "\nset tmargin at screen " + y(top) +
         "\nset bmargin at screen " + y(bottom) + "\nset key at screen " +
         rounded(1 - (kRight - 12) / kWidth) + ", screen " + y(top) +
         " left top vertical Left reverse samplen 2 spacing 1.2\n";
}

void append_point(std::string& script, double x, double y) {
  script += to_text(x) + ' ' + to_text(y) + '\n';
}

/// Room above and below; some for a curve that hardly ever changes, as far as gnuplot can tell.
std::string y_range(double low, double high) {
  const double size = std::max(std::abs(low), std::abs(high));
  const double margin =
      high - low > std::max(1e-9 * size, 1e-30) ? 0.06 * (high - low) : std::max(size, 1e-3);
  return format("set yrange [{}:{}]\n", to_text(low - margin), to_text(high + margin));
}

std::string curve(const std::string& data, double width, const std::string& colour,
                  const std::string& title) {
  return format("{} with lines lw {} lc rgb '{}' title {}", data, rounded(width), colour,
                gnuplot_string(title));
}

}  // namespace

void SessionCurves::Range::add(double value) {
  if (!(std::abs(value) <= kLargest)) return;
  low = any ? std::min(low, value) : value;
  high = any ? std::max(high, value) : value;
  any = true;
}

SessionCurves::SessionCurves(SessionHeader header, std::uint64_t first, std::uint64_t last,
                             EnergyUnit unit)
    : header_(std::move(header)),
      first_(first),
      last_(last),
      unit_(std::move(unit)),
      energy_(header_),
      columns_(static_cast<std::size_t>(std::min(last - first, kMostColumns - 1) + 1)) {}

void SessionCurves::add(const TickRecord& tick) {
  // Someone may have changed the file since its first and last tick were counted.
  if (tick.number < first_ || tick.number > last_) return;
  // In doubles: the last number may be anything below 2^64.
  const double part =
      static_cast<double>(tick.number - first_) / (static_cast<double>(last_ - first_) + 1);
  const auto at = static_cast<std::size_t>(part * static_cast<double>(columns_.size()));
  Column& column = columns_[std::min(at, columns_.size() - 1)];
  if (!column.any) column.first = tick.number;
  column.any = true;
  column.last = tick.number;
  for (std::size_t a = 0; a < 3; ++a) {
    column.series[a].add(tick.force[a]);
    column.series[3 + a].add(tick.raw_force[a]);
    column.series[6 + a].add(tick.hip[a]);
  }
  energy_.add(tick);
  column.series[9].add(energy_.since_begin() * unit_.factor);
  column.flags |= tick.flags;
  column.lateness_us = std::max(column.lateness_us, tick.lateness_ns / 1e3);
  column.compute_us = std::max(column.compute_us, tick.compute_ns / 1e3);
}

/// Where the next column begins.
double SessionCurves::time_end(std::size_t column) const {
  return header_.time_of(columns_[column].last) + 1 / header_.rate_hz;
}

/// Whether a curve must not be drawn through what lies between: many ticks, and more than can be
/// told apart in the picture.
bool SessionCurves::gap_before(std::size_t column, std::size_t before) const {
  const std::uint64_t missing = columns_[column].first - columns_[before].last;
  const auto width = static_cast<double>(last_ - first_) / static_cast<double>(columns_.size());
  return static_cast<double>(missing) > std::max(10.0, 2 * width);
}

void SessionCurves::append_series(std::string& script, std::size_t series) const {
  script += format("$s{} << END\n", series);
  bool any = false;
  std::size_t before = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (!columns_[c].any) continue;
    const Range& range = columns_[c].series[series];
    // An empty line ends a line.
    if (any && (!range.any || gap_before(c, before))) script += '\n';
    any = range.any;
    before = c;
    if (!range.any) continue;
    const double t = header_.time_of(columns_[c].first);
    append_point(script, t, range.low);
    if (range.high > range.low) append_point(script, t, range.high);
  }
  // gnuplot wants something to plot.
  script += "\n0 NaN\nEND\n";
}

void SessionCurves::append_times(std::string& script, const char* name,
                                 double Column::*member) const {
  script += format("${} << END\n", name);
  bool any = false;
  std::size_t before = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (!columns_[c].any) continue;
    if (any && gap_before(c, before)) script += '\n';
    any = true;
    before = c;
    append_point(script, header_.time_of(columns_[c].first),
                 std::max(columns_[c].*member, kLeastMicroseconds));
  }
  script += "END\n";
}

/// Rectangles x y, x from to, y from to, where the flag was set.
void SessionCurves::append_flag(std::string& script, std::size_t flag) const {
  script += format("$f{} << END\n", flag);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto set = [&](std::size_t i) { return (columns_[i].flags >> flag & 1) != 0; };
    if (!set(c)) continue;
    const double begin = header_.time_of(columns_[c].first);
    while (c + 1 < columns_.size() && set(c + 1)) ++c;
    const double end = time_end(c);
    script += format("{} 0 {} {}\n", to_text((begin + end) / 2), to_text(begin), to_text(end));
  }
  script += "END\n";
}

SessionCurves::Range SessionCurves::range(std::size_t first_series, std::size_t last_series) const {
  Range all;
  for (const Column& column : columns_)
    for (std::size_t s = first_series; s < last_series; ++s)
      if (column.series[s].any) {
        all.add(column.series[s].low);
        all.add(column.series[s].high);
      }
  return all;
}

SessionCurves::Range SessionCurves::time_range() const {
  Range all;
  for (const Column& column : columns_) {
    if (!column.any) continue;
    all.add(std::max(column.lateness_us, kLeastMicroseconds));
    all.add(std::max(column.compute_us, kLeastMicroseconds));
  }
  return all;
}

std::string SessionCurves::force_panel() const {
  const Range all = range(0, 6);
  std::string script = y_range(all.low, all.high) + "set ylabel 'force / N'\nplot ";
  for (std::size_t a = 0; a < 3; ++a)
    script +=
        curve(format("$s{}", 3 + a), 5, kLightColours[a], format("{}, of the model", "xyz"[a])) +
        ", ";
  for (std::size_t a = 0; a < 3; ++a)
    script += (a == 0 ? "" : ", ") +
              curve(format("$s{}", a), 1.5, kAxisColours[a], format("{}, as sent", "xyz"[a]));
  return script + "\n";
}

std::string SessionCurves::hip_panel() const {
  const Range all = range(6, 9);
  const std::string unit =
      header_.length_unit.empty() ? "model's unit of length" : header_.length_unit;
  std::string script = format("{}set ylabel {}\nplot ", y_range(all.low, all.high),
                              gnuplot_string(axis_label("HIP", unit)));
  for (std::size_t a = 0; a < 3; ++a)
    script += (a == 0 ? "" : ", ") +
              curve(format("$s{}", 6 + a), 1.5, kAxisColours[a], std::string(1, "xyz"[a]));
  return script + "\n";
}

std::string SessionCurves::energy_panel() const {
  const Range all = range(9, 10);
  return format("{}set ylabel {}\nplot {}\n", y_range(all.low, all.high),
                gnuplot_string(axis_label("work on the hand", unit_.name)),
                curve("$s9", 1.5, "#000000", "since it began"));
}

std::string SessionCurves::time_panel() const {
  const Range all = time_range();
  return format(
      "set logscale y\nset format y '%g'\nset yrange [{}:{}]\nset ylabel 'largest time / µs'\n"
      "plot {}, {}\nunset logscale y\n",
      to_text(all.low / 2), to_text(all.high * 2), curve("$lateness", 1.5, "#cc79a7", "lateness"),
      curve("$compute", 1.5, "#000000", "compute time"));
}

std::string SessionCurves::flag_panel(const std::vector<std::size_t>& flags) const {
  // A row a flag, the first on top.
  const std::size_t rows = std::max<std::size_t>(flags.size(), 1);
  std::string script = format("unset key\nunset ylabel\nset yrange [{}:-0.5]\nset ytics (",
                              rounded(static_cast<double>(rows) - 0.5));
  std::string plots;
  for (std::size_t row = 0; row < flags.size(); ++row) {
    const std::string& name = header_.flags[flags[row]];
    const char* const comma = row == 0 ? "" : ", ";
    script += format("{}{} {}", comma, gnuplot_string(printable_line(name, 16)), row);
    const char* colour = name == kLevelFlag              ? "#0072b2"
                         : name.starts_with(kSafetyFlag) ? "#d55e00"
                                                         : "#777777";
    plots += format(
        "{0}$f{1} using 1:($2+{2}):3:4:($2+{2}-0.35):($2+{2}+0.35) with boxxyerror fc rgb '{3}' "
        "fs solid 1 border rgb '{3}' notitle",
        comma, flags[row], row, colour);
  }
  if (flags.empty()) {
    script += "'no flag' 0";
    plots = "NaN notitle";
  }
  return format("{})\nset format x\nset xlabel 'time / s'\nplot {}\n", script, plots);
}

std::string SessionCurves::script(const std::string& subtitle) const {
  std::uint32_t seen = 0;
  for (const Column& column : columns_) seen |= column.flags;
  std::vector<std::size_t> flags;
  for (std::size_t i = 0; i < header_.flags.size(); ++i)
    if ((seen >> i & 1) != 0) flags.push_back(i);

  const double strip = kFlagRow * std::max(1.0, static_cast<double>(flags.size())) + 8;
  const double height = kTop + 4 * (kPanel + kGap) + strip + kBottom;
  const auto y = [&](double pixels) { return rounded(1 - pixels / height); };
  std::string script =
      format("set encoding utf8\nset terminal pngcairo noenhanced size {},{} font 'sans,12'\n",
             rounded(kWidth), rounded(std::round(height)));
  for (std::size_t s = 0; s < kSeries; ++s) append_series(script, s);
  append_times(script, "lateness", &Column::lateness_us);
  append_times(script, "compute", &Column::compute_us);
  for (const std::size_t flag : flags) append_flag(script, flag);

  script += format(
      "set multiplot\n"
      "set label 1 {} at screen 0.5, screen {} center font 'sans,14'\n"
      "set label 2 {} at screen 0.5, screen {} center\n",
      gnuplot_string("Session with " + printable_line(header_.model, 40)), y(25),
      gnuplot_string(subtitle), y(50));
  // At least what gnuplot can tell apart.
  const double half = std::max(0.5 / header_.rate_hz, 1e-9 * std::abs(header_.time_of(last_)));
  script += format(
      "set xrange [{}:{}]\nset tics out nomirror\nset grid lc rgb '#dddddd' lt 1\n"
      "set format x ''\nset ylabel offset 0\n",
      to_text(header_.time_of(first_) - half), to_text(header_.time_of(last_) + half));
  double top = kTop;
  const auto next = [&](double size) {
    script += place(height, top, top + size);
    top += size + kGap;
  };
  next(kPanel);
  script += force_panel() + "unset label 1\nunset label 2\n";
  next(kPanel);
  script += hip_panel();
  next(kPanel);
  script += energy_panel();
  next(kPanel);
  script += time_panel();
  next(strip);
  return script + flag_panel(flags) + "unset multiplot\n";
}

}  // namespace hapgrid
