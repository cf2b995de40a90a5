#include "tools/view/feed.hpp"

#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

bool is_regular(const std::string& name) {
  struct stat status {};
  const int failed = name == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(name.c_str(), &status);
  return failed == 0 && S_ISREG(status.st_mode);
}

}  // namespace

Feed::Feed(const std::string& name, std::function<void()> changed)
    : reader_(name),
      changed_(std::move(changed)),
      recorded_(is_regular(name)),
      stop_reading_(::eventfd(0, EFD_CLOEXEC)) {
  if (!stop_reading_) throw std::system_error(errno, std::generic_category(), "eventfd");
  reader_.give_up_on(stop_reading_.get());
}

Feed::~Feed() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  wake_.notify_all();
  const std::uint64_t one = 1;
  static_cast<void>(!::write(stop_reading_.get(), &one, sizeof one));
}

void Feed::start() {
  const BlockedSignals blocked;  // they are the drawing thread's
  thread_ = std::jthread([this] { run(); });
}

void Feed::run() {
  std::exception_ptr error;
  try {
    bool first = true;
    for (Frame frame; reader_.next(frame);) {
      if (std::exchange(first, false)) {
        const std::lock_guard lock(mutex_);
        start_ = Clock::now();
        first_s_ = frame.time_s;
      }
      if (recorded_ && !wait_until_due(frame.time_s)) break;
      {
        const std::lock_guard lock(mutex_);
        late_ = late_ || waiting_.size() == kMostWaiting;
        if (late_) waiting_.clear();
        waiting_.push_back(frame);
      }
      changed_();
    }
  } catch (...) {
    error = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    error_ = error;
    ended_ = true;
  }
  changed_();
}

/// False when nobody waits for the frame any more.
bool Feed::wait_until_due(double time_s) {
  std::unique_lock lock(mutex_);
  while (!stopped_) {
    const double played = std::chrono::duration<double>(Clock::now() - start_).count();
    const double left = time_s - first_s_ - played;
    if (!(left > 0)) return true;
    wake_.wait_for(lock, std::chrono::duration<double>(std::min(left, 3600.0)));
  }
  return false;
}

Feed::State Feed::update(Frame& frame) {
  const std::lock_guard lock(mutex_);
  const bool fresh = !waiting_.empty();
  if (fresh) {
    frame = std::move(waiting_.front());
    waiting_.pop_front();
    late_ = false;
  }
  return {fresh, !waiting_.empty(), ended_ && waiting_.empty()};
}

void Feed::check() const {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
}

}  // namespace hapgrid
