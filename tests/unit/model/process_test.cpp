#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/model/process_model.hpp"
#include "libcore/model/protocol.hpp"

using namespace hapgrid;

namespace {

const std::string kProcesses = HAPGRID_SOURCE_DIR "/tests/unit/model/processes";
constexpr double kSeconds = 30;  // far beyond what any answer takes

std::vector<std::string> puppet(const std::string& fault, const std::string& at = "1") {
  return {"python3", "puppet.py", fault, at};
}

std::unique_ptr<Model> create(std::vector<std::string> words, unsigned in_flight = 4,
                              double timeout = kSeconds, double start_timeout = kSeconds) {
  return ProcessSource("puppet", std::move(words), kProcesses, {timeout, in_flight, start_timeout})
      .create({});
}

template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const ModelError& e) {
    return e.what();
  }
  return "(nothing was refused)";
}

/// The states of `count` conversions from states with s[0] = 0, 1, 2, ...; an error where one
/// failed.
struct Run {
  std::vector<double> rows;
  std::vector<std::string> errors;
  unsigned failures = 0;
};
Run convert(Model& model, std::size_t count) {
  Run run{std::vector<double>(2 * count), std::vector<std::string>(count), 0};
  std::vector<double> states(2 * count);
  for (std::size_t i = 0; i < count; ++i) states[2 * i] = static_cast<double>(i);
  std::size_t next = 0;
  std::vector<int> done(count);
  model.convert_all(
      [&](Conversion& conversion, bool) {
        if (next == count) return false;
        conversion = {&states[2 * next], {1, 1, 3}, {0.5, 0, 0}, &run.rows[2 * next], next};
        return ++next, true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        ++done[conversion.tag];
        run.errors[conversion.tag] = error;
        run.failures += !error.empty();
      });
  for (const int times : done) REQUIRE(times == 1);
  return run;
}

/// No child is left, not even a dead one.
bool no_children() { return ::waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD; }

Answer answer(const std::string& line) {
  Answer a;
  read_answer(line, a);
  return a;
}

}  // namespace

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

TEST_CASE("an answer is taken apart") {
  const Answer a = answer(
      R"( {"shape": [1, 2, 3], "s": [1, -0, 2.5e0], "note": [{"s": [9], "id": 1}], "id": 12,
          "force": [0, 0.5, -1], "energy": -3} )");
  CHECK(a.id == 12);
  CHECK(a.s == std::vector<double>{1, 0, 2.5});
  CHECK(std::signbit(a.s[1]));
  CHECK_FALSE(std::signbit(answer(R"({"id": 1, "s": [0]})").s[0]));
  CHECK(a.force == std::vector<double>{0, 0.5, -1});
  CHECK(a.energy == std::vector<double>{-3});
  CHECK(a.shape == std::vector<double>{1, 2, 3});
  const Answer known = answer(R"({"id": 0, "states": [[1, 2], [], [3]]})");
  CHECK(known.states == std::vector<double>{1, 2, 3});
  CHECK(known.states_sizes == std::vector<std::uint32_t>{2, 0, 1});
  CHECK(answer(R"({"id": 3, "error": "a\nb"})").error == "a b");
}

TEST_CASE("hostile answers are refused in one line") {
  for (const char* line : {"",
                           " ",
                           "{",
                           "}",
                           "[]",
                           "1",
                           "null",
                           "\"s\"",
                           "[{\"id\": 1}]",
                           "{\"id\": 1}{",
                           "{\"id\": 1} x",
                           "{}",
                           "{\"id\": -1}",
                           "{\"id\": 1.5}",
                           "{\"id\": \"1\"}",
                           "{\"id\": 99999999999999999999999}",
                           "{\"id\": [1]}",
                           "{\"id\": 1, \"s\": 1}",
                           "{\"id\": 1, \"s\": [[1]]}",
                           "{\"id\": 1, \"s\": [1, null]}",
                           "{\"id\": 1, \"s\": [true]}",
                           "{\"id\": 1, \"s\": [\"1\"]}",
                           "{\"id\": 1, \"s\": [{}]}",
                           "{\"id\": 1, \"s\": {\"s\": 1}}",
                           "{\"id\": 1, \"s\": [NaN]}",
                           "{\"id\": 1, \"s\": [1e999]}",
                           "{\"id\": 1, \"energy\": [1]}",
                           "{\"id\": 1, \"states\": [1]}",
                           "{\"id\": 1, \"states\": [[[1]]]}",
                           "{\"id\": 1, \"error\": 3}",
                           "{\"id\": 1, \"error\": null}",
                           "\xff\xfe",
                           "{\"id\": 1, \"x\": \"\xff\"}"}) {
    const std::string why = refusal([&] { answer(line); });
    CAPTURE(line);
    CHECK((why.starts_with("answered '") || why.starts_with("printed '")));
    CHECK(why.find('\n') == std::string::npos);
  }
  CHECK(refusal([] { answer(std::string(1000000, '[')); }).size() < 600);
  CHECK(refusal([] { answer("{\"x\":" + std::string(1000000, '[')); }).size() < 600);
  const auto nested = [](std::size_t depth) {
    return "{\"id\": 1, \"note\": " + std::string(depth, '[') + std::string(depth, ']') + "}";
  };
  CHECK(answer(nested(63)).id == 1);
  CHECK(refusal([&] { answer(nested(64)); }).find("nested deeper than 64 levels") !=
        std::string::npos);

  ModelInfo d;
  d.state_size = 2;
  d.stored = {true, true, true};
  d.spheres.resize(1);
  std::vector<double> row(d.row_size());
  const std::string good =
      R"({"id": 1, "s": [1, 2], "force": [3, 4, 5], "energy": 6, "shape": [7, 8, 0.1]})";
  take_row(answer(good), d, Operation::kConvert, row.data());
  CHECK(row == std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 0.1F});
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    line.replace(line.find(from), from.size(), to);
    return refusal([&] { take_row(answer(line), d, Operation::kConvert, row.data()); });
  };
  CHECK(refused("[1, 2]", "[1]") == "an answer with 1 numbers in \"s\", not 2");
  CHECK(refused("[1, 2]", "[1, 2, 3]") == "an answer with 3 numbers in \"s\", not 2");
  CHECK(refused("\"s\"", "\"S\"") == "an answer with 0 numbers in \"s\", not 2");
  CHECK(refused(", 5]", "]") == "an answer with 2 numbers in \"force\", not 3");
  CHECK(refused("\"energy\": 6", "\"e\": 6") == "an answer with 0 numbers in \"energy\", not 1");
  CHECK(refused("0.1", "0.1, 1") == "an answer with 4 numbers in \"shape\", not 3");
  CHECK(refused("0.1", "1e39") == "an answer with a centre in \"shape\" that is too large");
}

TEST_CASE("what a model says of itself") {
  const std::string good =
      R"({"hapgrid": 1, "state_size": 2, "d_max": 1, "tolerance": 0.5, "norm": "rms",
          "weights": [1, 0.5], "tolerance_unit": "rad", "stored": ["shape", "force"],
          "spheres": [{"radius": 1, "colour": [1, 0, 0.5], "label": "C"}, {"radius": 0}]})";
  const ModelInfo d = read_first_line(good);
  CHECK(d.equality == Equality{Equality::Norm::kRms, {1, 0.5}});
  CHECK(d.stored == Stored{true, false, true});
  CHECK(d.spheres.size() == 2);
  CHECK(d.spheres[0].label == "C");
  CHECK(d.row_size() == 2 + 3 + 6);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    const std::size_t at = line.find(from);
    REQUIRE(at != line.npos);
    line.replace(at, from.size(), to);
    return refusal([&] { read_first_line(line); });
  };
  CHECK(refused("\"hapgrid\": 1", "\"hapgrid\": 2") ==
        "it speaks version 2 of the protocol, this hapgrid speaks 1");
  CHECK(refused("\"hapgrid\": 1", "\"hapgrid\": \"1\"").find("it speaks version") == 0);
  CHECK(refused("\"hapgrid\": 1, ", "").find("its first line has no \"hapgrid\"") == 0);
  CHECK(refused("\"norm\"", "\"Norm\"").find("unknown key \"Norm\" in its first line (known: ") ==
        0);
  CHECK(refused("\"state_size\": 2, ", "") == "its first line has no \"state_size\"");
  CHECK(refused("\"state_size\": 2", "\"state_size\": 0").find("\"state_size\" must be") == 0);
  CHECK(refused("\"state_size\": 2", "\"state_size\": 1.5").find("\"state_size\" must be") == 0);
  CHECK(refused("\"state_size\": 2", "\"state_size\": 1e9").find("\"state_size\" must be") == 0);
  CHECK(refused("\"d_max\": 1", "\"d_max\": 0") == "d_max is not positive");
  CHECK(refused("\"d_max\": 1", "\"d_max\": NaN").find("its first line is no JSON: ") == 0);
  CHECK(refused("0.5, \"norm", "-1, \"norm") == "the tolerance is negative or not finite");
  CHECK(refused("rms", "mean") == "\"norm\" must be \"max\" or \"rms\"");
  CHECK(refused("[1, 0.5]", "[1]").find("\"weights\" must be 2 numbers") == 0);
  CHECK(refused("[1, 0.5]", "[1, -1]").find("\"weights\" must be 2 numbers") == 0);
  CHECK(refused("[1, 0.5]", "[1, \"a\"]") == "\"weights\" must be an array of numbers");
  CHECK(refused("\"rad\"", "\"0123456789abcdef\"") == "\"tolerance_unit\" has more than 15 bytes");
  CHECK(refused("\"shape\", ", "") == "\"spheres\" and the \"shape\" in \"stored\" go together");
  CHECK(refused("\"shape\", ", "\"colour\", ").find("\"stored\" must be an array of") == 0);
  CHECK(refused("{\"radius\": 0}", "0") == "\"spheres\" must be an array of objects");
  CHECK(refused("{\"radius\": 0}", "{\"radius\": -1}") ==
        "a sphere whose radius is negative or not finite");
  CHECK(refused("[1, 0, 0.5]", "[1, 0, 2]") == "a sphere's colour is not within 0 and 1");
  CHECK_THROWS_AS(read_first_line(R"({"error": "no"})"), RefusedError);
  // The message would repeat the version, level by level.
  for (const std::size_t depth : {64, 20'000, 10'000'000})
    CHECK(refused("\"hapgrid\": 1",
                  "\"hapgrid\": " + std::string(depth, '[') + std::string(depth, ']')) ==
          "its first line nests deeper than 64 levels");
  CHECK(refused("\"hapgrid\": 1", "\"hapgrid\": " + std::string(63, '[') + std::string(63, ']'))
            .starts_with("it speaks version [[["));
  CHECK(refusal([] { read_first_line("{\"a\""); }).starts_with("its first line is no JSON: "));
  CHECK(
      refusal([] { read_first_line("hello"); }).starts_with("printed 'hello' to standard output"));
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
  CHECK(equal({kMax, {}}, 0.4, a, b));
  CHECK_FALSE(equal({kMax, {}}, 0.39, a, b));
  CHECK(equal({kMax, {1, 0.5}}, 0.3, a, b));
  CHECK(equal({kRms, {}}, 0.3536, a, b));
  CHECK_FALSE(equal({kRms, {}}, 0.3535, a, b));
  CHECK(equal({kRms, {0, 1}}, 0.2829, a, b));
  CHECK_FALSE(equal({kMax, {}}, 1e300, a, c));
  CHECK_FALSE(equal({kRms, {}}, 1e300, a, c));
}

TEST_CASE("a grid's model without its process can judge and nothing else") {
  GridSpec spec;
  spec.equality.norm = Equality::Norm::kMax;
  auto model = declared_model(spec);
  const double s = 0;
  double row = 1;
  CHECK_FALSE(model->has_force());
  CHECK_FALSE(model->convert(&s, {0, 0, 0}, {0, 0, 0}, &row));
  CHECK(model->error() == "this model's process was not started");
  CHECK_THROWS_AS(model->known_states({0, 0, 0}), ModelError);
}

TEST_CASE("what is reached depends on no fault that passes, and no order of answers") {
  auto good = create(puppet(""), 1);
  const Run expected = convert(*good, 200);
  REQUIRE(expected.failures == 0);
  CHECK(expected.rows[2 * 7] == 7);
  CHECK(expected.rows[2 * 7 + 1] == 1.5);
  CHECK(good->known_states({4, 0, 0}) == std::vector<double>{0.5, 4});
  for (const char* fault : {"", "reverse", "chatty"})
    for (const unsigned in_flight : {1u, 4u, 64u}) {
      auto model = create(puppet(fault), in_flight);
      CHECK(convert(*model, 200).rows == expected.rows);
    }
  for (const char* fault : {"die", "crash", "id", "number", "short", "long", "nan"}) {
    CAPTURE(fault);
    auto model = create(puppet(fault, "50"));
    const Run run = convert(*model, 200);
    CHECK(run.failures == 0);
    CHECK(run.rows == expected.rows);
  }
  for (const char* fault : {"hang", "close"}) {
    auto model = create(puppet(fault, "90"), 4, 0.5);
    CHECK(convert(*model, 200).rows == expected.rows);
  }
}

TEST_CASE("a question that kills every process fails alone, after three attempts") {
  auto model = create(puppet("poison", "17.5"));
  const Run run = convert(*model, 20);
  CHECK(run.failures == 2);
  for (const std::size_t i : {18, 19})
    CHECK(run.errors[i] ==
          "process 'python3 puppet.py poison 17.5' exited with status 9; asked 3 times");
  CHECK(run.rows[2 * 17] == 17);
  // The next process is a good one.
  CHECK(model->known_states({4, 0, 0}) == std::vector<double>{0.5, 4});
}

TEST_CASE("what became of a process is said") {
  const auto error = [](const std::string& fault, double timeout = kSeconds) {
    auto model = create(puppet(fault), 4, timeout);
    return convert(*model, 1).errors[0];
  };
  const auto ends = [](const std::string& fault, const std::string& what) {
    return Catch::Matchers::Equals("process 'python3 puppet.py " + fault + " 1' " + what +
                                   "; asked 3 times");
  };
  CHECK_THAT(error("die"), ends("die", "exited with status 7"));
  CHECK_THAT(error("crash"), ends("crash", "was killed by signal 11 (Segmentation fault)"));
  CHECK_THAT(error("hang", 0.3), ends("hang", "gave no answer within 0.3 s"));
  CHECK_THAT(error("close"), ends("close", "closed its standard output and stayed"));
  CHECK_THAT(error("id"), ends("id", "answered a question 4000000000 that it does not have"));
  CHECK_THAT(error("short"), ends("short", "an answer with 1 numbers in \"s\", not 2"));
  CHECK_THAT(error("huge"), ends("huge", "wrote a line of more than 4224 bytes"));
  CHECK(error("fail") == "told to fail");
}

TEST_CASE("a process that says itself what is wrong is asked once") {
  const auto errors = [](const std::string& fault) {
    auto model = create(puppet(fault, "3"), 1);
    const Run run = convert(*model, 20);
    CHECK(run.rows[2 * 1 + 1] == 1.5);  // answered before
    CHECK(run.errors[1].empty());
    return run.errors[2];
  };
  CHECK(errors("raise") ==
        "process 'python3 puppet.py raise 3' exited with status 1: KeyError: 'gone'");
  const std::string stray =
      " to standard output, which is for its answers: what a model prints must go to standard "
      "error, in Python with print(..., file=sys.stderr) in place of print()";
  CHECK(errors("garbage") ==
        "process 'python3 puppet.py garbage 3' printed 'Segmentation fault "
        "(core dumped)'" +
            stray);
  CHECK(errors("html") == "process 'python3 puppet.py html 3' printed '[{\"id\": 1}]'" + stray);
  for (const char* line : {"5", "{'id': 1}", "hello {\"id\": 1}", "{", "", "nan"})
    CHECK_THROWS_AS(answer(line), LastingError);
  CHECK_NOTHROW(answer(" { \"id\": 1}"));
}

TEST_CASE("a process that does not get as far as saying what it is") {
  const auto why = [](std::vector<std::string> words, double timeout = kSeconds) {
    return refusal([&] { create(std::move(words), 4, timeout, timeout); });
  };
  const std::string who = "model puppet: process 'python3 puppet.py ";
  CHECK(why(puppet("version")) ==
        who + "version 1' it speaks version 2 of the protocol, this hapgrid speaks 1");
  CHECK(why(puppet("unknown-key")).find(who + "unknown-key 1' unknown key \"tolerence\"") == 0);
  CHECK(why(puppet("no-size")) == who + "no-size 1' its first line has no \"state_size\"");
  CHECK(why(puppet("refuse")) == "model puppet: no way");
  CHECK(why(puppet("mute"), 0.5) == who + "mute 1' did not say what it is within 0.5 s");
  CHECK(why(puppet("dead")) == who + "dead 1' exited with status 5 before it had said what it is");
  CHECK(why(puppet("binary"))
            .starts_with(who + "binary 1' printed '?"
                               "?' to standard output, "));
  CHECK(why(puppet("import")) ==
        who +
            "import 1' exited with status 1 before it had said what it is: "
            "ModuleNotFoundError: No module named 'no_such_module'");
  CHECK(why({"no-such-program", "x"}) ==
        "model puppet: process 'no-such-program x' cannot be started: no program no-such-program "
        "in PATH");
  CHECK(why({"./puppet.py"})
            .find("model puppet: process './puppet.py' cannot be started in " + kProcesses +
                  ": Permission denied") == 0);
  CHECK(why({"./nothing"}).find("No such file or directory") != std::string::npos);
  CHECK(why({"true"}) ==
        "model puppet: process 'true' exited with status 0 before it had said what it is");
}

TEST_CASE("no process is left, not even one that does not want to end") {
  using Clock = std::chrono::steady_clock;
  {
    auto model = create(puppet("slow-end"));
    CHECK(convert(*model, 3).failures == 0);
    const auto begin = Clock::now();
    model = create(puppet(""));
    CHECK(Clock::now() - begin < std::chrono::seconds(10));
  }
  CHECK(no_children());
}

TEST_CASE("copies of a model start when they are asked, and must say the same") {
  const ProcessSource source("puppet", puppet("late-start"), kProcesses, {kSeconds, 4});
  auto first = source.create({});
  auto second = source.create({});
  CHECK(second->state_size() == 2);
  CHECK(convert(*first, 10).rows == convert(*second, 10).rows);
}
