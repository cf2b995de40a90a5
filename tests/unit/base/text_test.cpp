#include "libcore/base/text.hpp"

#include <clocale>

#include "libcore/base/json.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

std::string digits17(double value) {
  std::string text;
  append_digits17(text, value);
  return text;
}

}  // namespace

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
  CHECK(printable_line("a b~") == "a b~");
  CHECK(printable_line("\x1b[2J\n\x7f") == " [2J  ");
  CHECK(printable_line("\xc3\xa9 \xe2\x88\x92") == "\xc3\xa9 \xe2\x88\x92");
  CHECK(printable_line("\xc2\x9b"
                       "2J \xff \xc3") == "?2J ? ?");  // CSI in eight bits; no UTF-8
  CHECK(printable_line("abcd", 3) == "abc");
  CHECK(printable_line("\xc2\x85\xe2\x80\xae|\xe2\x80\xa8|\xef\xbb\xbf|\xe2\x80\x8b") ==
        "??|?|?|?");
  CHECK(printable_line("\xf3\xa0\x80\x81|\xc2\xad") == "?|?");  // a tag, a soft hyphen
  // Overlong, a surrogate, beyond Unicode.
  CHECK(printable_line("\xe0\x80\xaf|\xed\xa0\x80|\xf4\x90\x80\x80|\xf0\x82\x82\xac") ==
        "???|???|????|????");
  CHECK(printable_line("\xf0\x9f\x98\x80\xe6\xbc\xa2\xef\xbf\xbd") ==
        "\xf0\x9f\x98\x80\xe6\xbc\xa2\xef\xbf\xbd");
  CHECK(printable_line("\xf3\xa0\x84\x80|\xe3\x85\xa4|\xcd\x8f|\xcd\xb8") ==
        "?|?|?|?");                                   // ignorable, and none
  CHECK(printable_line("e\xcc\x81") == "e\xcc\x81");  // an accent of its own
  CHECK(printable_text("a\033\n\n\xe2\x80\xae"
                       "b") == "a \n\n?b");
}

TEST_CASE("JSON that nests too deep is known before it is parsed") {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  CHECK_FALSE(nests_too_deep(nested(kMaxJsonDepth)));
  CHECK(nests_too_deep(nested(kMaxJsonDepth + 1)));
  CHECK(nests_too_deep("}}}" + std::string(kMaxJsonDepth + 1, '{')));
  CHECK_FALSE(nests_too_deep(nested(kMaxJsonDepth) + nested(kMaxJsonDepth)));
  // Brackets in texts do not count, and a text can contain a quote.
  CHECK_FALSE(nests_too_deep('"' + nested(100) + '"'));
  CHECK_FALSE(nests_too_deep(R"("\")" + nested(100) + '"'));
  CHECK(nests_too_deep(R"("\\")" + nested(100) + '"'));
  CHECK_FALSE(nests_too_deep("\"\\"));
}

TEST_CASE("a unit behind a number is in the singular behind 1") {
  CHECK(counted_unit("rope lengths", 1) == "rope length");
  CHECK(counted_unit("N rope lengths", 1) == "N rope length");
  CHECK(counted_unit("rope lengths", 2) == "rope lengths");
  CHECK(counted_unit("inches", 1) == "inch");
  for (const char* const same : {"", "s", "mm", "kJ/mol", "ball radius", "N/axis", "glass"})
    CHECK(counted_unit(same, 1) == same);
  CHECK(counted_unit("angstrom", 1) == "Å");
}
