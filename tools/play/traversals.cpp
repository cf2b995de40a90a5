#include "tools/play/traversals.hpp"

#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/model_traversal.hpp"
#include "libcore/haptic/paper_traversal.hpp"

namespace hapgrid {

namespace {

struct Rule {
  TraversalRule rule;
  const char* name;
  std::shared_ptr<Traversal> (*make)(const Grid& grid, const MakeModel& create);
};

template <class T>
std::shared_ptr<Traversal> make(const Grid& grid, const MakeModel&) {
  return std::make_shared<T>(grid);
}

std::shared_ptr<Traversal> make_on_branch(const Grid& grid, const MakeModel&) {
  struct WithMap {
    explicit WithMap(const Grid& grid) : map(grid), traversal(grid, map) {}
    BranchMap map;
    BranchTraversal traversal;
  };
  const auto both = std::make_shared<WithMap>(grid);
  return {both, &both->traversal};
}

constexpr Rule kRules[] = {
    {TraversalRule::kPaper, "paper", make<PaperTraversal>},
    {TraversalRule::kBranch, "branch", make_on_branch},
    {TraversalRule::kModel, "model",
     [](const Grid& grid, const MakeModel& create) -> std::shared_ptr<Traversal> {
       return std::make_shared<ModelTraversal>(grid, create());
     }},
};

const Rule& entry(TraversalRule rule) {
  for (const Rule& r : kRules)
    if (r.rule == rule) return r;
  return kRules[0];
}

}  // namespace

const char* name_of(TraversalRule rule) { return entry(rule).name; }

std::optional<TraversalRule> rule_named(const std::string& name) {
  for (const Rule& r : kRules)
    if (name == r.name) return r.rule;
  return std::nullopt;
}

std::string rule_names() {
  std::string names;
  for (const Rule& r : kRules) names += (names.empty() ? "" : ", ") + std::string(r.name);
  return names;
}

std::shared_ptr<Traversal> make_traversal(TraversalRule rule, const Grid& grid,
                                          const MakeModel& create) {
  return entry(rule).make(grid, create);
}

}  // namespace hapgrid
