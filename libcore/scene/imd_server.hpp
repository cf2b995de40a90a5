// Serves frames over TCP to several viewers of molecules at once (imd_protocol.hpp). Nothing that a
// client sends reaches the play.
//
// One thread accepts clients, listens to them, and sends the bytes that could not be sent at once.
// A client gets whole frames: while one is on its way, the newest frame waits. It replaces the
// frame that waited before, which is counted as dropped.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/scene/imd_protocol.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

struct ImdOptions {
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6, in numbers
  std::uint16_t port = 0;             ///< 0: the system chooses
  int version = 2;                    ///< or 3
  /// A client that has not said GO after this time is closed. The protocol asks for one second; the
  /// second one is for slow machines.
  std::chrono::milliseconds greeting{2000};
  /// A client, unless paused, that takes longer than this for one frame is closed.
  std::chrono::milliseconds patience{5000};
};

/// The counts of all clients together.
struct ImdCounts {
  std::uint64_t viewers = 0;  ///< clients that said GO
  std::uint64_t sent = 0;     ///< frames; those that were dropped are not among them
  std::uint64_t dropped = 0;
  std::uint64_t slow = 0;     ///< clients closed because they did not read
  std::uint64_t refused = 0;  ///< clients closed because there were kMaxClients already
  std::uint64_t forces = 0;   ///< messages with forces on atoms; they are ignored, as are
  std::uint64_t rates = 0;    ///< wishes for another rate of frames
};

class ImdServer {
 public:
  static constexpr std::size_t kMaxClients = 8;  ///< more are closed at once
  /// The longest wait of publish() without a pace: a frame's scripted time.
  static constexpr std::chrono::milliseconds kWait{1000 / kFramesPerSecond};
  static constexpr std::chrono::milliseconds kLinger{
      1000};  ///< the time that viewers get at the end

  /// Whether the text is a numeric IPv4 or IPv6 address.
  static bool is_address(const std::string& address);

  /// Opens the port. Clients can connect from now on; they wait for start().
  /// @throw std::system_error "ADDRESS:PORT: ..."; Error when `address` is no numeric address.
  explicit ImdServer(const ImdOptions& options);
  ~ImdServer();
  ImdServer(const ImdServer&) = delete;
  ImdServer& operator=(const ImdServer&) = delete;

  /// "127.0.0.1:8888", "[::1]:8888": with the port that the system chose.
  const std::string& name() const { return name_; }

  /// Starts the thread, which blocks all signals. Once.
  /// @param tick_s seconds.
  void start(const Scene& scene, bool has_energy, double tick_s, bool paced);
  /// Waits until a client has said GO. False when the time is over or `stop` became nonzero.
  bool wait_for_viewer(std::chrono::duration<double> time, const std::atomic<int>& stop);
  /// Sends a frame to all clients. Without a pace it waits, at most kWait, for clients that still
  /// read an older frame.
  void publish(const Frame& frame);
  /// So far.
  ImdCounts counts();
  /// Gives the clients kLinger to read the rest and to close, then closes them.
  /// @throw what the thread threw
  ImdCounts finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    FileDescriptor socket;
    ImdListener listener;
    Clock::time_point since{};       // accepted; resumed; a frame began
    std::vector<std::byte> message;  // on its way: the greeting or a frame
    std::size_t sent = 0;            // bytes of it
    bool greeted = false;            // the greeting was sent: the message is a frame
    std::uint64_t seen = 0;          // number of the newest frame that the client got or missed
    bool ended = false;              // the client was told that no frame follows
    bool dead = false;
    bool running() const {
      return !dead && listener.state() == ImdListener::State::kRunning && greeted;
    }
  };

  // With mutex_ held:
  void accept_clients();
  void listen_to(Client& client);
  void send_to(Client& client);
  void check(Client& client, Clock::time_point now);
  template <class Predicate>
  bool all_clients(Predicate&& predicate) const;

  void run();
  void wake() noexcept;

  ImdOptions options_;
  FileDescriptor port_;
  FileDescriptor wake_;  // eventfd
  std::string name_;

  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::optional<ImdEncoder> encoder_;
  std::size_t atoms_ = 0;
  bool paced_ = true;
  bool ending_ = false;
  bool stop_ = false;
  std::vector<Client> clients_;    // only the thread adds or takes away
  std::vector<std::byte> newest_;  // frame
  std::uint64_t number_ = 0;       // of that frame; 0: none yet
  ImdCounts counts_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace hapgrid
