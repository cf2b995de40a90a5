#include "libcore/check/report.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

const GridSpec kSpec = tiny::spec();
const ReportedGrid kGrid{kSpec, 6, tiny::kGeneration};

std::vector<Check> checks() {
  Check fine{"finite", "records", "states that are not", {}};
  fine.found.counted = 6;
  Check bad{"links", "directions", "levels that cannot be", {}};
  bad.found.counted = 156;
  for (int i = 0; i < 7; ++i)
    bad.found.offend({1, 2, 13}, [&] { return "offender " + std::to_string(i); });
  Check note{"blends", "cells", "mixed cells", {}, true};
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
      "blends        3 cells               1  note\n"
      "\n"
      "links: levels that cannot be\n"
      "  offender 0\n"
      "  offender 1\n"
      "  offender 2\n"
      "  offender 3\n"
      "  offender 4\n"
      "  and 2 more\n";
  CHECK(report_text(kGrid, checks(), Details::kNotFine) == table);
  CHECK(report_text(kGrid, checks(), Details::kAll) == table + "\nblends: mixed cells\n  cell\n");
}

TEST_CASE("a text of what is not fine has 20 lines at most, whatever is broken") {
  for (const std::size_t good : {0, 8, 14})
    for (const int bad : {1, 2, 5, 9}) {
      std::vector<Check> rows(good, checks()[0]);
      for (int i = 0; i < bad; ++i) {
        rows.push_back(checks()[1]);
        rows.back().name = "bad-" + std::to_string(i);
      }
      const std::string text = report_text(kGrid, rows, Details::kNotFine);
      const std::string all = report_text(kGrid, rows, Details::kAll);
      CAPTURE(text);
      CHECK(std::count(text.begin(), text.end(), '\n') <= 20);
      std::size_t named = 0;
      for (int i = 0; i < bad; ++i) {
        CHECK(text.find("\nbad-" + std::to_string(i) + " ") != text.npos);
        named += text.find("\nbad-" + std::to_string(i) + ": levels") != text.npos;
      }
      CHECK(named >= std::min<std::size_t>(3, static_cast<std::size_t>(bad)));
      // Which lines there are beside them, or none.
      CHECK((text.find(" more lines with -v)\n") != text.npos) == (text.size() < all.size()));
      CHECK((good < 14 || text.find("others") == text.npos || text.find("14 checks") != text.npos));
    }
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
  const auto json = nlohmann::json::parse(report_json(reported(grid), checks()));
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
  CHECK(report_text(reported(grid), {}, Details::kAll).substr(0, 5) == "bad?:");
}
