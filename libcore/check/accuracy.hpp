// How accurate play is between the grid's points, and which spacing a wanted accuracy takes.
//
// Multilinear interpolation of a state with second derivatives s_aa is off by at most
// h²/8 (|s_xx| + |s_yy| + |s_zz|): in a smooth branch the error falls with h², and where the state
// has a kink (contact begins) with h, in a share of the cells that falls with h. Neither the
// derivatives nor the kinks are known, so the law is measured: walks (walk.hpp) give the error e in
// the same places with the spacing h and with 2h, and the order of what 99 of 100 places stay below
// is p = log2(e99(2h) / e99(h)), 2 at most. A wanted error E then takes the spacing h (E /
// e99)^(1/p). Near kinks p rises as h falls, up to 2, and the estimate is on the safe side.
//
// Only places in one branch count. Where a branch ends, the error of play is the distance of the
// branches, whatever the spacing. Such places are counted apart; their share falls with h.
#pragma once

#include <optional>

#include "libcore/check/report.hpp"
#include "libcore/check/walk.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `accurate`: a note without a wanted error. With one, the check is broken when more than 1 in 100
/// places in one branch have a larger error. Conversions that fail are offenders. Figures: the
/// shares of the places in one branch, empty, mixed and parted; median, 99 % and worst of the
/// errors; the order p; with a wanted error the spacing it takes, where p can be told: from 100
/// places and above 3/4.
/// @param wanted E, in the unit of the tolerance
Check check_accurate(const GridSpec& spec, const Walked& walked, bool has_force,
                     std::optional<double> wanted);

}  // namespace hapgrid
