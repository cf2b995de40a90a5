#include "libcore/base/text.hpp"
#include "libcore/check/text.hpp"

#include <catch2/catch.hpp>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libcore/check/dump.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

std::string digits17(double value) {
  std::string text;
  append_digits17(text, value);
  return text;
}

}  // namespace

TEST_CASE("17 digits are printf's in the C locale") {
  for (const double value : {0.0, -0.0, 0.1, 1.0, -1.0 / 3, 1e-6, 6.02214076e23, 5e-324,
                             std::numeric_limits<double>::max(), std::nextafter(1.0, 2.0)}) {
    char expected[64];
    std::snprintf(expected, sizeof expected, "%.17g", value);
    CHECK(digits17(value) == expected);
  }
}

TEST_CASE("numbers do not depend on the locale") {
  const std::string old = std::setlocale(LC_ALL, nullptr);
  const char* comma = nullptr;
  for (const char* name : {"de_DE.UTF-8", "cs_CZ.UTF-8", "fr_FR.UTF-8", "de_DE", "cs_CZ"})
    if (!comma) comma = std::setlocale(LC_ALL, name);
  if (!comma) WARN("no locale with a decimal comma is installed: only the C locale is tested");
  CHECK(digits17(0.5) == "0.5");
  CHECK(rounded(0.0250000000000001) == "0.025");
  CHECK(rounded(1e-6) == "1e-06");
  CHECK(fixed(1.0315, 3) == "1.032");
  CHECK(fixed(std::numeric_limits<double>::max(), 2).size() == 312);
  std::setlocale(LC_ALL, old.c_str());
}

TEST_CASE("hostile strings become printable") {
  CHECK(printable("a b~") == "a b~");
  CHECK(printable("\x1b[2J\n\x7f\xc3\xa9") == "?[2J????");
}

TEST_CASE("long states are shortened") {
  CHECK(state_text(std::vector<double>{0.5}) == "0.5");
  CHECK(state_text(std::vector<double>{1, 2}) == "(1, 2)");
  CHECK(state_text(std::vector<double>{1, 2, 3, 4, 5}) == "(1, 2, 3, 4, ...)");
}

TEST_CASE("the dump, literally") {
  std::string text;
  const Grid grid = tiny::grid();
  for (RecordIndex r = 0; r < 2; ++r) append_record(text, grid, r);
  append_record(text, tiny::after_one_round(), 1);
  const std::string twelve = "\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-";
  CHECK(text == "0\t0\t0\t0\t0" + twelve + "\t-\t0" + twelve + "\n" + "1\t0\t0\t0\t1" + twelve +
                    "\t0\t1" + twelve + "\n" + "1\t0\t0\t0\t1" + twelve + "\t?\t?" + twelve + "\n");
}

TEST_CASE("a dump of several components, with all their digits") {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, {1, 1, 1}};
  spec.state_size = 2;
  RecordColumns records{{0}, {0}, {0}, {0.1, -2.5}, std::vector<Level>(26, kLeavesBox)};
  std::string text;
  append_record(text, Grid(spec, 1, records), 0);
  CHECK(text.substr(0, 35) == "0\t0\t0\t0\t0.10000000000000001\t-2.5\t-\t");
}
