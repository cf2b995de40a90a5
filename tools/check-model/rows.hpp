// The rows of check-model's report that are tried in each step of a walk, in their order.
#pragma once

#include <array>
#include <cstddef>

namespace hapgrid {

struct Row {
  const char* name;
  const char* unit;
  const char* meaning;
  bool is_note = false;
};

inline constexpr std::size_t kDefined = 0, kDeterministic = 1, kAmong = 2, kTogetherRow = 3,
                             kFinite = 8, kSane = 9, kHalves = 10, kReturns = 11, kSnaps = 12;
inline constexpr std::array<Row, 13> kRows{{
    {"defined", "conversions", "conversions that C fails on"},
    {"deterministic", "conversions",
     "C, asked again, answers with other bits: no two runs will give the same grid"},
    {"among", "conversions",
     "C answers otherwise when it is asked several questions at a time: a row of "
     "convert_many() depends on the others. Answer them in blocks of one size, and let each "
     "row end by itself"},
    {"together", "conversions",
     "C answers otherwise while two threads ask two models: they share data, which a plug-in "
     "must not have. With info.processes = 1 one thread asks one model, and hapgrid rounds "
     "--parts N gives each a process of its own"},
    {"stays", "states",
     "C(s, x, 0) is another state than s: a state that was reached is not at rest"},
    {"stable", "states",
     "states that are not at rest, as on the top of a barrier: pushed, they do not come back"},
    {"reflexive", "states", "the tolerance function says that a state differs from itself"},
    {"symmetric", "pairs", "the tolerance function depends on the order of its arguments"},
    {"finite", "calls", "force or shape that is not finite"},
    {"sane", "parameters", "what the model itself says against its parameters"},
    {"halves", "conversions",
     "steps in two halves that end in another state: that is right near a tear-off", true},
    {"returns", "conversions",
     "steps there and back that end in another state: levels are there for such hysteresis", true},
    {"snaps", "steps", ""},
}};

}  // namespace hapgrid
