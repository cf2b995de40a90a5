// What the two servers of view have in common: a port that libwebsockets listens on, and callbacks
// that may throw. All of a server is done by one thread, in these callbacks.
#pragma once

#include <libwebsockets.h>

#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "tools/view/feed.hpp"
#include "tools/view/live.hpp"

namespace hapgrid {

class Server {
 public:
  virtual ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

 protected:
  /// Listens. @param protocols each of their callbacks is `call` @throw Error
  Server(const Place& place, const lws_protocols* protocols, std::uint64_t lws_options);

  static int call(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t size);
  /// What a callback of libwebsockets answers.
  virtual int answer(lws* wsi, lws_callback_reasons reason, void* in, size_t size) = 0;
  /// frame_ is a new one.
  virtual void show() = 0;
  /// The last frame was shown.
  virtual void finish() = 0;
  /// @return whether libwebsockets took the bytes; it keeps what does not go at once.
  static bool write(lws* wsi, std::string_view bytes, lws_write_protocol kind);

  /// Waits for the scene. `feed_` is there from then on, and wakes up the server.
  void open(const std::string& frames);
  /// Until done_. @throw what a callback or the feed threw
  void serve();
  int port() const;

  /// Ends serve() so much later.
  void end_after(lws_usec_t time);

  std::optional<Feed> feed_;
  Frame frame_;         // the newest
  bool ended_ = false;  // the last frame came

 private:
  void take_frames();

  bool done_ = false;
  std::exception_ptr failure_;  // of a callback, which is C's
  lws_context* context_ = nullptr;
  struct Farewell : lws_sorted_usec_list_t {
    Server* server;
  } farewell_{};
};

}  // namespace hapgrid
