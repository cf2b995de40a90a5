// Cap'n Proto before 1.0 leaves these operators to the rewriting of C++20, which clang 16 and later
// do not do beside an operator != (P2468). CMakeLists.txt includes this first where both meet, as
// on Debian 12.
#pragma once

#ifdef __cplusplus
#include <kj/string.h>

namespace kj {

inline bool operator==(const char* a, const StringPtr& b) { return b == StringPtr(a); }
inline bool operator!=(const char* a, const StringPtr& b) { return b != StringPtr(a); }

}  // namespace kj
#endif
