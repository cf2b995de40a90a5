#include "tools/common/traversals.hpp"

#include "libcore/base/format.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/model_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"

namespace hapgrid {

namespace {

struct Rule {
  TraversalRule rule;
  const char* name;
};
constexpr Rule kRules[] = {{TraversalRule::kPaper, "paper"},
                           {TraversalRule::kBranch, "branch"},
                           {TraversalRule::kModel, "model"}};

}  // namespace

const char* name_of(TraversalRule rule) {
  for (const Rule& r : kRules)
    if (r.rule == rule) return r.name;
  return "";
}

std::optional<TraversalRule> rule_named(const std::string& name) {
  for (const Rule& r : kRules)
    if (name == r.name) return r.rule;
  return std::nullopt;
}

std::string rule_names() {
  std::string names;
  for (const Rule& r : kRules) names += format("{}{}", names.empty() ? "" : ", ", r.name);
  return names;
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
