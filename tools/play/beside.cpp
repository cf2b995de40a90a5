#include "tools/play/beside.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/follow/branch_nodes.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

constexpr std::uint32_t kMostDelay = 10'000;  // ticks
constexpr std::chrono::milliseconds kPatience{500};

std::optional<std::uint32_t> ticks_of(const std::string& text) {
  std::uint32_t ticks = 0;
  const bool is_delay = parse_number(text, ticks) && ticks > 0 && ticks <= kMostDelay;
  return is_delay ? std::optional(ticks) : std::nullopt;
}

}  // namespace

bool is_beside(const std::string& text) {
  return text == kBesideOn || text == kBesideOff || ticks_of(text);
}

std::unique_ptr<Beside> make_beside(const std::string& wanted, bool must, bool has_thread,
                                    const Grid& grid, const BranchNodes* branches,
                                    const MakeModel& create) {
  if (wanted == kBesideOff || !branches || branches->are_whole()) return nullptr;
  std::optional<std::uint32_t> delay;
  if (!has_thread) delay = ticks_of(wanted).value_or(1);
  try {
    std::unique_ptr<Model> model = create();
    if (has_thread && !model->is_process() && model->info().processes == 1)
      throw ModelError("two threads must not ask this model, as its info.processes = 1 says");
    return std::make_unique<Beside>(grid, std::move(model), delay, [](const std::string& why) {
      say("play",
          format("the model beside the grid fails: {}: from here on the grid alone decides", why));
    });
  } catch (const ModelError&) {
    if (must) throw;
    return nullptr;
  }
}

int conclude_without(Beside* beside, const std::function<int()>& conclude) {
  if (!beside || beside->end_within(kPatience)) return conclude();
  int code = kExitFailed;
  try {
    say("play", "the model beside the grid hangs: play ends without it");
    code = conclude();
  } catch (const std::exception& e) {
    say("play", e.what());
  }
  std::cout.flush();
  std::fflush(nullptr);
  ::_exit(code);
}

}  // namespace hapgrid
