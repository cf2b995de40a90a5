// What libcore wants of a system and a page has not: no model walks beside the grid, texts of
// errors stay without their values, and an exception ends the player (the grid was checked when it
// was packed).
#include <cstdlib>
#include <string>
#include <version>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/follow/branch_traversal.hpp"

namespace hapgrid {

void BranchTraversal::follow_model() noexcept {}

std::string vformat(fmt::string_view text, fmt::format_args) { return {text.data(), text.size()}; }
std::string to_text(double) { return "?"; }

}  // namespace hapgrid

#if _LIBCPP_VERSION >= 160000
// Its own one prints, for which a page would need a system with files.
void std::__libcpp_verbose_abort(const char*,
                                 ...) noexcept(noexcept(std::__libcpp_verbose_abort(""))) {
  __builtin_trap();
}
#endif

extern "C" {
void* __cxa_allocate_exception(std::size_t size) { return std::malloc(size); }
void __cxa_free_exception(void*) {}
[[noreturn]] void __cxa_throw(void*, void*, void (*)(void*)) { __builtin_trap(); }
void* __cxa_begin_catch(void*) { __builtin_trap(); }
void __cxa_end_catch() {}
[[noreturn]] void abort_message(const char*, ...) { __builtin_trap(); }
[[noreturn]] void __abort_message(const char*, ...) { __builtin_trap(); }  // newer
[[noreturn]] void __cxa_rethrow() { __builtin_trap(); }
}
