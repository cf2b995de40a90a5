// The parts of view's page; embed.cmake makes their source.
#pragma once

namespace hapgrid {

extern const char* const kPageHead;    ///< page.html: until the script begins
extern const char* const kPageScript;  ///< the scripts

}  // namespace hapgrid
