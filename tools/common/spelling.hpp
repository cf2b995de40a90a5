// What somebody meant who has mistyped a word.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hapgrid {

/// Which of `known` differs least from `word`: the first of those with the smallest Levenshtein
/// distance. Nothing where that is above 2, since more wrong letters are another word.
std::optional<std::size_t> nearest(const std::string& word, const std::vector<std::string>& known);

}  // namespace hapgrid
