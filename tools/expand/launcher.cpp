#include "tools/expand/launcher.hpp"

#include <cstdint>
#include <cstdlib>
#include <optional>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/command_line.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMostParts = (std::uint64_t{1} << 32) - 1;

[[noreturn]] void refuse(const std::string& why) {
  throw UsageError(format("--part: auto: {}", why));
}

/// A variable's value. @throw UsageError when it is not set or not in [low, high]
std::uint64_t number(const std::string& name, std::uint64_t low, std::uint64_t high) {
  const char* const text = std::getenv(name.c_str());
  if (!text) refuse(format("{} is not set", name));
  std::uint64_t value = 0;
  if (!parse_number(text, value) || value < low || value > high)
    refuse(format("{} is '{}', and not a number from {} to {}", name, text, low, high));
  return value;
}

/// A rank in [0, size), where both are set: Slurm gives a batch script a rank, but perhaps no size.
std::optional<Part> ranked(const std::string& rank, const std::string& size) {
  if (!std::getenv(rank.c_str()) || !std::getenv(size.c_str())) return std::nullopt;
  const std::uint64_t of = number(size, 1, kMostParts);
  return Part{number(rank, 0, of - 1) + 1, of};
}

std::optional<Part> array_element() {
  const std::string name = "SLURM_ARRAY_TASK_";
  if (!std::getenv((name + "ID").c_str())) return std::nullopt;
  const std::uint64_t low = number(name + "MIN", 0, kMostParts - 1);
  const std::uint64_t high = number(name + "MAX", low, kMostParts - 1);
  const std::uint64_t step = number(name + "STEP", 1, kMostParts);
  const std::uint64_t at = number(name + "ID", low, high) - low;
  if (at % step != 0) refuse(format("{0}ID is not a whole number of steps above {0}MIN", name));
  return Part{at / step + 1, (high - low) / step + 1};
}

}  // namespace

Part part_of_launcher() {
  std::optional<Part> first;
  for (const auto& part :
       {ranked("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ranked("PMI_RANK", "PMI_SIZE"),
        ranked("SLURM_PROCID", "SLURM_NTASKS"), array_element()}) {
    if (part && part->of > 1) return *part;
    if (!first) first = part;
  }
  if (!first)
    refuse(
        "no launcher has numbered this process: no SLURM_PROCID with SLURM_NTASKS is set, no "
        "SLURM_ARRAY_TASK_ID, no OMPI_COMM_WORLD_RANK and no PMI_RANK with its SIZE");
  return *first;
}

std::string named_by_part(std::string pattern, const Part& part) {
  const std::size_t at = pattern.rfind("{}");
  if (at != std::string::npos) pattern.replace(at, 2, format("{}-of-{}", part.number, part.of));
  return pattern;
}

}  // namespace hapgrid
