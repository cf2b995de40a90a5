// What verify found: a row for each check, as a table for people or as JSON for programs.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// How many things were looked at, how many of them offend, and the first few in words.
struct Findings {
  static constexpr std::size_t kShown = 5;

  std::uint64_t counted = 0;
  std::uint64_t offenders = 0;
  std::vector<std::string> first;  ///< at most kShown, in ascending order of the grid

  /// `describe()` is only called while the text is wanted.
  template <class Describe>
  void offend(Describe&& describe) {
    ++offenders;
    if (first.size() < kShown) first.push_back(describe());
  }
  /// Appends what was found in a later part of the grid.
  void add(Findings&& later) {
    counted += later.counted;
    offenders += later.offenders;
    for (std::string& text : later.first)
      if (first.size() < kShown) first.push_back(std::move(text));
  }
};

/// A number that a check found, worth knowing whatever the verdict.
struct Figure {
  std::string name;  ///< stable: scripts look for it
  double value = 0;
  std::string unit;
  std::string where;  ///< or what it means, for people; may be empty
};

struct Check {
  std::string name;     ///< stable: scripts look for it
  std::string unit;     ///< what was counted: "records"
  std::string meaning;  ///< what an offender is, in one phrase
  Findings found;
  bool is_note = false;  ///< worth knowing, but no fault
  std::vector<Figure> figures{};
  /// Why the check neither found an offender nor proved that there is none, and what to do; empty
  /// where it did.
  std::string not_proved{};
  /// "ok", "broken", "not proved" or "note"
  std::string verdict() const {
    if (is_note) return "note";
    return found.offenders > 0 ? "broken" : not_proved.empty() ? "ok" : "not proved";
  }
};

/// Whether no check is broken, and each has proved what it says.
bool is_fine(const std::vector<Check>& checks);
/// Whether a check is broken.
bool is_broken(const std::vector<Check>& checks);

/// One line: "fine: 8 checks", "broken: links (3 of 104), distinct (1 of 2)", or "not proved:
/// passive".
std::string verdict_line(const std::vector<Check>& checks);

/// A table with a row a check, then figures and first offenders of each check that has any.
std::string checks_text(const std::vector<Check>& checks);
/// [{"name", "verdict", "counted", "unit", "offenders", "meaning", "first", "figures": [{"name",
/// "value", "unit", "where"}]}]
nlohmann::ordered_json checks_json(const std::vector<Check>& checks);

/// What grid it is, and checks_text().
std::string report_text(const Grid& grid, const std::vector<Check>& checks);

/// {"model", "counts", "records", "generation", "fine", "checks": checks_json()}; keys are only
/// ever added.
std::string report_json(const Grid& grid, const std::vector<Check>& checks);

}  // namespace hapgrid
