#include "tools/play/traversals.hpp"

#include "libcore/haptic/model_traversal.hpp"
#include "libcore/haptic/paper_traversal.hpp"

namespace hapgrid {

namespace {

struct Rule {
  TraversalRule rule;
  const char* name;
  std::unique_ptr<Traversal> (*make)(const Grid& grid, const MakeModel& create);
};

template <class T>
std::unique_ptr<Traversal> make(const Grid& grid, const MakeModel&) {
  return std::make_unique<T>(grid);
}

constexpr Rule kRules[] = {
    {TraversalRule::kPaper, "paper", make<PaperTraversal>},
    {TraversalRule::kModel, "model",
     [](const Grid& grid, const MakeModel& create) -> std::unique_ptr<Traversal> {
       return std::make_unique<ModelTraversal>(grid, create());
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

std::unique_ptr<Traversal> make_traversal(TraversalRule rule, const Grid& grid,
                                          const MakeModel& create) {
  return entry(rule).make(grid, create);
}

}  // namespace hapgrid
