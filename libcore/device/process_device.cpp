#include "libcore/device/process_device.hpp"

#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/guard_words.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little, "messages are sent as they are");
static_assert(sizeof(hapgrid_device_greeting) == 128 && sizeof(hapgrid_device_state) == 40 &&
              sizeof(hapgrid_device_force) == 32);

namespace {

// No device for a hand reaches less or farther, is stronger or faster (m, N, Hz).
constexpr double kNearest = 1e-3, kFarthest = 10, kStrongest = 1000, kFastest = 1e5;

bool finite(std::span<const double> numbers) noexcept {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

/// The longest side of the adapter's ranges, m.
double reach(const hapgrid_device_greeting& g) noexcept {
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, g.high[a] - g.low[a]);
  return longest;
}

}  // namespace

std::string greeting_flaw(const hapgrid_device_greeting& g, std::size_t size) {
  if (size != sizeof g || std::memcmp(g.magic, HAPGRID_DEVICE_MAGIC, sizeof g.magic) != 0)
    return "sent something that is not a greeting";
  if (g.version != HAPGRID_DEVICE_VERSION)
    return format("speaks version {} of the protocol, this play speaks {}", g.version,
                  HAPGRID_DEVICE_VERSION);
  const bool steers = (g.flags & HAPGRID_DEVICE_STEERS) != 0;
  int axes = 0;
  for (int a = 0; a < 3; ++a) {
    const double low = g.low[a], high = g.high[a];
    const bool possible =
        steers ? low == high || (low == -1 && high == 1)
               : low >= -kFarthest && high <= kFarthest && (low == high || high - low >= kNearest);
    if (!possible)
      return format("says that its {} goes from {} to {}{}", "xyz"[a], rounded(low), rounded(high),
                    steers ? ", and steers" : " m");
    axes += low < high;
  }
  if (axes == 0) return "says that it has no axis";
  if (!(g.max_force >= 0 && g.max_force <= kStrongest))
    return format("says that its largest force is {} N", rounded(g.max_force));
  if (!(g.rate >= kSlowestProcessHz && g.rate <= kFastest))
    return format("says that its rate is {} Hz", rounded(g.rate));
  return "";
}

DeviceInfo device_info(const hapgrid_device_greeting& g, const std::string& name) {
  const auto* const end = std::find(std::begin(g.name), std::end(g.name), '\0');
  const std::string_view given(g.name, static_cast<std::size_t>(end - g.name));
  DeviceInfo info{.name = given.empty() ? name : printable_line(given),
                  .unit = (g.flags & HAPGRID_DEVICE_STEERS) != 0 ? DeviceInfo::Unit::kRate
                                                                 : DeviceInfo::Unit::kMetres,
                  .max_force = g.max_force};
  std::copy_n(g.low, 3, info.low.begin());
  std::copy_n(g.high, 3, info.high.begin());
  return info;
}

std::string_view told_error(const char* message, std::size_t size) noexcept {
  const std::string_view text(message, size), mark = HAPGRID_DEVICE_ERROR;
  return text.starts_with(mark) ? text.substr(mark.size()) : std::string_view();
}

AdapterFault state_flaw(const hapgrid_device_greeting& greeting, const hapgrid_device_state& state,
                        std::size_t size, std::uint32_t number, double time) noexcept {
  if (size != sizeof state) return AdapterFault::kSize;
  if (state.number != number) return AdapterFault::kNumber;
  if (!std::isfinite(state.time) || !finite(state.position)) return AdapterFault::kNotFinite;
  const double slack = reach(greeting) / 2;  // ranges are nominal
  for (int a = 0; a < 3; ++a)
    if (state.position[a] < greeting.low[a] - slack || state.position[a] > greeting.high[a] + slack)
      return AdapterFault::kOutside;
  return state.time < time ? AdapterFault::kBackwards : AdapterFault::kNone;
}

using namespace std::chrono_literals;

namespace {

constexpr auto kGreetingWait = 10s;
constexpr std::chrono::microseconds kSilence(static_cast<std::int64_t>(HAPGRID_DEVICE_SILENCE *
                                                                       1e6));

timeval to_timeval(std::chrono::microseconds t) {
  return {.tv_sec = t / 1s, .tv_usec = (t % 1s).count()};
}

}  // namespace

ProcessDevice::ProcessDevice(AdapterProgram program) : guard_(std::move(program)) {
  greet();
  if (releases()) guard_.set_releases();
  const timeval limit = to_timeval(kSilence);
  ::setsockopt(guard_.wire(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  moved_on_ = Clock::now();
  state_.time = -std::numeric_limits<double>::infinity();
  if (ask({0, 0, 0}) && read_answer()) return;
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
  if (!receive()) {
    stop();
    throw DeviceError(error());
  }
  std::memcpy(&greeting_, message_.data(), sizeof greeting_);
  const std::string wrong = greeting_flaw(greeting_, size_);
  if (!wrong.empty()) throw DeviceError(format("{}: {}", guard_.name(), wrong));
}

/// Keeps the first fault. @return false
bool ProcessDevice::fail(AdapterFault fault) noexcept {
  if (fault_ == AdapterFault::kNone) fault_ = fault;
  return false;
}

/// Sends a force. @return whether the adapter could be told
bool ProcessDevice::ask(const Vec3& force) noexcept {
  do ++number_;
  while (number_ == 0 || number_ == kLastForce);
  const hapgrid_device_force message{
      .force = {force[0], force[1], force[2]},
      .number = number_,
      .flags = std::exchange(snaps_, false) ? std::uint32_t{HAPGRID_DEVICE_SNAP} : 0};
  asked_ = true;
  sent_ = Clock::now();
  const ssize_t sent = ::send(guard_.wire(), &message, sizeof message, MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent == sizeof message ||
         (errno == EAGAIN ? fail(AdapterFault::kSilent) : end(AdapterFault::kGone));
}

/// The next message goes to message_. @return what recv() does
ssize_t ProcessDevice::read_message(int flags) noexcept {
  // An adapter that ends with a force unread resets the socket once; its last word comes then.
  ssize_t got;
  do got = ::recv(guard_.wire(), message_.data(), message_.size(), MSG_TRUNC | flags);
  while (got < 0 && (errno == EINTR || errno == ECONNRESET));
  size_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  return got;
}

/// Whether the message is one of an error.
bool ProcessDevice::is_told() const noexcept {
  return !told_error(message_.data(), std::min(size_, message_.size())).empty();
}

/// The end of adapter or guard was seen. What the adapter told before it lies behind an answer at
/// most, and is the fault then. @return false
bool ProcessDevice::end(AdapterFault fault) noexcept {
  for (int messages = 0; messages < 2 && read_message(MSG_DONTWAIT) > 0; ++messages)
    if (is_told()) return fail(AdapterFault::kTold);
  return fail(fault);
}

/// Waits for a message that is not an error. @return whether there is one
bool ProcessDevice::receive() noexcept {
  ssize_t got = read_message(MSG_DONTWAIT);
  const bool waits = got < 0 && errno == EAGAIN;
  if (waits) got = read_message(0);
  if (got < 0 && errno == EAGAIN) return fail(AdapterFault::kSilent);
  if (got <= 0) return fail(AdapterFault::kGone);
  if (is_told()) return fail(AdapterFault::kTold);
  delays_.add(waits ? (Clock::now() - sent_) / 1ns : 0);
  return true;
}

/// Reads the answer to the last force. @return whether there is a good one
bool ProcessDevice::read_answer() noexcept {
  if (!receive()) return false;
  asked_ = false;
  std::memcpy(&wrong_, message_.data(), sizeof wrong_);
  expected_ = number_;
  const AdapterFault flaw = state_flaw(greeting_, wrong_, size_, number_, state_.time);
  if (flaw != AdapterFault::kNone) return fail(flaw);
  const auto now = Clock::now();
  if (wrong_.time > state_.time) moved_on_ = now;
  if (now - moved_on_ > kSilence) return fail(AdapterFault::kStoodStill);
  state_ = wrong_;
  return true;
}

/// Tells the guard that this program lives. @return whether it could be told
bool ProcessDevice::beat(Clock::time_point now) noexcept {
  if (now - beat_ < kGuardBeatTime) return true;
  beat_ = now;
  return guard_.beat() || end(AdapterFault::kGuardGone);
}

DeviceStatus ProcessDevice::read(DeviceInput& input) noexcept {
  if (fault_ != AdapterFault::kNone || stopped_) return DeviceStatus::kFailed;
  const auto now = Clock::now();
  if (!beat(now)) return DeviceStatus::kFailed;
  if (!asked_) {
    moved_on_ = now;  // nobody asked for a while
    if (!ask({0, 0, 0})) return DeviceStatus::kFailed;
  }
  if (!read_answer()) return DeviceStatus::kFailed;
  input = {.stalled = (state_.flags & HAPGRID_DEVICE_STALLED) != 0,
           .clutch = (state_.flags & HAPGRID_DEVICE_CLUTCH) != 0,
           .reset = (state_.flags & HAPGRID_DEVICE_RESET) != 0,
           .next = (state_.flags & HAPGRID_DEVICE_NEXT) != 0};
  const bool steers = (greeting_.flags & HAPGRID_DEVICE_STEERS) != 0;
  // An old deflection would leave the HIP under way for ever.
  if (steers && input.stalled) return DeviceStatus::kOk;
  std::copy_n(state_.position, 3, (steers ? input.rate : input.position).begin());
  return DeviceStatus::kOk;
}

DeviceStatus ProcessDevice::send(const Vec3& force) noexcept {
  if (stopped_) return stop_status_;
  if (fault_ != AdapterFault::kNone || !ask(force)) return DeviceStatus::kFailed;
  return DeviceStatus::kOk;
}

DeviceStatus ProcessDevice::stop() noexcept {
  if (stopped_.exchange(true)) return stop_status_;
  if (guard_.end())
    stop_status_ = DeviceStatus::kOk;
  else
    fail(AdapterFault::kHeldOn);
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

bool ProcessDevice::share_processor(int processor) noexcept {
  if (stopped_ || (greeting_.flags & HAPGRID_DEVICE_SHARES) == 0) return false;
  cpu_set_t one, others;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  if (::sched_getaffinity(guard_.pid(), sizeof others, &others) != 0) return false;
  CPU_CLR(processor, &others);
  // The guard is first: the kernel refuses a set without a processor. What the guard starts later,
  // as --release, stays off this processor, too.
  return ::sched_setaffinity(guard_.pid(), sizeof others, &others) == 0 &&
         ::sched_setaffinity(guard_.adapter(), sizeof one, &one) == 0;
}

std::string ProcessDevice::error() const {
  std::string consequence;
  if (stopped_ && stop_status_ != DeviceStatus::kOk && greeting_.max_force > 0)
    consequence = guard_.released() ? "; then --release sent zero force"
                  : releases()      ? "; --release failed: the device may hold its last force"
                                    : "; it has no --release: the device may hold its last force";
  return format("{}: {}{}", guard_.name(), what(), consequence);
}

std::string ProcessDevice::what() const {
  if (guard_.why() == kGuardStood) return "the program stood still, and its guard sent zero force";
  if (guard_.why() == kGuardDeaf)
    return format("read nothing within {} ms, while this program stood still", kSilence / 1ms);
  const std::string& how = guard_.how_it_ended();
  const auto place = [](const double* x) {
    return format("{} {} {} m", rounded(x[0]), rounded(x[1]), rounded(x[2]));
  };
  // The guard may have seen the adapter's end first.
  const bool saw = fault_ == AdapterFault::kGuardGone && guard_.why() == kGuardClosed;
  switch (saw ? AdapterFault::kGone : fault_.load()) {
    case AdapterFault::kNone:
      return "no error";
    case AdapterFault::kSilent:
      return how.empty() ? format("did not answer within {} ms", kSilence / 1ms) : how;
    case AdapterFault::kHeldOn:
      return format("did not answer the last message within {} ms", kConfirmTime / 1ms);
    case AdapterFault::kGone:
      return how.empty() ? "closed its standard input or output" : how;
    case AdapterFault::kTold:
      return printable_line(told_error(message_.data(), std::min(size_, message_.size())),
                            message_.size());
    case AdapterFault::kStoodStill:
      return format("its time stood still for {} ms", kSilence / 1ms);
    case AdapterFault::kGuardGone:
      return "its guard process is gone";
    case AdapterFault::kSize:
      return format("sent {} bytes, and a state has {}", size_, sizeof state_);
    case AdapterFault::kNumber:
      return format("answered force {} instead of force {}", wrong_.number, expected_);
    case AdapterFault::kNotFinite:
      return "sent a number that is not finite";
    case AdapterFault::kOutside:
      return format("is at {}, and its ranges go from {} to {}", place(wrong_.position),
                    place(greeting_.low), place(greeting_.high));
    case AdapterFault::kBackwards:
      return format("its time went back from {} to {} s", rounded(state_.time),
                    rounded(wrong_.time));
  }
  return "";
}

}  // namespace hapgrid
