// The device process of the stand-in library (tests/standin/hidapi.c), as a thread of the test.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

/// One device at any path. What is written to it is kept in the order in which it came.
class StandinDevice {
  template <class F>
  auto locked(F&& f) const {
    const std::lock_guard lock(mutex_);
    return f();
  }

 public:
  using Bytes = std::vector<std::uint8_t>;

  /// @param socket a path; also put into HAPGRID_STANDIN.
  explicit StandinDevice(const std::string& socket);
  ~StandinDevice();
  StandinDevice(const StandinDevice&) = delete;
  StandinDevice& operator=(const StandinDevice&) = delete;

  /// To every handle that is open, and, when `kept`, at once to every one that is opened later.
  void input(const Bytes& report, bool kept = false);
  void read_error(const std::string& text);
  void read_sleep(int milliseconds);
  /// Sends this input report without pause until stop_flood().
  void flood(const Bytes& report);
  void stop_flood();
  /// Closes every handle and takes no new one.
  void vanish();

  /// The next writes are answered only by release_writes().
  void hold_writes() {
    locked([&] { holding_ = true; });
  }
  void release_writes();
  /// The next `count` writes are answered by this, not by their size.
  void answer_writes(int count, std::int32_t answer, const std::string& text) {
    locked([&] { answers_ = count, answer_ = answer, answer_text_ = text; });
  }
  void set_list(const std::string& list) {
    locked([&] { list_ = list; });
  }
  /// Of hid_open_path.
  void set_refusal(const std::string& text) {
    locked([&] { refusal_ = text; });
  }

  /// Output reports, oldest first.
  std::vector<Bytes> written() const {
    return locked([&] { return written_; });
  }
  /// Handles so far, and those that are open.
  int opened() const {
    return locked([&] { return opened_; });
  }
  int open() const {
    return locked([&] { return std::ranges::count(connections_, 'C', &Connection::kind); });
  }
  /// Writes that wait for their answer.
  std::size_t held() const {
    return locked([&] { return held_.size(); });
  }
  /// Whether output reports came on more than one handle.
  bool written_by_two() const {
    return locked([&] { return writers_.size() > 1; });
  }

  /// Whether it became true within 10 s; looks again whenever something came, and each 5 ms.
  bool wait(const std::function<bool()>& condition) const;
  bool wait_for_writes(std::size_t count) const {
    return wait([&] { return written().size() >= count; });
  }

 private:
  struct Connection {
    int fd = -1;
    char kind = 0;  // 'I', 'C', 0 before its first message
  };
  struct Held {
    int fd;
    std::size_t size;
  };

  void run();
  void take(Connection& connection);
  void send_inputs(const std::string& message);
  void answer(int fd, std::int32_t n, const std::string& text);

  mutable std::mutex mutex_;
  std::vector<Connection> connections_;
  std::vector<Bytes> written_, kept_;
  std::vector<int> writers_;
  std::vector<Held> held_;
  bool holding_ = false, gone_ = false;
  int answers_ = 0;
  std::int32_t answer_ = 0;
  std::string answer_text_, list_, refusal_;
  int opened_ = 0;
  int listener_ = -1;
  std::atomic<bool> end_{false}, flooding_{false};
  std::thread flood_, thread_;
};
