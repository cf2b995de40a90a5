#include "libcore/check/report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

const Grid kGrid = tiny::grid();

std::vector<Check> checks() {
  Check fine{"finite", "records", "states that are not", {}};
  fine.found.counted = 6;
  Check bad{"links", "directions", "levels that cannot be", {}};
  bad.found.counted = 156;
  for (int i = 0; i < 7; ++i)
    bad.found.offend({1, 2, 13}, [&] { return "offender " + std::to_string(i); });
  Check note{"steep", "cells", "steep cells", {}, true};
  note.found.counted = 3;
  note.found.offend([] { return "cell"; });
  return {fine, bad, note};
}

}  // namespace

TEST_CASE("the report as text") {
  const std::string table =
      "tiny: 4 x 1 x 1 points, 6 records, generation 3\n"
      "check   counted             offenders  verdict\n"
      "finite        6 records             0  ok\n"
      "links       156 directions          7  broken\n"
      "steep         3 cells               1  note\n"
      "\n"
      "links: levels that cannot be\n"
      "  offender 0\n"
      "  offender 1\n"
      "  offender 2\n"
      "  offender 3\n"
      "  offender 4\n"
      "  and 2 more\n";
  CHECK(report_text(kGrid, checks(), Details::kNotFine) == table);
  CHECK(report_text(kGrid, checks(), Details::kAll) == table + "\nsteep: steep cells\n  cell\n");
}

TEST_CASE("the verdict names what is broken, and notes are no faults") {
  auto rows = checks();
  CHECK_FALSE(is_fine(rows));
  CHECK(verdict_line(rows) == "broken: links (7 of 156)");
  rows.erase(rows.begin() + 1);
  CHECK(is_fine(rows));
  CHECK(verdict_line(rows) == "fine: 1 checks");
}

TEST_CASE("the report as JSON, also when the shard's strings are no UTF-8") {
  GridSpec spec = tiny::spec();
  spec.model = "bad\xff";
  const Grid grid(spec, tiny::kGeneration, tiny::records());
  const auto json = nlohmann::json::parse(report_json(grid, checks()));
  CHECK(json["version"] == 1);
  CHECK(json["verdict"] == "broken");
  CHECK(json["counts"] == std::vector<int>{4, 1, 1});
  CHECK(json["records"] == 6);
  CHECK(json["checks"].size() == 3);
  CHECK(json["checks"][1]["name"] == "links");
  CHECK(json["checks"][1]["verdict"] == "broken");
  CHECK(json["checks"][1]["offenders"] == 7);
  CHECK(json["checks"][1]["first"].size() == 5);
  CHECK(json["checks"][1]["first"][4] ==
        nlohmann::json{
            {"text", "offender 4"}, {"point", {1, 0, 0}}, {"level", 2}, {"direction", {1, 0, 0}}});
  CHECK(json["checks"][2]["first"][0] == nlohmann::json{{"text", "cell"}});
  CHECK(report_text(grid, {}, Details::kAll).substr(0, 5) == "bad?:");
}
