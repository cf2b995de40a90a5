// What verify found: a table with a row for each check, and details below. It is printed as text
// for people, and as JSON for programs.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// What offends, and where in a grid it is: a field that is not set does not apply.
struct Offender {
  std::string text{};  ///< for people: the place, and what is wrong there
  std::optional<PointIndex> point{};
  std::optional<Level> level{};
  std::optional<int> direction{};  ///< q of a link

  bool operator==(const Offender&) const = default;
};
inline Offender at_record(const Grid& grid, RecordIndex r) {
  return {.point = grid.point(r), .level = grid.level(r)};
}
inline Offender at_link(const Grid& grid, RecordIndex r, int q) {
  return {.point = grid.point(r), .level = grid.level(r), .direction = q};
}

/// How many things a check has tested, how many of them offend, and the first of these.
struct Findings {
  static constexpr std::size_t kShown = 5;

  std::uint64_t counted = 0;
  std::uint64_t offenders = 0;
  std::vector<Offender> first;  ///< at most kShown, in ascending order of the grid

  /// @param describe gives the text. It is only called while that is wanted.
  template <class Describe>
  void offend(Offender offender, Describe&& describe) {
    ++offenders;
    if (first.size() == kShown) return;
    offender.text = describe();
    first.push_back(std::move(offender));
  }
  /// An offender without a place in a grid.
  template <class Describe>
  void offend(Describe&& describe) {
    offend(Offender{}, std::forward<Describe>(describe));
  }
  /// Appends what was found in a later part of the grid.
  void add(Findings&& later) {
    counted += later.counted;
    offenders += later.offenders;
    for (Offender& offender : later.first)
      if (first.size() < kShown) first.push_back(std::move(offender));
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
  /// A few words for the verdict's line, where everything may be fine, but who reads no report must
  /// know this; empty where there is nothing.
  std::string remark{};
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

/// One line: "fine: 8 checks", "fine: 8 checks, but nothing can be felt", "broken: links (3 of
/// 104), distinct (1 of 2)", or "not proved: passive".
std::string verdict_line(const std::vector<Check>& checks);

/// A table with a row a check, then figures and first offenders: of all checks, or of those that
/// are broken or not proved.
std::string checks_text(const std::vector<Check>& checks, bool all);
/// [{"name", "verdict", "counted", "unit", "offenders", "meaning", "first": [{"text", and as far as
/// it has them "point": [i, j, k], "level", "direction": [di, dj, dk]}], "not_proved" where the
/// verdict is that, "figures": [{"name", "value", "unit", "where"}]}]
/// @param box of the grid that was checked
nlohmann::ordered_json checks_json(const Box& box, const std::vector<Check>& checks);

/// What grid it is, and checks_text().
std::string report_text(const Grid& grid, const std::vector<Check>& checks, bool all);

/// {"version": 1, "model", "counts", "records", "generation", "verdict": "fine", "broken" or "not
/// proved", "checks": checks_json()}. The version number increases when a key is removed or changes
/// its meaning.
std::string report_json(const Grid& grid, const std::vector<Check>& checks);

}  // namespace hapgrid
