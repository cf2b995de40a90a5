#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "libcore/model/process_model.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

const std::string kProcesses = HAPGRID_SOURCE_DIR "/tests/unit/model/processes";
constexpr double kSeconds = 30;  // far beyond what any answer takes

std::vector<std::string> puppet(const std::string& fault, const std::string& at = "1") {
  return {"python3", "puppet.py", fault, at};
}

/// tests/cli/process/refuse.sh has what is said of processes.
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

TEST_CASE("a process that does not say in time what it is") {
  CHECK_THROWS_WITH(create(puppet("mute"), 0.5, 0.5),
                    "model puppet: process 'python3 puppet.py mute 1' did not say what it is "
                    "within 0.5 s; a longer timeout in [model] gives it more");
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
