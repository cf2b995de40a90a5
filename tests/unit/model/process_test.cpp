#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "libcore/model/process_model.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

const std::string kProcesses = HAPGRID_SOURCE_DIR "/tests/unit/model/processes";
constexpr double kSeconds = 30;  // far beyond what any answer takes

std::vector<std::string> puppet(const std::string& fault, const std::string& at = "1") {
  return {"python3", "puppet.py", fault, at};
}

std::unique_ptr<Model> create(std::vector<std::string> words, double timeout = kSeconds,
                              double start_timeout = kSeconds) {
  return ProcessSource("puppet", std::move(words), kProcesses, {timeout, start_timeout}).create({});
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

}  // namespace

TEST_CASE("what is reached depends on no fault that passes, and no order of answers") {
  auto good = create({"python3", "puppet.py", "", "1", "in_flight=1"});
  const Run expected = convert(*good, 110);
  REQUIRE(expected.failures == 0);
  CHECK(expected.rows[2 * 7] == 7);
  CHECK(expected.rows[2 * 7 + 1] == 1.5);
  CHECK(good->known_states({4, 0, 0}) == std::vector<double>{0.5, 4});
  for (const char* fault : {"", "reverse", "chatty"})
    for (const char* in_flight : {"in_flight=1", "in_flight=4", "in_flight=64"}) {
      auto model = create({"python3", "puppet.py", fault, "1", in_flight});
      CHECK(convert(*model, 110).rows == expected.rows);
    }
  for (const char* fault : {"die", "crash", "id", "number", "short", "long", "nan"}) {
    CAPTURE(fault);
    auto model = create(puppet(fault, "50"));
    const Run run = convert(*model, 110);
    CHECK(run.failures == 0);
    CHECK(run.rows == expected.rows);
  }
  for (const char* fault : {"hang", "close"}) {
    auto model = create(puppet(fault, "90"), 0.5);
    CHECK(convert(*model, 110).rows == expected.rows);
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
  const std::pair<std::string, std::string> faults[] = {
      {"die", "exited with status 7"},
      {"crash", "was killed by signal 11 (Segmentation fault)"},
      {"hang", "gave no answer within 0.3 s"},
      {"close", "closed its standard output and stayed"},
      {"id", "answered a question 4000000000 that it does not have"},
      {"short", "an answer with 1 numbers in \"s\", not 2"},
      {"huge", "wrote a line of more than 4224 bytes"}};
  const auto error = [](const std::string& fault) {
    auto model = create(puppet(fault), fault == "hang" ? 0.3 : kSeconds);
    return convert(*model, 1).errors[0];
  };
  for (const auto& [fault, what] : faults)
    CHECK(error(fault) ==
          "process 'python3 puppet.py " + fault + " 1' " + what + "; asked 3 times");
  CHECK(error("fail") == "told to fail");
  CHECK(error("garbage").find("' printed 'Segmentation fault (core dumped)' to standard output") !=
        std::string::npos);
}

TEST_CASE("a process that does not get as far as saying what it is") {
  const auto why = [](std::vector<std::string> words, double timeout = kSeconds) {
    return refusal([&] { create(std::move(words), timeout, timeout); });
  };
  const std::string who = "model puppet: process 'python3 puppet.py ";
  CHECK(why(puppet("unknown-key")).find(who + "unknown-key 1' unknown key \"tolerence\"") == 0);
  CHECK(why(puppet("no-size")) == who + "no-size 1' its first line has no \"state_size\"");
  CHECK(
      why(puppet("mute"), 0.5) ==
      who +
          "mute 1' did not say what it is within 0.5 s; a longer timeout in [model] gives it more");
  CHECK(why(puppet("dead")) == who + "dead 1' exited with status 5 before it had said what it is");
  CHECK(why(puppet("binary"))
            .starts_with(who + "binary 1' printed '?"
                               "?' to standard output, "));
  CHECK(why(puppet("import"))
            .starts_with(
                who + "import 1' exited with status 1 before it had said what it is: "
                      "ModuleNotFoundError: No module named 'no_such_module' (the program is /"));
  CHECK(why({"./puppet.py"})
            .find("model puppet: process './puppet.py' cannot be started in " + kProcesses +
                  ": Permission denied") == 0);
  CHECK(
      why({"no-such-program"}).ends_with("cannot be started: no program no-such-program in PATH"));
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
