#include "libcore/session/writer.hpp"

#include "libcore/base/error.hpp"
#include "libcore/base/locator.hpp"

namespace hapgrid {

SessionWriter::SessionWriter(const std::string& name, const SessionHeader& header)
    : output_((header.validate(), OutputFile::part_file(name))) {
  try {
    rows_.reserve(kChunkTicks);
    write(encode_header(header));
  } catch (...) {
    output_.discard();
    throw;
  }
}

SessionWriter::~SessionWriter() {
  if (footer_.chunks.empty()) output_.discard();
}

std::uint64_t SessionWriter::write(const Message& message) {
  const auto bytes = std::as_bytes(std::span(message));
  const std::span<const std::byte> frame = frames_.encode(bytes);
  output_.write(frame);
  offset_ += frame.size();
  digests_.push_back(digest_of(bytes));
  footer_hash_ = hash_of(frame);
  return frame.size();
}

void SessionWriter::add(const TickRecord& tick) {
  if (any_ && tick.number <= last_)
    throw Error(output_.name() + ": tick " + std::to_string(tick.number) + " after tick " +
                std::to_string(last_));
  any_ = true;
  last_ = tick.number;
  rows_.push_back(tick);
  if (rows_.size() == kChunkTicks) flush();
}

void SessionWriter::flush() {
  if (rows_.empty()) return;
  const std::uint64_t offset = offset_;
  const std::uint64_t size = write(encode_ticks(rows_));
  footer_.chunks.push_back({offset, size, rows_.front().number, rows_.back().number,
                            static_cast<std::uint32_t>(rows_.size()), digests_.back()});
  footer_.ticks += rows_.size();
  rows_.clear();
}

void SessionWriter::finish(std::uint64_t dropped) {
  flush();
  footer_.dropped = dropped;
  footer_.digest = digest_of(std::as_bytes(std::span(digests_)));
  const std::uint64_t size = write(encode_footer(footer_));
  output_.write(encode_locator({size, footer_hash_}));
  output_.commit();
}

}  // namespace hapgrid
