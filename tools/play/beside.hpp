// The model that walks beside the grid, as --beside names it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "libcore/follow/beside.hpp"

namespace hapgrid {

/// --beside: the model corrects the grid, if it is at hand. For a live device it is
/// asked by a thread of its own.
inline constexpr const char* kBesideOn = "on";
/// The grid alone decides.
inline constexpr const char* kBesideOff = "off";

/// Whether --beside takes it: one of the two above, or a number of ticks, by which the answers are
/// held back when the model is asked in the tick.
bool is_beside(const std::string& text);

/// @param wanted is_beside(). @param must whether the user asked for it
/// @param has_thread for a live device
/// @param create makes the grid's model. If it fails in play, that is said in a line. @returns null
/// where the grid alone decides: that is wanted, or no branch ends, or the model is not at hand
/// @throw ModelError when it must be there and is not
std::unique_ptr<Beside> make_beside(const std::string& wanted, bool must, bool has_thread,
                                    const Grid& grid, const BranchNodes* branches,
                                    const MakeModel& create);

/// What `conclude` returns or throws. If the model is a plug-in that does not come back, this ends
/// the program after `conclude`: nothing else would end its thread. @param beside may be null
int conclude_without(Beside* beside, const std::function<int()>& conclude);

}  // namespace hapgrid
