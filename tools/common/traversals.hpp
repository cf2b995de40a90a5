// The rules of traversal that --traversal can name.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "libcore/follow/traversal.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

enum class TraversalRule { kPaper, kBranch, kModel };
inline constexpr char kRuleNames[] = "paper, branch, model";
inline constexpr TraversalRule kDefaultRule = TraversalRule::kBranch;

const char* name_of(TraversalRule rule);
/// Nothing when no rule has that name.
std::optional<TraversalRule> rule_named(const std::string& name);

/// Makes traversals of a grid that is loaded, all of which share what is computed of it once.
/// @param create makes the grid's model; called only for a rule that asks it.
/// @throw Error; what `create` throws, here or when a traversal is made.
std::function<std::unique_ptr<Traversal>()> traversals(TraversalRule rule, const Grid& grid,
                                                       const MakeModel& create);

}  // namespace hapgrid
