#include <sys/socket.h>

#include <array>
#include <map>
#include <span>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/imd_protocol.hpp"
#include "tools/view/live.hpp"
#include "tools/view/server.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMostViewers = 8;
// Seconds until GO. The protocol asks for one; the second one is for slow machines.
constexpr int kGreeting = 2;
constexpr int kPatience = 5;                      // seconds, with a viewer that reads one frame
constexpr lws_usec_t kReadRest = LWS_US_PER_SEC;  // for viewers to read the rest
constexpr int kSendBuffer = 1 << 16;  // bytes; small, so that nobody sees what is long past

class ImdServer : public Server {
 public:
  explicit ImdServer(const Place& place)
      : Server(place, kProtocols.data(), LWS_SERVER_OPTION_ONLY_RAW) {
    say("view", format("IMD on {}:{}", place.address, port()));
  }
  void run(const std::string& frames);

 private:
  struct Viewer {
    ImdListener listener;
    bool greeted = false;
    bool behind = false;  // it has yet to get the newest frame
    bool running() const { return listener.state() == ImdListener::State::kRunning; }
  };

  int answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) override;
  int begin(lws* wsi);
  int hear(lws* wsi, std::span<const std::byte> bytes);
  int speak(lws* wsi);
  void show() override;
  void finish() override;
  void say_once(bool& said, const std::string& text);

  static constexpr std::array<lws_protocols, 2> kProtocols{
      {{"imd", call, 0, 4096, 0, nullptr, 0}, {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  std::map<lws*, Viewer> viewers_;
  std::vector<std::byte> newest_;  // frame
  std::uint64_t came_ = 0, sent_ = 0;
  bool said_forces_ = false, said_rate_ = false, said_full_ = false;
};

void ImdServer::run(const std::string& frames) {
  open(frames);
  const Scene& scene = feed_->scene();
  const ImdUnits units(scene);
  const auto say_unit = [](const char* what, const std::string& unit, const char* taken_for) {
    say("view", format("IMD: {} go out in {}, viewers take them for {}", what,
                       unit.empty() ? "a unit without a name" : unit, taken_for));
  };
  if (!units.length_known) say_unit("lengths", scene.length_unit, "angstrom");
  if (!units.energy_known && !scene.energy_unit.empty())
    say_unit("energies", scene.energy_unit, "kcal/mol");
  if (!feed_->recorded()) feed_->start();
  serve();
  if (newest_.empty()) throw Error(format("{}: no frame in it, nothing to show", feed_->name()));
  say("view", format("IMD viewers {}, frames sent {}", came_, sent_));
}

int ImdServer::answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) {
  switch (reason) {
    case LWS_CALLBACK_RAW_ADOPT:
      return begin(wsi);
    case LWS_CALLBACK_RAW_RX:
      return hear(wsi, {static_cast<const std::byte*>(in), size});
    case LWS_CALLBACK_RAW_WRITEABLE:
      return speak(wsi);
    case LWS_CALLBACK_RAW_CLOSE:
      viewers_.erase(wsi);
      if (ended_ && viewers_.empty()) end_after(0);
      return 0;
    default:
      return 0;
  }
}

int ImdServer::begin(lws* wsi) {
  if (ended_ || viewers_.size() >= kMostViewers) {
    if (!ended_)
      say_once(said_full_,
               format("one more viewer came and was sent away: {} can watch", kMostViewers));
    return -1;
  }
  ::setsockopt(::lws_get_socket_fd(wsi), SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
  viewers_.insert({wsi, {.listener = ImdListener(feed_->scene().spheres.size() + 1)}});
  ::lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, kGreeting);
  ::lws_callback_on_writable(wsi);
  return 0;
}

int ImdServer::hear(lws* wsi, std::span<const std::byte> bytes) {
  const auto viewer = viewers_.find(wsi);
  if (viewer == viewers_.end()) return -1;
  using State = ImdListener::State;
  ImdListener& listener = viewer->second.listener;
  const State before = listener.state();
  const State after = listener.read(bytes);
  if (listener.sent_forces())
    say_once(said_forces_,
             "a viewer sends forces; they are ignored, since the hand alone moves the model");
  if (listener.sent_rate())
    say_once(said_rate_,
             "a viewer asks for another rate (TRATE); it gets each frame that play makes");
  if (after == State::kClosed) return -1;
  if (before != State::kGreeted || after == before) return 0;
  ::lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0);
  if (++came_ == 1 && feed_->recorded()) feed_->start();
  return 0;
}

/// Called when all that was written before has gone.
int ImdServer::speak(lws* wsi) {
  Viewer& viewer = viewers_.at(wsi);
  const bool frame = viewer.greeted;
  if (frame && viewer.running()) ::lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0);
  if (frame && (!viewer.behind || !viewer.running())) return ended_ ? -1 : 0;
  const std::vector<std::byte> bytes = frame ? newest_ : imd_greeting();
  if (!write(wsi, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, LWS_WRITE_RAW))
    return -1;
  viewer.greeted = true;
  viewer.behind = false;
  sent_ += frame;
  if (frame) ::lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, kPatience);
  ::lws_callback_on_writable(wsi);
  return 0;
}

void ImdServer::show() {
  newest_ = imd_frame(frame_, ImdUnits(feed_->scene()));
  for (auto& [wsi, viewer] : viewers_) {
    viewer.behind = viewer.greeted && viewer.running();
    ::lws_callback_on_writable(wsi);
  }
}

void ImdServer::finish() {
  for (const auto& [wsi, viewer] : viewers_) ::lws_callback_on_writable(wsi);
  end_after(viewers_.empty() ? 0 : kReadRest);
}

void ImdServer::say_once(bool& said, const std::string& text) {
  if (!said) say("view", "IMD: " + text);
  said = true;
}

}  // namespace

void run_imd(const std::string& frames, const Place& place) { ImdServer(place).run(frames); }

}  // namespace hapgrid
