// The rules of traversal that --traversal can name.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libcore/haptic/traversal.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

enum class TraversalRule { kPaper, kBranch, kModel };
inline constexpr TraversalRule kDefaultRule = TraversalRule::kPaper;

const char* name_of(TraversalRule rule);
/// Nothing when no rule has that name.
std::optional<TraversalRule> rule_named(const std::string& name);
/// "paper, branch, model"
std::string rule_names();
/// Whether a step takes as long as the model does, which no live device can wait for.
inline bool is_slow(TraversalRule rule) { return rule == TraversalRule::kModel; }

/// @param create makes the grid's model; called only for a rule that asks it.
/// @throw Error; what `create` throws.
std::shared_ptr<Traversal> make_traversal(TraversalRule rule, const Grid& grid,
                                          const MakeModel& create);

}  // namespace hapgrid
