// Writing a session: header, chunks, footer (schemas/session.capnp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

/// A session cannot be repeated: a hand was there once. So it is written chunk by chunk as
/// NAME.part, and becomes NAME when it is whole. An interrupted session stays NAME.part, which
/// readers refuse as truncated unless they are asked to salvage it. Alternatives: a file without a
/// name would be lost with the process; NAME itself would destroy an old session, and half a
/// session would look whole.
class SessionWriter {
 public:
  /// Writes the header at once. "-" is standard output; a device or pipe is written directly.
  /// @throw Error for a header that cannot be (SessionHeader::validate()), for a NAME.part that is
  /// there already; std::system_error
  SessionWriter(const std::string& name, const SessionHeader& header);
  /// Without finish() NAME.part stays, if a chunk of ticks is in it.
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// @throw Error when its number is not above the last one's; std::system_error
  void add(const TickRecord& tick);
  std::uint64_t ticks() const { return footer_.ticks + rows_.size(); }

  /// Writes what is left and the footer, and lets the file appear. @param dropped ticks that never
  /// came here. @throw std::system_error
  void finish(std::uint64_t dropped = 0);

  /// Whether a chunk of ticks is in the file.
  bool any_written() const { return !footer_.chunks.empty(); }
  /// The file's name until finish(): NAME.part; empty for a device or pipe.
  std::string part() const { return output_.part(); }

 private:
  /// Answers the frame's size.
  std::uint64_t write(const Message& message);
  void flush();

  OutputFile output_;
  ZstdFrameEncoder frames_{
      3};  // the slow thread has time, and a session is kept: zstd's own default
  std::vector<TickRecord> rows_;  // of the chunk that is being filled
  SessionFooter footer_;
  std::vector<Digest> digests_;
  std::uint64_t offset_ = 0;
  std::uint64_t footer_hash_ = 0;
  bool any_ = false;
  std::uint64_t last_ = 0;  // number
};

}  // namespace hapgrid
