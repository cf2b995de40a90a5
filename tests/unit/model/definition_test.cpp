#include "libcore/model/definition.hpp"

#include "libcore/base/error.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

const std::string kDefinition = R"(
[model]
plugin = "some-model"
[model.parameters]
stiffness = 2
[model.files]
shape = "a.xyz"
paths = ["b.xyz", "c.xyz"]
[grid]
origin = [0, 0, 0]
spacing = 1
counts = [2, 2, 2]
)";

std::string contents_of(const std::string& file) { return "contents of " + file; }

}  // namespace

TEST_CASE("files become parameters with their contents") {
  const Definition d = read_definition(kDefinition, "some.toml", {}, contents_of);
  const std::vector<Parameter> expected{
      {"paths", std::vector<std::string>{"contents of b.xyz", "contents of c.xyz"}},
      {"shape", std::string("contents of a.xyz")},
      {"stiffness", 2.0}};
  CHECK(d.parameters == expected);
  // An override names another file, and what reading one throws comes through.
  CHECK(read_definition(kDefinition, "some.toml", {"model.files.shape=z.xyz"}, contents_of)
            .parameters[1] == Parameter{"shape", std::string("contents of z.xyz")});
  const auto fails = [](const std::string& file) -> std::string { throw Error(file + ": gone"); };
  CHECK_THROWS_WITH(read_definition(kDefinition, "some.toml", {}, fails), "b.xyz: gone");
}

TEST_CASE("what toml++ stumbles over is refused, or read") {
  const auto read = [](const std::string& first_lines) {
    return read_definition(first_lines + kDefinition, "some.toml", {}, contents_of);
  };
  for (const char* text :
       {"[[[a]]]\n", "[ # no key\n", "[[", "[\t\n", "größe = 1\n", "a = ü\n", "[ä]\n", "[[ü]]\n",
        "a = 1 ö", "a\u00A0= 1\n", "a = [1,\n ö]\n", "a = \"\"\"\\ö\"\"\"\n",
        "a = \"\"\"\n\xff\"\"\"\n", "\"\"\"a\"\"\"\"\"\" = ä", "a = '''ä''''''ä", "a = \"\\",
        "a = \"\"\"\\"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(read(text), Error);
  }
  CHECK_THROWS_AS(read({'[', '\0'}), Error);
  CHECK_THROWS_WITH(read("\n\"ö\" = 1\nö = 1\n"),
                    "some.toml: line 3: a letter that is not ASCII is outside of quotes");
  // What only looks like it: a list in a list, the mark of an order of bytes, letters in quotes and
  // comments.
  for (const char* text :
       {"s = [\n[[1]]\n]\n", "\uFEFFs = 'ü\"' # ü '\n", "s = ['''ü''''', \"ü\\\"\"] # ö\n"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(read(text), Catch::Matchers::ContainsSubstring("unknown key s"));
  }
  // A text may go on with any letter behind a line that ends with a backslash.
  std::string lines = kDefinition;
  lines.replace(lines.find("= 2"), 3, "= \"\"\"\\\n § \"ö\\\r\n\t😀\\\"\"\"\"\"");
  const Definition d =
      read_definition(lines, "some.toml", {"model.parameters.word=ö"}, contents_of);
  CHECK(d.parameters[2] == Parameter{"stiffness", std::string("§ \"ö😀\"\"")});
  CHECK(d.parameters[3] == Parameter{"word", std::string("ö")});
}
