// A plug-in that crashes takes the filter down: who wrote it hears at least where.
#pragma once

namespace hapgrid {

/// From now on a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) in the middle of a conversion
/// writes one line "TOOL: the model crashed ..." with point, level and direction, and then ends the
/// process by that signal, as it would have without. Of several threads that crash together the
/// first writes its line. `tool` must live as long as the process.
/// Stacks that overflow in a thread other than the main one end without the line.
void report_crashes(const char* tool);

}  // namespace hapgrid
