// The page comes by HTTP; the scene, frames and the end go over a WebSocket. Pages only watch: what
// they send confirms what came.

#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/live.hpp"
#include "tools/view/page/page.hpp"
#include "tools/view/server.hpp"

namespace hapgrid {

namespace {

// Frames on the way to a page that it has not yet confirmed: on a slow line newer ones must not
// queue behind them.
constexpr int kMostOnTheWay = 4;
constexpr std::size_t kMostWaiting = 3;

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

std::string header(lws* wsi, std::string_view name) {
  std::array<char, 512> text{};
  const int length = lws_hdr_custom_copy(wsi, text.data(), static_cast<int>(text.size()),
                                         name.data(), static_cast<int>(name.size()));
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

class WebServer : public Server {
 public:
  WebServer(const Place& place, const RenderOptions& how)
      : Server(place, kProtocols.data(), 0), place_(place), how_(how) {}
  /// Waits for the scene, says the page's address, and serves.
  void run(const std::string& frames);

 private:
  using Message = std::shared_ptr<const std::string>;

  struct Client {
    bool told = false;           // knows the scene
    bool told_end = false;       // knows that there is no frame after those that it has
    int on_the_way = 0;          // frames that it has not confirmed
    std::deque<Message> frames;  // to be sent, the oldest first
  };

  int answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) override;
  int send_page(lws* wsi, const std::string& path);
  int send_body(lws* wsi);
  bool admits(lws* wsi) const;
  void begin(lws* wsi);
  int hear(lws* wsi, std::string_view text);
  int speak(lws* wsi);
  void show() override;
  void finish() override;
  std::string address() const;
  std::string scene_text() const;

  static constexpr std::array<lws_protocols, 3> kProtocols{
      {{"http", call, 0, 0, 0, nullptr, 0},
       {"hapgrid", call, 0, 4096, 0, nullptr, 0},
       {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  const Place& place_;
  const RenderOptions& how_;
  std::string token_ = random_token();
  std::string page_ = page_text("null", "");
  std::map<lws*, Client> clients_;
  Message newest_;  // frame, with which a page begins
};

std::string WebServer::address() const {
  std::array<char, 256> host{};
  const bool any = place_.address == "0.0.0.0";
  if (any) static_cast<void>(::gethostname(host.data(), host.size() - 1));
  return format("http://{}:{}/{}/", any ? host.data() : place_.address, port(), token_);
}

void WebServer::run(const std::string& frames) {
  open(frames);
  write_text("-", address() + "\n");
  if (std::getenv("SSH_CONNECTION") && place_.address == "127.0.0.1")
    say("view", format("over ssh: on your own machine, ssh -L {}:127.0.0.1:{} and the name of this "
                       "one; then open the address there. Ctrl-C here ends it.",
                       port(), port()));
  feed_->start();
  serve();
}

int WebServer::answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) {
  const std::string_view text(static_cast<const char*>(in), in ? size : 0);
  switch (reason) {
    case LWS_CALLBACK_HTTP:
      return send_page(wsi, std::string(text));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return send_body(wsi);
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      if (admits(wsi)) return 0;
      ::lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, nullptr);
      return 1;
    case LWS_CALLBACK_ESTABLISHED:
      begin(wsi);
      return 0;
    case LWS_CALLBACK_CLOSED:
      clients_.erase(wsi);
      return 0;
    case LWS_CALLBACK_RECEIVE:
      return hear(wsi, text);
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return speak(wsi);
    default:
      return ::lws_callback_http_dummy(wsi, reason, nullptr, in, size);
  }
}

int WebServer::send_page(lws* wsi, const std::string& path) {
  if (path != "/" + token_ + "/") {
    const bool icon = path == "/favicon.ico";  // browsers ask for it by themselves
    ::lws_return_http_status(wsi, icon ? HTTP_STATUS_NO_CONTENT : HTTP_STATUS_FORBIDDEN, nullptr);
    return -1;
  }
  constexpr const char* kHead =
      "HTTP/1.1 200 OK\r\ncontent-type: text/html; charset=utf-8\r\ncontent-length: {}\r\n"
      "cache-control: no-store\r\nreferrer-policy: no-referrer\r\nx-content-type-options: "
      "nosniff\r\n"
      "content-security-policy: default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self' ws: wss:; "
      "frame-ancestors 'none'\r\n\r\n";
  if (!write(wsi, format(kHead, page_.size()), LWS_WRITE_HTTP_HEADERS)) return -1;
  ::lws_callback_on_writable(wsi);
  return 0;
}

int WebServer::send_body(lws* wsi) {
  return write(wsi, page_, LWS_WRITE_HTTP_FINAL) && !::lws_http_transaction_completed(wsi) ? 0 : -1;
}

/// Whether a WebSocket comes from our page: its address has the token, and the page that opens it
/// is from here, whatever name and port a tunnel or a proxy gives us.
bool WebServer::admits(lws* wsi) const {
  const std::string origin = header(wsi, WSI_TOKEN_ORIGIN);
  const auto is_from = [&](const std::string& host) {
    return !host.empty() && (origin == "http://" + host || origin == "https://" + host);
  };
  return header(wsi, WSI_TOKEN_GET_URI) == "/" + token_ + "/ws" &&
         (is_from(header(wsi, WSI_TOKEN_HOST)) || is_from(header(wsi, "x-forwarded-host:")));
}

void WebServer::begin(lws* wsi) {
  clients_[wsi] = {};
  if (!newest_) return;
  clients_[wsi].frames.push_back(newest_);
  ::lws_callback_on_writable(wsi);
}

/// A confirmation is the line ".".
int WebServer::hear(lws* wsi, std::string_view text) {
  Client& client = clients_[wsi];
  for (const char c : text) {
    if (c != '.' && c != '\n') return -1;
    client.on_the_way -= c == '.' && client.on_the_way > 0;
  }
  ::lws_callback_on_writable(wsi);
  return 0;
}

std::string WebServer::scene_text() const {
  return script_of({{"scene", page_scene(feed_->scene(), frame_, how_)}});
}

/// One message at a time: libwebsockets asks again when the next one can go.
int WebServer::speak(lws* wsi) {
  Client& client = clients_[wsi];
  if (!newest_) return 0;
  std::string text;
  if (!client.told) {
    text = scene_text();
    client.told = true;
  } else if (!client.frames.empty() && client.on_the_way < kMostOnTheWay) {
    text = *client.frames.front();
    client.frames.pop_front();
    ++client.on_the_way;
  } else if (client.frames.empty() && ended_ && !client.told_end) {
    text = R"({"ended":true})";
    client.told_end = true;
  } else {
    return 0;
  }
  if (!write(wsi, text, LWS_WRITE_TEXT)) return -1;
  ::lws_callback_on_writable(wsi);
  return 0;
}

void WebServer::show() {
  newest_ = std::make_shared<const std::string>(
      script_of({{"frame", page_frame(feed_->scene(), frame_)}}));
  for (auto& [wsi, client] : clients_) {
    client.frames.push_back(newest_);
    if (client.frames.size() > kMostWaiting) client.frames.pop_front();
    ::lws_callback_on_writable(wsi);
  }
}

void WebServer::finish() {
  for (const auto& [wsi, client] : clients_) ::lws_callback_on_writable(wsi);
}

}  // namespace

void run_web(const std::string& frames, const Place& place, const RenderOptions& how) {
  WebServer server(place, how);
  if (!place.address.starts_with("127."))
    say("view",
        format("whoever reaches {} and learns the page's address can watch; nothing on the way "
               "is encrypted",
               place.address));
  server.run(frames);
}

}  // namespace hapgrid
