// What hapgrid adds to a conversion by asking a process for it: a model in C that answers with the
// state it was sent (echo.c), states of 9 numbers that need all their digits, one process.
//
// Prints microseconds a question: wall time, and the CPU time of both sides. All of it counts as
// overhead, the model's own share of reading and writing its lines too.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/model/process_model.hpp"

namespace {

using namespace hapgrid;

constexpr std::uint32_t kStateSize = 9;
constexpr std::uint64_t kQuestions = 100'000;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double cpu_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Asks for kQuestions conversions and prints a row of the table.
void measure(unsigned in_flight) {
  std::vector<double> state(kStateSize);
  for (std::uint32_t c = 0; c < kStateSize; ++c) state[c] = std::sqrt(2.0 + c) - 2;
  std::vector<double> rows(std::size_t{in_flight} * kStateSize);
  const double others_before = cpu_seconds(RUSAGE_CHILDREN);
  double wall = 0;
  double own = 0;
  std::uint64_t wrong = 0;
  {
    const ProcessSource source("echo", {"./echo", std::to_string(kStateSize)}, HAPGRID_BENCH_DIR,
                               {60, in_flight});
    const auto model = source.create({});
    const double own_before = cpu_seconds(RUSAGE_SELF);
    const auto begin = std::chrono::steady_clock::now();
    std::uint64_t asked = 0;
    // Answers come in order here, so a row is free again after in_flight questions.
    model->convert_all(
        [&](Conversion& conversion, bool) {
          if (asked == kQuestions) return false;
          conversion = {state.data(),
                        {0.1, 0.2, 0.3},
                        {0.05, 0, -0.05},
                        &rows[asked % in_flight * kStateSize],
                        asked};
          return ++asked, true;
        },
        [&](const Conversion& conversion, std::string_view error) {
          wrong += !error.empty() || conversion.row[kStateSize - 1] != state.back();
        });
    wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    own = cpu_seconds(RUSAGE_SELF) - own_before;
  }
  const double others = cpu_seconds(RUSAGE_CHILDREN) - others_before;
  constexpr double kPer = 1e6 / static_cast<double>(kQuestions);
  std::printf("%9u %8.2f %11.2f %9.2f\n", in_flight, wall * kPer, own * kPer, others * kPer);
  if (wrong > 0) throw Error(std::to_string(wrong) + " wrong answers");
}

}  // namespace

int main() {
  std::printf("%9s %8s %11s %9s   microseconds a question\n", "in flight", "wall", "CPU hapgrid",
              "CPU model");
  try {
    for (const unsigned in_flight : {1u, 4u, 16u, 64u}) measure(in_flight);
  } catch (const Error& e) {
    return std::fprintf(stderr, "%s\n", e.what()), 1;
  }
}
