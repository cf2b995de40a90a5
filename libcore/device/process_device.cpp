#include "libcore/device/process_device.hpp"

#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <limits>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr auto kGreetingWait = 10s;
constexpr auto kStopLimit = 1s;
constexpr std::chrono::microseconds kSilence(static_cast<std::int64_t>(HAPGRID_DEVICE_SILENCE *
                                                                       1e6));

timeval to_timeval(std::chrono::microseconds t) {
  return {.tv_sec = t / 1s, .tv_usec = (t % 1s).count()};
}

}  // namespace

ProcessDevice::ProcessDevice(ProcessGuard& guard) : guard_(guard) {
  guard_.start();
  try {
    greet();
    const timeval limit = to_timeval(kSilence);
    ::setsockopt(guard_.wire(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    moved_on_ = Clock::now();
    state_.time = -std::numeric_limits<double>::infinity();
    if (ask({0, 0, 0}, false) && read_answer()) return;
  } catch (...) {
    close(kSilence);
    throw;
  }
  stop();
  throw DeviceError(error());
}

ProcessDevice::~ProcessDevice() { stop(); }

void ProcessDevice::greet() {
  const int wire = guard_.wire();
  pollfd ready{wire, POLLIN, 0};
  const int polled = ::poll(&ready, 1, kGreetingWait / 1ms);
  if (polled < 0) throw std::system_error(errno, std::generic_category(), guard_.name());
  if (polled == 0)
    throw DeviceError(format("{}: no greeting within {} s", guard_.name(), kGreetingWait / 1s));
  const ssize_t got = ::recv(wire, &greeting_, sizeof greeting_, MSG_TRUNC);
  if (got <= 0) {
    fail(Fault::kGone);
    close(0us);
    throw DeviceError(error());
  }
  const std::string wrong = greeting_flaw(greeting_, static_cast<std::size_t>(got));
  if (!wrong.empty()) throw DeviceError(format("{}: {}", guard_.name(), wrong));
}

/// Keeps the first fault. @return false
bool ProcessDevice::fail(Fault fault) noexcept {
  if (fault_ == Fault::kNone) fault_ = fault;
  return false;
}

/// Sends a force. @return whether the adapter could be told
bool ProcessDevice::ask(const Vec3& force, bool end) noexcept {
  if (++number_ == 0) ++number_;
  const hapgrid_device_force message{
      .force = {force[0], force[1], force[2]}, .number = number_, .end = end};
  asked_ = true;
  const ssize_t sent = ::send(guard_.wire(), &message, sizeof message, MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent == sizeof message || fail(Fault::kGone);
}

/// Reads the answer to the last force. @return whether there is a good one
bool ProcessDevice::read_answer() noexcept {
  ssize_t got;
  do got = ::recv(guard_.wire(), &wrong_, sizeof wrong_, MSG_TRUNC);
  while (got < 0 && errno == EINTR);
  if (got < 0 && errno == EAGAIN) return fail(Fault::kSilent);
  if (got <= 0) return fail(Fault::kGone);
  asked_ = false;
  size_ = static_cast<std::size_t>(got);
  expected_ = number_;
  flaw_ = state_flaw(greeting_, wrong_, size_, number_, state_.time);
  if (flaw_ != StateFlaw::kNone) return fail(Fault::kFlaw);
  const auto now = Clock::now();
  if (wrong_.time > state_.time) moved_on_ = now;
  if (now - moved_on_ > kSilence) return fail(Fault::kStoodStill);
  state_ = wrong_;
  return true;
}

DeviceStatus ProcessDevice::read(DeviceInput& input) noexcept {
  if (fault_ != Fault::kNone || stopped_) return DeviceStatus::kFailed;
  Heart& heart = guard_.heart();
  heart.beats.fetch_add(1);
  if (heart.let_go.load()) {
    fail(Fault::kGuardLetGo);
    return DeviceStatus::kFailed;
  }
  if (!asked_) {
    moved_on_ = Clock::now();  // nobody asked for a while
    if (!ask({0, 0, 0}, false)) return DeviceStatus::kFailed;
  }
  if (!read_answer()) return DeviceStatus::kFailed;
  input = {.clutch = (state_.buttons & HAPGRID_DEVICE_CLUTCH) != 0,
           .reset = (state_.buttons & HAPGRID_DEVICE_RESET) != 0};
  std::copy_n(state_.position, 3, input.position.begin());
  return DeviceStatus::kOk;
}

DeviceStatus ProcessDevice::send(const Vec3& force) noexcept {
  if (stopped_) return stop_status_;
  if (fault_ != Fault::kNone || guard_.heart().let_go.load() || !ask(force, false)) {
    if (guard_.heart().let_go.load()) fail(Fault::kGuardLetGo);
    return DeviceStatus::kFailed;
  }
  return DeviceStatus::kOk;
}

/// Whether the adapter answered the last message; what comes before is skipped.
bool ProcessDevice::confirmed(Clock::time_point deadline) noexcept {
  for (;;) {
    hapgrid_device_state state[2];  // what is too long shows
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd ready{guard_.wire(), POLLIN, 0};
    if (left <= 0ms || (::poll(&ready, 1, static_cast<int>(left.count())) < 0 && errno != EINTR))
      return false;
    const ssize_t got = ::recv(guard_.wire(), state, sizeof state, MSG_DONTWAIT);
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return false;
    if (got == sizeof state[0] && state[0].number == number_) return true;
  }
}

/// Tells the adapter to let go, or kills it.
void ProcessDevice::close(std::chrono::microseconds patience) noexcept {
  if (stopped_) return;
  stopped_ = true;
  guard_.heart().beats.store(0);
  if (ask({0, 0, 0}, true) && confirmed(Clock::now() + patience)) {
    guard_.release();
    stop_status_ = DeviceStatus::kOk;
  } else {
    how_ = guard_.kill();
    fail(Fault::kHeldOn);
  }
}

DeviceStatus ProcessDevice::stop() noexcept {
  // Who did not answer so far is not waited for: it may hold the hand.
  close(fault_ == Fault::kNone     ? std::chrono::microseconds(kStopLimit)
        : fault_ == Fault::kSilent ? 0us
                                   : kSilence);
  return stop_status_;
}

bool ProcessDevice::set_priority(int priority) noexcept {
  if (stopped_) return false;  // its number may be another process's by now
  const sched_param wanted{.sched_priority = priority};
  const int policy = priority > 0 ? SCHED_FIFO | SCHED_RESET_ON_FORK : SCHED_OTHER;
  bool took = true;
  try {
    const std::string tasks = format("/proc/{}/task", guard_.adapter());
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      const pid_t thread = std::stoi(task.path().filename());
      sched_param has{};
      ::sched_getparam(thread, &has);
      // Threads of a maker's kit may have a priority of their own.
      if (has.sched_priority == (priority > 0 ? 0 : priority_))
        took &= ::sched_setscheduler(thread, policy, &wanted) == 0;
    }
  } catch (const std::exception&) {
    return false;  // it is gone
  }
  priority_ = priority;
  return took;
}

std::string ProcessDevice::error() const { return format("{}: {}", guard_.name(), what()); }

std::string ProcessDevice::what() const {
  switch (fault_) {
    case Fault::kNone:
      return "no error";
    case Fault::kSilent:
      return how_.empty() ? format("did not answer within {} ms", kSilence / 1ms) : how_;
    case Fault::kHeldOn:
      return format("did not answer the last message within {} s", kStopLimit / 1s);
    case Fault::kGone:
      return how_.empty() ? "closed its standard input or output" : how_;
    case Fault::kFlaw:
      return what_flaw();
    case Fault::kStoodStill:
      return format("its time stood still for {} ms", kSilence / 1ms);
    case Fault::kGuardLetGo:
      return "the program stood still, and its guard sent zero force";
  }
  return "";
}

std::string ProcessDevice::what_flaw() const {
  const auto place = [](const double* x) {
    return format("{} {} {} m", rounded(x[0]), rounded(x[1]), rounded(x[2]));
  };
  switch (flaw_) {
    case StateFlaw::kNone:
      return "";
    case StateFlaw::kSize:
      return format("sent {} bytes, and a state has {}", size_, sizeof state_);
    case StateFlaw::kNumber:
      return format("answered force {} instead of force {}", wrong_.number, expected_);
    case StateFlaw::kNotFinite:
      return "sent a number that is not finite";
    case StateFlaw::kOutside:
      return format("is at {}, and its ranges go from {} to {}", place(wrong_.position),
                    place(greeting_.low), place(greeting_.high));
    case StateFlaw::kBackwards:
      return format("its time went back from {} to {} s", rounded(state_.time),
                    rounded(wrong_.time));
  }
  return "";
}

}  // namespace hapgrid
