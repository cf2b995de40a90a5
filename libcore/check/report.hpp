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

/// Where in a grid something is. A field that is not set does not apply.
struct Location {
  std::optional<PointIndex> point{};
  std::optional<Level> level{};
  std::optional<int> direction{};  ///< q of a link

  bool operator==(const Location&) const = default;
};
inline Location location_of(const Grid& grid, RecordIndex r) {
  return {grid.point(r), grid.level(r), {}};
}
inline Location location_of(const Grid& grid, RecordIndex r, int q) {
  return {grid.point(r), grid.level(r), q};
}

struct Offender {
  std::string text;  ///< for people: the location, and what is wrong there
  Location location{};

  bool operator==(const Offender&) const = default;
};

/// How many things a check has tested, how many of them offend, and the first of these.
struct Findings {
  static constexpr std::size_t kShown = 5;

  std::uint64_t counted = 0;
  std::uint64_t offenders = 0;
  std::vector<Offender> first;  ///< at most kShown, in ascending order of the grid

  /// `describe()` is only called while the text is wanted.
  template <class Describe>
  void offend(const Location& location, Describe&& describe) {
    ++offenders;
    if (first.size() < kShown) first.push_back({describe(), location});
  }
  /// An offender without a location in a grid.
  template <class Describe>
  void offend(Describe&& describe) {
    offend(Location{}, std::forward<Describe>(describe));
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

/// The checks whose figures and first offenders a text shows.
enum class Details {
  kNotFine,  ///< those that are broken or not proved
  kAll
};

/// A table with a row a check, then the details.
std::string checks_text(const std::vector<Check>& checks, Details details);
/// [{"name", "verdict", "counted", "unit", "offenders", "meaning", "first": [{"text", and as far as
/// it has them "point": [i, j, k], "level", "direction": [di, dj, dk]}], "not_proved" where the
/// verdict is that, "figures": [{"name", "value", "unit", "where"}]}]
/// @param box of the grid that was checked
nlohmann::ordered_json checks_json(const Box& box, const std::vector<Check>& checks);

/// What grid it is, and checks_text().
std::string report_text(const Grid& grid, const std::vector<Check>& checks, Details details);

/// {"version": 1, "model", "counts", "records", "generation", "verdict": "fine", "broken" or "not
/// proved", "checks": checks_json()}. The version number increases when a key is removed or changes
/// its meaning.
std::string report_json(const Grid& grid, const std::vector<Check>& checks);

}  // namespace hapgrid
