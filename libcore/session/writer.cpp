#include "libcore/session/writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

SessionWriter::SessionWriter(const std::string& name, const SessionHeader& header) : name_(name) {
  const Message message = encode_header(header);
  file_ = FileDescriptor(::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file_) throw std::system_error(errno, std::generic_category(), name);
  rows_.reserve(kChunkTicks);
  write(message);
}

void SessionWriter::write(const Message& message) {
  write_all(file_.get(), frames_.encode(std::as_bytes(std::span(message))), name_);
}

void SessionWriter::write_chunk(std::uint64_t dropped) {
  write(encode_ticks(rows_, dropped));
  rows_.clear();
}

void SessionWriter::add(const TickRecord& tick, std::uint64_t dropped) {
  if (ticks_ > 0 && tick.number <= last_)
    throw Error(format("{}: tick {} after tick {}", name_, tick.number, last_));
  // A full chunk waits for the next tick, so that finish() always has one to tell `dropped` with.
  if (rows_.size() == kChunkTicks) write_chunk(dropped);
  ++ticks_;
  last_ = tick.number;
  rows_.push_back(tick);
}

void SessionWriter::finish(std::uint64_t dropped) {
  if (!rows_.empty()) write_chunk(dropped);
  // EINVAL: a device or a pipe, which has no disk.
  if (::fsync(file_.get()) != 0 && errno != EINVAL)
    throw std::system_error(errno, std::generic_category(), name_);
  file_ = FileDescriptor();  // The reader of a pipe waits for its end.
}

}  // namespace hapgrid
