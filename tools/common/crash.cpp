#include "tools/common/crash.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <cstddef>
#include <cstring>

#include "libcore/search/converter.hpp"

namespace hapgrid {

namespace {

const char* tool_name = "";  // written before the handler can run

/// A line that is put together without anything that a handler must not call.
class Line {
 public:
  Line& text(const char* t) {
    for (; *t && size_ < sizeof line_; ++t) line_[size_++] = *t;
    return *this;
  }
  Line& number(unsigned n) {
    const auto end = std::to_chars(line_ + size_, line_ + sizeof line_, n);
    if (end.ec == std::errc()) size_ = static_cast<std::size_t>(end.ptr - line_);
    return *this;
  }
  void write() const { static_cast<void>(!::write(STDERR_FILENO, line_, size_)); }

 private:
  char line_[400];
  std::size_t size_ = 0;
};

extern "C" void on_crash(int signal) {
  // Where threads crash together, the first writes its line; the others wait for the end of the
  // process, which would come before the line if they went on.
  static std::atomic<pid_t> first{0};
  pid_t none = 0;
  const pid_t self = ::gettid();
  const bool is_first = first.compare_exchange_strong(none, self);
  if (!is_first && none != self)
    for (;;) ::pause();
  const CurrentConversion& c = current_conversion();
  if (is_first && c.q >= 0)
    Line()
        .text(tool_name)
        .text(": the model crashed (signal ")
        .number(static_cast<unsigned>(signal))
        .text(") in the conversion at point ")
        .number(c.point)
        .text(" level ")
        .number(c.level)
        .text(", direction ")
        .number(static_cast<unsigned>(c.q))
        .text(c.while_what)
        .text("\n")
        .write();
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

void report_crashes(const char* tool) {
  tool_name = tool;
  // A stack that has overflown cannot carry the handler.
  static char stack[1 << 14];
  stack_t alternate{};
  alternate.ss_sp = stack;
  alternate.ss_size = sizeof stack;
  ::sigaltstack(&alternate, nullptr);
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = static_cast<int>(SA_ONSTACK | SA_NODEFER);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    ::sigaction(signal, &action, nullptr);
}

}  // namespace hapgrid
