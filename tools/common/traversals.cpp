#include "tools/common/traversals.hpp"

#include <algorithm>
#include <iterator>

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/model_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"

namespace hapgrid {

namespace {

// In the order of TraversalRule.
constexpr const char* kNames[] = {"paper", "branch", "model"};

}  // namespace

const char* name_of(TraversalRule rule) { return kNames[static_cast<int>(rule)]; }

std::optional<TraversalRule> rule_named(const std::string& name) {
  const auto* const found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return std::nullopt;
  return static_cast<TraversalRule>(found - std::begin(kNames));
}

std::function<std::unique_ptr<Traversal>()> traversals(TraversalRule rule, const Grid& grid,
                                                       const MakeModel& create) {
  switch (rule) {
    case TraversalRule::kPaper:
      return [&grid] { return std::make_unique<PaperTraversal>(grid); };
    case TraversalRule::kBranch:
      return [&grid, map = std::make_shared<const BranchNodes>(grid)] {
        return std::make_unique<BranchTraversal>(grid, map);
      };
    case TraversalRule::kModel:
      break;
  }
  return [&grid, create] { return std::make_unique<ModelTraversal>(grid, create()); };
}

}  // namespace hapgrid
