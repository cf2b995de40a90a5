// Reading a session, from any tick on. Everything in a file is checked before it is used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

/// The memory is that of the index, which is in proportion to the file, and of one chunk.
class SessionReader {
 public:
  enum class Damage {
    kRefused,
    /// What is left of a session that was interrupted or is damaged is good enough: chunks that
    /// cannot be read are left out.
    kSalvaged,
  };

  /// Reads header and index. "-" is standard input.
  /// @throw std::system_error; FormatError "NAME: byte N: ..."
  explicit SessionReader(const std::string& name, Damage damage = Damage::kRefused)
      : SessionReader(InputFile(name), damage) {}
  explicit SessionReader(InputFile file, Damage damage = Damage::kRefused);

  /// The name for messages: "standard input" for "-".
  const std::string& name() const { return file_.name(); }
  const SessionHeader& header() const { return header_; }

  /// In the session, and, of what happened, not in it since the disk was too slow.
  std::uint64_t ticks() const { return footer_.ticks; }
  std::uint64_t dropped() const { return footer_.dropped; }
  /// Numbers of the first and last tick; 0 without ticks.
  std::uint64_t first_tick() const { return ticks() == 0 ? 0 : footer_.chunks.front().first; }
  std::uint64_t last_tick() const { return ticks() == 0 ? 0 : footer_.chunks.back().last; }
  /// Of the file, in what could be salvaged only; 0 otherwise.
  std::uint64_t lost_bytes() const { return lost_bytes_; }

  /// The number of the first tick whose time, HEADER.time_of(), is `seconds` or later.
  std::uint64_t tick_at(double seconds) const;

  /// next() goes on with the first tick of this number or above.
  void seek(std::uint64_t number);
  /// The ticks of the next chunk, at least one; false behind the last.
  /// @throw std::system_error; FormatError "NAME: byte N: ..."
  bool next(std::vector<TickRecord>& ticks);

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& what) const;
  /// At most `size` bytes from `offset`; fewer only at the file's end.
  std::span<const std::byte> bytes_at(std::uint64_t offset, std::uint64_t size);
  /// Decodes a frame; whatever is wrong becomes a FormatError with the offset.
  template <class F>
  auto decode(std::span<const std::byte> frame, std::uint64_t offset, std::uint64_t limit, F&& use);
  /// Answers where it ends.
  std::uint64_t read_header();
  void read_index(std::uint64_t header_end);
  void check_index(std::uint64_t header_end, std::uint64_t footer) const;
  void salvage(std::uint64_t header_end);
  void scan(std::uint64_t header_end);
  void read_chunk(const ChunkEntry& chunk, std::vector<TickRecord>& ticks);

  InputFile file_;
  ZstdFrameDecoder frames_{"session"};
  std::vector<std::byte> buffer_;
  Message message_;
  SessionHeader header_;
  Digest header_digest_;
  SessionFooter footer_;
  std::uint64_t lost_bytes_ = 0;
  std::size_t next_ = 0;    // chunk
  std::uint64_t from_ = 0;  // tick
};

}  // namespace hapgrid
