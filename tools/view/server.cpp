#include "tools/view/server.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

/// False for an address that this machine has not: newer versions of libwebsockets wait until it
/// has.
bool can_be_ours(const std::string& address) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  ::inet_pton(AF_INET, address.c_str(), &place.sin_addr);
  const FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  return socket && ::bind(socket.get(), reinterpret_cast<sockaddr*>(&place), sizeof place) == 0;
}

}  // namespace

Server::Server(const Place& place, const lws_protocols* protocols, std::uint64_t lws_options) {
  ::lws_set_log_level(0, nullptr);
  // Who is silent is asked after 5 s, and given up after 20 s.
  static const lws_retry_bo_t kPatience{nullptr, 0, 0, 5, 20, 0};
  lws_context_creation_info info{};
  info.port = place.port;
  info.iface = place.address.c_str();
  info.protocols = protocols;
  info.retry_and_idle_policy = &kPatience;
  info.user = this;
  info.options =
      lws_options | LWS_SERVER_OPTION_DISABLE_IPV6 | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  if (can_be_ours(place.address)) context_ = ::lws_create_context(&info);
  if (!context_)
    throw Error(format("cannot listen on port {} of {}: is another program there?", place.port,
                       place.address));
}

Server::~Server() {
  feed_.reset();  // its thread wakes up the context
  ::lws_context_destroy(context_);
}

int Server::call(lws* wsi, lws_callback_reasons reason, void*, void* in, size_t size) {
  auto* const server = static_cast<Server*>(::lws_context_user(::lws_get_context(wsi)));
  if (!server->feed_) return 0;  // while it is made or ended
  try {
    if (reason != LWS_CALLBACK_EVENT_WAIT_CANCELLED) return server->answer(wsi, reason, in, size);
    server->take_frames();
    return 0;
  } catch (...) {
    server->failure_ = std::current_exception();
    return -1;
  }
}

bool Server::write(lws* wsi, std::string_view bytes, lws_write_protocol kind) {
  std::string room = std::string(LWS_PRE, ' ').append(bytes);
  return ::lws_write(wsi, reinterpret_cast<unsigned char*>(room.data()) + LWS_PRE, bytes.size(),
                     kind) >= static_cast<int>(bytes.size());
}

void Server::take_frames() {
  Feed::State state;
  do {
    state = feed_->update(frame_);
    if (state.fresh) show();
  } while (state.more);
  if (!state.ended || ended_) return;
  ended_ = true;
  finish();
}

void Server::open(const std::string& frames) {
  feed_.emplace(frames, [this] { ::lws_cancel_service(context_); });
}

void Server::serve() {
  while (!done_ && ::lws_service(context_, 0) >= 0) {
    if (failure_) std::rethrow_exception(failure_);
    if (ended_) feed_->check();
  }
}

int Server::port() const {
  return ::lws_get_vhost_listen_port(::lws_get_vhost_by_name(context_, "default"));
}

void Server::end_after(lws_usec_t time) {
  farewell_.server = this;
  const auto end = [](lws_sorted_usec_list_t* list) {
    Server* const server = static_cast<Farewell*>(list)->server;
    server->done_ = true;
    ::lws_cancel_service(server->context_);
  };
  ::lws_sul_schedule(context_, 0, &farewell_, end, time);
}

}  // namespace hapgrid
