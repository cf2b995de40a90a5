#include "libcore/session/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/locator.hpp"

namespace hapgrid {

namespace {

// A chunk has columns of at least one tick, in a zstd frame with its checksum: no frame is smaller
// on disk than this.
constexpr std::uint64_t kLeastFrame = 32;
constexpr std::uint64_t kEntryBytes = 64;  // in the footer's message, from above

}  // namespace

SessionReader::SessionReader(InputFile file, Damage damage) : file_(std::move(file)) {
  const std::uint64_t header_end = read_header();
  if (damage == Damage::kSalvaged)
    salvage(header_end);
  else
    read_index(header_end);
}

void SessionReader::fail(std::uint64_t offset, const std::string& what) const {
  throw FormatError(file_.name() + ": byte " + std::to_string(offset) + ": " + what);
}

std::span<const std::byte> SessionReader::bytes_at(std::uint64_t offset, std::uint64_t size) {
  const std::uint64_t left = offset < file_.size() ? file_.size() - offset : 0;
  const auto count = static_cast<std::size_t>(std::min(size, left));
  if (buffer_.size() < count) buffer_.resize(count);
  return {buffer_.data(), file_.read(offset, std::span(buffer_).first(count))};
}

template <class F>
auto SessionReader::decode(std::span<const std::byte> frame, std::uint64_t offset,
                           std::uint64_t limit, F&& use) {
  try {
    frames_.decode(frame, limit, message_);
    return use();
  } catch (const FormatError& e) {
    fail(offset, e.what());
  }
}

std::uint64_t SessionReader::read_header() {
  if (!starts_with_zstd_frame(file_)) fail(0, "not a session: no zstd frame");
  // Most headers are small.
  std::size_t size = 0;
  std::span<const std::byte> bytes;
  for (std::uint64_t window :
       {std::uint64_t{1} << 16, std::uint64_t{zstd_frame_bound(kHeaderLimit)}})
    if (size == 0) size = zstd_frame_size(bytes = bytes_at(0, window));
  if (size == 0) fail(0, "not a session, or its header is cut");
  decode(bytes.first(size), 0, kHeaderLimit, [&] { header_ = decode_header(message_); });
  header_digest_ = digest_of(std::as_bytes(std::span(message_)));
  return size;
}

void SessionReader::read_index(std::uint64_t header_end) {
  const std::uint64_t size = file_.size();
  std::array<std::byte, kLocatorBytes> end;
  std::optional<Locator> locator;
  if (size >= header_end + kLocatorBytes && file_.read(size - kLocatorBytes, end) == kLocatorBytes)
    locator = decode_locator(end);
  if (!locator)
    fail(size,
         "truncated: no index at its end, as of a session that was interrupted (stats "
         "--salvage takes what is there)");
  const std::uint64_t at = size - kLocatorBytes;
  if (locator->size == 0 || locator->size > at - header_end)
    fail(at, "damaged: the index is said to be outside the file");
  const std::uint64_t footer = at - locator->size;
  const std::uint64_t most = (footer - header_end) / kLeastFrame;
  const std::uint64_t limit = kEntryBytes * most + 4096;
  if (locator->size > zstd_frame_bound(limit))
    fail(footer, "damaged: an index larger than any can be");
  const std::span<const std::byte> frame = bytes_at(footer, locator->size);
  if (hash_of(frame) != locator->hash) fail(footer, "damaged: the index does not fit its hash");
  decode(frame, footer, limit, [&] {
    footer_ = decode_footer(message_, most);
    check_index(header_end, footer);
  });
}

/// @throw FormatError without file and offset
void SessionReader::check_index(std::uint64_t header_end, std::uint64_t footer) const {
  std::uint64_t offset = header_end;
  std::uint64_t ticks = 0;
  const ChunkEntry* before = nullptr;
  std::vector<Digest> digests{header_digest_};
  digests.reserve(footer_.chunks.size() + 1);
  for (const ChunkEntry& chunk : footer_.chunks) {
    if (chunk.offset != offset || chunk.size == 0 || chunk.size > footer - offset ||
        chunk.size > zstd_frame_bound(kChunkLimit) || chunk.ticks == 0 ||
        chunk.ticks > kChunkTicks || chunk.last < chunk.first ||
        chunk.last - chunk.first < chunk.ticks - 1 || (before && chunk.first <= before->last))
      throw FormatError("damaged: the index does not fit the file");
    offset += chunk.size;
    ticks += chunk.ticks;
    digests.push_back(chunk.digest);
    before = &chunk;
  }
  if (offset != footer || ticks != footer_.ticks)
    throw FormatError("damaged: the index does not fit the file");
  if (digest_of(std::as_bytes(std::span(digests))) != footer_.digest)
    throw FormatError("damaged: header and index do not fit the digest");
}

void SessionReader::salvage(std::uint64_t header_end) {
  std::vector<TickRecord> ticks;
  try {
    read_index(header_end);
  } catch (const FormatError&) {
    footer_ = {};
    scan(header_end);
    return;
  }
  footer_.ticks = 0;
  for (const ChunkEntry& chunk : std::exchange(footer_.chunks, {})) {
    try {
      read_chunk(chunk, ticks);
      footer_.ticks += chunk.ticks;
      footer_.chunks.push_back(chunk);
    } catch (const FormatError&) {
      lost_bytes_ += chunk.size;
    }
  }
}

/// Makes an index from the chunks that can be read, without a footer.
void SessionReader::scan(std::uint64_t header_end) {
  std::uint64_t offset = header_end;
  std::vector<TickRecord> ticks;
  while (offset < file_.size()) {
    const std::span<const std::byte> bytes = bytes_at(offset, zstd_frame_bound(kChunkLimit));
    const std::size_t size = zstd_frame_size(bytes);
    if (size == 0) break;  // cut
    try {
      frames_.decode(bytes.first(size), kChunkLimit, message_);
      decode_ticks(message_, ticks);
      if (!footer_.chunks.empty() && ticks.front().number <= footer_.chunks.back().last)
        throw FormatError("ticks out of order");
      footer_.chunks.push_back({offset, size, ticks.front().number, ticks.back().number,
                                static_cast<std::uint32_t>(ticks.size()),
                                digest_of(std::as_bytes(std::span(message_)))});
      footer_.ticks += ticks.size();
    } catch (const FormatError&) {
      lost_bytes_ += size;
    }
    offset += size;
  }
  lost_bytes_ += file_.size() - offset;
}

std::uint64_t SessionReader::tick_at(double seconds) const {
  const double guess = std::ceil(seconds * header_.rate_hz);
  if (!(guess > 0)) return 0;
  // Beyond 2^53 neighbouring numbers have the same time; no play lasts that long.
  if (guess >= 0x1p53) return std::numeric_limits<std::uint64_t>::max();
  auto number = static_cast<std::uint64_t>(guess);
  while (number > 0 && header_.time_of(number - 1) >= seconds) --number;
  while (header_.time_of(number) < seconds) ++number;
  return number;
}

void SessionReader::seek(std::uint64_t number) {
  const auto found = std::partition_point(footer_.chunks.begin(), footer_.chunks.end(),
                                          [&](const ChunkEntry& c) { return c.last < number; });
  next_ = static_cast<std::size_t>(found - footer_.chunks.begin());
  from_ = number;
}

void SessionReader::read_chunk(const ChunkEntry& chunk, std::vector<TickRecord>& ticks) {
  decode(bytes_at(chunk.offset, chunk.size), chunk.offset, kChunkLimit, [&] {
    if (digest_of(std::as_bytes(std::span(message_))) != chunk.digest)
      throw FormatError("damaged: a chunk does not fit the index's digest of it");
    decode_ticks(message_, ticks);
    if (ticks.size() != chunk.ticks || ticks.front().number != chunk.first ||
        ticks.back().number != chunk.last)
      throw FormatError("damaged: a chunk does not fit what the index says of it");
  });
}

bool SessionReader::next(std::vector<TickRecord>& ticks) {
  if (next_ == footer_.chunks.size()) return false;
  read_chunk(footer_.chunks[next_++], ticks);
  const auto first = std::partition_point(
      ticks.begin(), ticks.end(), [&](const TickRecord& tick) { return tick.number < from_; });
  ticks.erase(ticks.begin(), first);
  return true;
}

}  // namespace hapgrid
