// The parts of the page that view --html writes; embed.cmake makes their source.
#pragma once

namespace hapgrid {

extern const char* const kPageHead;    ///< page.html: until the first script begins
extern const char* const kPageThree;   ///< three.js
extern const char* const kPageScript;  ///< page.js

}  // namespace hapgrid
