// The lines of a model process (libcore/model/protocol.hpp).
#include "libcore/model/protocol.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("numbers read back to the same double and are never taken for whole ones") {
  const auto text = [](double value) {
    std::string t;
    append_number(t, value);
    return t;
  };
  CHECK(text(0) == "0.0");
  CHECK(text(-0.0) == "-0.0");
  CHECK(text(1) == "1.0");
  CHECK(text(0.1) == "0.1");
  CHECK(text(1e300) == "1e+300");
  CHECK(text(123456789012345680.0).find_first_of(".e") != std::string::npos);
  CHECK(text(5e-324) == "5e-324");
  std::string line;
  const double s[] = {-0.0, 0.5};
  append_question(line, 7, Operation::kConvert, 2, s, {1, 2, 3}, {0, 0, 0.25});
  CHECK(line ==
        "{\"id\": 7, \"op\": \"convert\", \"s\": [-0.0, 0.5], \"x\": [1.0, 2.0, 3.0], "
        "\"d\": [0.0, 0.0, 0.25]}\n");
}

TEST_CASE("an answer is read") {
  const Answer a = read_answer(
      R"( {"shape": [1, 2, 3], "s": [1, -0, 2.5e0], "note": [{"s": [9], "id": 1}], "id": 12,
          "force": [0, 0.5, -1], "energy": -3} )");
  CHECK(a.id == 12);
  CHECK(a.s == std::vector<double>{1, 0, 2.5});
  CHECK(std::signbit(a.s[1]));
  CHECK_FALSE(std::signbit(read_answer(R"({"id": 1, "s": [0]})").s[0]));
  CHECK(a.force == std::vector<double>{0, 0.5, -1});
  CHECK(a.energy == std::vector<double>{-3});
  CHECK(a.shape == std::vector<double>{1, 2, 3});
  const Answer known = read_answer(R"({"id": 0, "states": [[1, 2], [], [3]]})");
  CHECK(known.states == std::vector<std::vector<double>>{{1, 2}, {}, {3}});
  CHECK(read_answer(R"({"id": 3, "error": "a\nb"})").error == "a b");
}

TEST_CASE("hostile answers are refused in one line") {
  for (const char* line :
       {"", "{", "1", "{\"id\": 1} x", "{}", "{\"id\": -1}", "{\"id\": 1.5}",
        "{\"id\": 99999999999999999999999}", "{\"id\": 1, \"s\": 1}", "{\"id\": 1, \"s\": [[1]]}",
        "{\"id\": 1, \"s\": [1, null]}", "{\"id\": 1, \"s\": {\"s\": 1}}",
        "{\"id\": 1, \"s\": [NaN]}", "{\"id\": 1, \"s\": [1e999]}", "{\"id\": 1, \"energy\": [1]}",
        "{\"id\": 1, \"states\": [[[1]]]}", "{\"id\": 1, \"error\": 3}",
        "{\"id\": 1, \"x\": \"\xff\"}"}) {
    const std::string why = refusal([&] { read_answer(line); });
    CAPTURE(line);
    CHECK((why.starts_with("answered '") || why.starts_with("printed '")));
    CHECK(why.find('\n') == std::string::npos);
  }
  CHECK(refusal([] { read_answer(std::string(1000000, '[')); }).size() < 600);
  CHECK(refusal([] { read_answer("{\"x\":" + std::string(1000000, '[')); }).size() < 600);
  const auto nested = [](std::size_t depth) {
    return "{\"id\": 1, \"note\": " + std::string(depth, '[') + std::string(depth, ']') + "}";
  };
  CHECK(read_answer(nested(63)).id == 1);
  CHECK(refusal([&] { read_answer(nested(64)); }).find("nested deeper than 64 levels") !=
        std::string::npos);

  ModelInfo d;
  d.state_size = 2;
  d.stored = {true, true, true};
  d.spheres.resize(1);
  std::vector<double> row(d.row_size());
  const std::string good =
      R"({"id": 1, "s": [1, 2], "force": [3, 4, 5], "energy": 6, "shape": [7, 8, 0.1]})";
  write_row(read_answer(good), d, Operation::kConvert, row.data());
  CHECK(row == std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 0.1F});
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    line.replace(line.find(from), from.size(), to);
    return refusal([&] { write_row(read_answer(line), d, Operation::kConvert, row.data()); });
  };
  CHECK(refused("[1, 2]", "[1]") == "an answer with 1 numbers in \"s\", not 2");
  CHECK(refused("\"energy\": 6", "\"e\": 6") == "an answer with 0 numbers in \"energy\", not 1");
  CHECK(refused("0.1", "0.1, 1") == "an answer with 4 numbers in \"shape\", not 3");
  CHECK(refused("0.1", "1e39") == "an answer with a centre in \"shape\" that is too large");
}

// tests/cli/process/refuse.sh has first lines that are refused.
TEST_CASE("what a model says of itself") {
  const std::string good =
      R"({"hapgrid": 1, "state_size": 2, "d_max": 1, "tolerance": 0.5, "norm": "rms",
          "weights": [1, 0.5], "tolerance_unit": "rad", "stored": ["shape", "force"],
          "version": "2.1", "in_flight": 26,
          "spheres": [{"radius": 1, "colour": [1, 0, 0.5], "label": "C"}, {"radius": 0}]})";
  const ModelInfo d = read_first_line(good);
  CHECK(d.equality == Equality{Equality::Norm::kRms, {1, 0.5}, {}});
  CHECK(d.stored == Stored{true, false, true});
  CHECK(d.spheres.size() == 2);
  CHECK(d.spheres[0].label == "C");
  CHECK(d.row_size() == 2 + 3 + 6);
  CHECK(d.version == "2.1");
  CHECK(d.in_flight == 26);
}

TEST_CASE("parameters that JSON cannot express") {
  CHECK(handshake_line({{"a.b", 1.0}, {"c", std::vector<std::string>{"x"}}, {"d", true}}) ==
        "{\"hapgrid\":1,\"parameters\":{\"a.b\":1.0,\"c\":[\"x\"],\"d\":true}}\n");
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(refusal([&] {
          handshake_line({{"a", inf}});
        }) == "parameter a is not finite, which JSON cannot express");
  CHECK(refusal([&] {
          handshake_line({{"a", std::vector<double>{0, -inf}}});
        }) == "parameter a is not finite, which JSON cannot express");
  CHECK(refusal([] {
          handshake_line({{"a", std::string("\xff")}});
        }) == "a parameter's text is no UTF-8, which JSON cannot express");
}

TEST_CASE("the tolerance function in words") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double a[] = {0, 0}, b[] = {0.3, 0.4}, c[] = {0, nan};
  const auto equal = [&](Equality e, double tolerance, const double* x, const double* y) {
    GridSpec spec;
    spec.state_size = 2;
    spec.tolerance = tolerance;
    spec.equality = std::move(e);
    return declared_model(spec)->equal(x, y);
  };
  using enum Equality::Norm;
  CHECK(equal({kMax, {}, {}}, 0.4, a, b));
  CHECK_FALSE(equal({kMax, {}, {}}, 0.39, a, b));
  CHECK(equal({kMax, {1, 0.5}, {}}, 0.3, a, b));
  CHECK(equal({kRms, {}, {}}, 0.3536, a, b));
  CHECK_FALSE(equal({kRms, {}, {}}, 0.3535, a, b));
  CHECK(equal({kRms, {0, 1}, {}}, 0.2829, a, b));
  CHECK_FALSE(equal({kMax, {}, {}}, 1e300, a, c));
  CHECK_FALSE(equal({kRms, {}, {}}, 1e300, a, c));
}
