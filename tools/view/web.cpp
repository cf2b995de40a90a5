// The page comes by HTTP; the scene, frames, the hand's moves and the end go over a WebSocket. All
// is done by one thread, in callbacks of libwebsockets; the thread of Feed only wakes it up.
//
// Who is the hand. The first page that comes while nobody is. When that page is closed, or its
// machine no longer answers, another one may take the hand within kGrace (a page that is loaded
// anew); then the pipe is closed, by which play ends with a zero force.

#include "tools/view/web.hpp"

#include <libwebsockets.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/device/path.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/hand.hpp"
#include "tools/view/page/page.hpp"

namespace hapgrid {

namespace {

constexpr lws_usec_t kGrace = 2 * LWS_US_PER_SEC;
constexpr lws_usec_t kFarewell = LWS_US_PER_SEC / 2;
// Frames on the way to a page that it has not yet confirmed: on a slow line newer ones must not
// queue behind them.
constexpr int kMostOnTheWay = 4;
constexpr std::size_t kMostWaiting = 3;
constexpr std::size_t kPiece = 1 << 14;    // bytes of the page at a time
constexpr std::size_t kLongestMove = 255;  // bytes

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "getrandom");
  std::string token;
  for (const unsigned char byte : bytes) token += format("{:02x}", byte);
  return token;
}

std::string header(lws* wsi, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int length = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

class Server {
 public:
  /// Listens. @throw Error
  explicit Server(const WebOptions& options);
  ~Server() {
    feed_.reset();  // its thread wakes up the context
    ::lws_context_destroy(context_);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Waits for the scene, takes the hand's pipe, says the page's address, and serves.
  void run(const std::string& frames);

 private:
  using Message = std::shared_ptr<const std::string>;  // behind LWS_PRE bytes of room

  struct Client {
    bool told = false;           // knows the scene
    int on_the_way = 0;          // frames that it has not confirmed
    std::deque<Message> frames;  // to be sent, the oldest first
    std::vector<std::string> texts;
    std::string heard;  // the beginning of a line
  };

  static int call(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t size);
  int answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size);
  int send_page(lws* wsi, const std::string& path);
  int send_more(lws* wsi);
  bool admits(lws* wsi) const;
  void begin(lws* wsi);
  void end(lws* wsi);
  int hear(lws* wsi, std::string_view text);
  int speak(lws* wsi);
  void take_frames();
  std::string address() const;
  std::string scene_text() const;

  const WebOptions& options_;
  std::optional<Feed> feed_;
  std::optional<Hand> hand_;
  lws* holder_ = nullptr;  // whose page is the hand
  std::string token_ = random_token();
  std::string page_ = page_text("null");
  std::map<lws*, std::size_t> page_sent_;  // bytes, by connections that load it
  std::map<lws*, Client> clients_;
  Frame frame_;
  bool has_frame_ = false;
  bool ended_ = false;
  bool done_ = false;
  std::exception_ptr failure_;  // of a callback, which is C's
  lws_context* context_ = nullptr;
  // A timer of libwebsockets, which finds the server behind it.
  struct Timer {
    lws_sorted_usec_list_t list{};
    Server* server = nullptr;
  };
  Timer grace_, farewell_;
};

Server::Server(const WebOptions& options) : options_(options) {
  grace_.server = farewell_.server = this;
  ::lws_set_log_level(0, nullptr);
  static const std::array<lws_protocols, 3> kProtocols{{{"http", call, 0, 0, 0, nullptr, 0},
                                                        {"hapgrid", call, 0, 4096, 0, nullptr, 0},
                                                        {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  // Who is silent is asked after 5 s, and given up after 20 s.
  static const lws_retry_bo_t kPatience{nullptr, 0, 0, 5, 20, 0};
  lws_context_creation_info info{};
  info.port = options.port;
  info.iface = options.address.c_str();
  info.protocols = kProtocols.data();
  info.retry_and_idle_policy = &kPatience;
  info.user = this;
  info.options = LWS_SERVER_OPTION_DISABLE_IPV6 | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  context_ = ::lws_create_context(&info);
  if (!context_)
    throw Error(format("cannot listen on port {} of {}: is another program there?", options.port,
                       options.address));
}

std::string Server::address() const {
  std::array<char, 256> host{};
  const bool any = options_.address == "0.0.0.0";
  if (any) static_cast<void>(::gethostname(host.data(), host.size() - 1));
  lws_vhost* const vhost = ::lws_get_vhost_by_name(context_, "default");
  return format("http://{}:{}/{}/", any ? host.data() : options_.address,
                ::lws_get_vhost_listen_port(vhost), token_);
}

void Server::run(const std::string& frames) {
  feed_.emplace(frames, [this] { ::lws_cancel_service(context_); });
  // Play has opened the pipe before the scene came.
  if (!options_.hand.empty()) hand_.emplace(options_.hand, feed_->scene().box);
  OutputFile output("-", /*binary=*/false);
  output.write(address() + "\n");
  output.commit();
  feed_->start();
  while (!done_) {
    if (::lws_service(context_, 0) < 0) break;
    if (failure_) std::rethrow_exception(failure_);
    if (ended_) feed_->check();
  }
}

int Server::call(lws* wsi, lws_callback_reasons reason, void*, void* in, size_t size) {
  auto* const server = static_cast<Server*>(::lws_context_user(::lws_get_context(wsi)));
  try {
    return server->answer(wsi, reason, in, size);
  } catch (...) {
    server->failure_ = std::current_exception();
    return -1;
  }
}

int Server::answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) {
  const std::string_view text(static_cast<const char*>(in), in ? size : 0);
  switch (reason) {
    case LWS_CALLBACK_HTTP:
      return send_page(wsi, std::string(text));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return send_more(wsi);
    case LWS_CALLBACK_CLOSED_HTTP:
      page_sent_.erase(wsi);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      if (admits(wsi)) return 0;
      ::lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, nullptr);
      return 1;
    case LWS_CALLBACK_ESTABLISHED:
      begin(wsi);
      return 0;
    case LWS_CALLBACK_CLOSED:
      end(wsi);
      return 0;
    case LWS_CALLBACK_RECEIVE:
      return hear(wsi, text);
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return speak(wsi);
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      take_frames();
      return 0;
    default:
      return ::lws_callback_http_dummy(wsi, reason, nullptr, in, size);
  }
}

int Server::send_page(lws* wsi, const std::string& path) {
  if (path != "/" + token_ + "/") {
    const bool icon = path == "/favicon.ico";  // browsers ask for it by themselves
    ::lws_return_http_status(wsi, icon ? HTTP_STATUS_NO_CONTENT : HTTP_STATUS_FORBIDDEN, nullptr);
    return -1;
  }
  std::array<unsigned char, LWS_PRE + 2048> buffer{};
  unsigned char* const start = buffer.data() + LWS_PRE;
  unsigned char* end = buffer.data() + buffer.size() - 1;
  unsigned char* p = start;
  bool failed = ::lws_add_http_common_headers(wsi, HTTP_STATUS_OK, "text/html; charset=utf-8",
                                              page_.size(), &p, end) != 0;
  const std::array<std::array<const char*, 2>, 4> headers{
      {{"cache-control:", "no-store"},
       {"referrer-policy:", "no-referrer"},
       {"x-content-type-options:", "nosniff"},
       {"content-security-policy:",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
        "img-src data: blob:; connect-src 'self' ws:; frame-ancestors 'none'"}}};
  for (const auto& [name, value] : headers)
    failed = failed || ::lws_add_http_header_by_name(
                           wsi, reinterpret_cast<const unsigned char*>(name),
                           reinterpret_cast<const unsigned char*>(value),
                           static_cast<int>(std::string_view(value).size()), &p, end) != 0;
  if (failed || ::lws_finalize_write_http_header(wsi, start, &p, end) != 0) return -1;
  page_sent_[wsi] = 0;
  ::lws_callback_on_writable(wsi);
  return 0;
}

/// The next piece of the page.
int Server::send_more(lws* wsi) {
  const auto sent = page_sent_.find(wsi);
  if (sent == page_sent_.end()) return 0;
  std::string bytes = std::string(LWS_PRE, ' ') + page_.substr(sent->second, kPiece);
  const std::size_t count = bytes.size() - LWS_PRE;
  const bool last = sent->second + count == page_.size();
  if (::lws_write(wsi, reinterpret_cast<unsigned char*>(bytes.data()) + LWS_PRE, count,
                  last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < static_cast<int>(count))
    return -1;
  sent->second += count;
  if (!last) {
    ::lws_callback_on_writable(wsi);
    return 0;
  }
  page_sent_.erase(sent);
  return ::lws_http_transaction_completed(wsi) ? -1 : 0;
}

/// Whether a WebSocket comes from our page: its address has the token, and the page that opens it
/// is from here, whatever name and port a tunnel gives us.
bool Server::admits(lws* wsi) const {
  const std::string host = header(wsi, WSI_TOKEN_HOST);
  return header(wsi, WSI_TOKEN_GET_URI) == "/" + token_ + "/ws" && !host.empty() &&
         header(wsi, WSI_TOKEN_ORIGIN) == "http://" + host;
}

void Server::begin(lws* wsi) {
  clients_[wsi] = {};
  if (hand_ && !holder_) {
    holder_ = wsi;
    ::lws_sul_cancel(&grace_.list);
  }
  if (has_frame_) ::lws_callback_on_writable(wsi);
}

void Server::end(lws* wsi) {
  clients_.erase(wsi);
  if (holder_ != wsi) return;
  holder_ = nullptr;
  ::lws_sul_schedule(
      context_, 0, &grace_.list,
      [](lws_sorted_usec_list_t* list) {
        Server& server = *lws_container_of(list, Timer, list)->server;
        if (!server.holder_) server.hand_.reset();
      },
      kGrace);
}

/// Lines: a confirmation, which is a dot, where the hand is, or that it wants the next level.
int Server::hear(lws* wsi, std::string_view text) {
  Client& client = clients_[wsi];
  client.heard += text;
  std::size_t begin = 0;
  std::optional<Vec3> place;
  for (std::size_t end; (end = client.heard.find('\n', begin)) != std::string::npos;
       begin = end + 1) {
    const std::string line = client.heard.substr(begin, end - begin);
    if (line == ".") {
      client.on_the_way = std::max(0, client.on_the_way - 1);
      ::lws_callback_on_writable(wsi);
    } else if (line == kHandNext) {
      if (wsi == holder_ && hand_) hand_->next_level();
    } else {
      try {
        place = parse_position(line);
      } catch (const Error&) {
        return -1;
      }
    }
  }
  client.heard.erase(0, begin);
  if (client.heard.size() > kLongestMove) return -1;
  if (place && wsi == holder_ && hand_) hand_->move_to(*place);
  return 0;
}

std::string Server::scene_text() const {
  return script_of({{"scene", page_scene(feed_->scene(), frame_, options_.render,
                                         options_.azimuth_degrees, options_.elevation_degrees)}});
}

/// One message at a time: libwebsockets asks again when the next one can go.
int Server::speak(lws* wsi) {
  Client& client = clients_[wsi];
  if (!has_frame_) return 0;
  std::string text;
  if (!client.told) {
    text = scene_text();
    client.told = true;
    if (wsi == holder_ && hand_)
      client.texts.push_back(script_of({{"hand", hand_->place().value_or(frame_.position)}}));
  } else if (!client.texts.empty()) {
    text = client.texts.front();
    client.texts.erase(client.texts.begin());
  }
  const bool frame = text.empty() && !client.frames.empty() && client.on_the_way < kMostOnTheWay;
  if (frame) {
    text = *client.frames.front();
    client.frames.pop_front();
    ++client.on_the_way;
  }
  if (text.empty()) return 0;
  std::string bytes = std::string(LWS_PRE, ' ') + text;
  if (::lws_write(wsi, reinterpret_cast<unsigned char*>(bytes.data()) + LWS_PRE, text.size(),
                  frame ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < static_cast<int>(text.size()))
    return -1;
  ::lws_callback_on_writable(wsi);
  return 0;
}

void Server::take_frames() {
  Feed::State state;
  do {
    state = feed_->update(frame_);
    if (!state.fresh) break;
    has_frame_ = true;
    const auto message =
        std::make_shared<const std::string>(page_frame(feed_->scene(), frame_, options_.render));
    for (auto& [wsi, client] : clients_) {
      client.frames.push_back(message);
      if (client.frames.size() > kMostWaiting) client.frames.pop_front();
      ::lws_callback_on_writable(wsi);
    }
  } while (state.more);
  if (!state.ended || ended_) return;
  ended_ = true;
  for (auto& [wsi, client] : clients_) {
    client.texts.push_back(R"({"ended":true})");
    ::lws_callback_on_writable(wsi);
  }
  if (!options_.close) return;
  ::lws_sul_schedule(
      context_, 0, &farewell_.list,
      [](lws_sorted_usec_list_t* list) {
        Server& server = *lws_container_of(list, Timer, list)->server;
        server.done_ = true;
        ::lws_cancel_service(server.context_);
      },
      kFarewell);
}

}  // namespace

void run_web(const std::string& frames, const WebOptions& options) {
  Server server(options);
  if (!options.address.starts_with("127."))
    say("view",
        format("whoever reaches {} and learns the page's address can watch, or be the hand; "
               "nothing on the way is encrypted",
               options.address));
  server.run(frames);
}

}  // namespace hapgrid
