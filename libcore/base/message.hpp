// Cap'n Proto messages as shards, sessions and streams of frames have them: built in one buffer,
// and read although they may be hostile. Only for the sources that know a schema: these headers are
// heavy.
#pragma once

#include <capnp/any.h>
#include <capnp/message.h>
#include <capnp/serialize.h>
#include <kj/exception.h>
#include <kj/io.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/zstd_frame.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little,
              "columns are copied as they are in memory, and Cap'n Proto is little-endian");

/// @param what it is, for the message @throw FormatError when it is longer than `limit` bytes
inline std::string get_text(capnp::Text::Reader in, std::size_t limit, const char* what) {
  if (in.size() > limit)
    throw FormatError(format("{} of {} bytes, the limit is {}", what, in.size(), limit));
  return std::string(in.begin(), in.size());
}

/// Builds a message with `fill(Root::Builder)` into `message`.
/// @param words that it needs, without the segment table; a guess that is too small costs time only
/// @param scratch memory of the caller for one message after the other; only zeros in between
template <class Root, class Fill>
void build_message(std::size_t words, MessageWords& scratch, MessageWords& message, Fill&& fill) {
  if (scratch.size() < words) scratch.assign(words, 0);
  capnp::MallocMessageBuilder builder(
      kj::arrayPtr(reinterpret_cast<capnp::word*>(scratch.data()), scratch.size()));
  fill(builder.initRoot<Root>());
  const auto segments = builder.getSegmentsForOutput();
  message.resize(capnp::computeSerializedSizeInWords(segments));
  kj::ArrayOutputStream out(kj::arrayPtr(reinterpret_cast<kj::byte*>(message.data()),
                                         message.size() * sizeof(std::uint64_t)));
  capnp::writeMessage(out, segments);
}

/// Hands the message's `Root::Reader` to `use`, and answers what that answers. Everything that
/// Cap'n Proto throws becomes a FormatError (without the file's name).
template <class Root, class Use>
auto read_message(std::span<const std::uint64_t> words, Use&& use) {
  try {
    capnp::ReaderOptions options;
    // Columns are looked at once to validate and once to copy; lists of texts in headers more.
    options.traversalLimitInWords = 4 * words.size() + 1024;
    options.nestingLimit = 8;
    const auto* begin = reinterpret_cast<const capnp::word*>(words.data());
    capnp::FlatArrayMessageReader reader(kj::arrayPtr(begin, words.size()), options);
    if (reader.getEnd() != begin + words.size())
      throw FormatError("damaged: bytes behind the message");
    return use(reader.getRoot<Root>());
  } catch (const kj::Exception& e) {
    throw FormatError(format("damaged: {}", e.getDescription().cStr()));
  }
}

/// A column of `count` numbers of a message. A hostile list may have been encoded with another
/// element size. @throw FormatError
template <class T, class List>
std::span<const T> column(List list, std::size_t count, const char* name) {
  constexpr auto kSize =
      sizeof(T) == 8 ? capnp::ElementSize::EIGHT_BYTES : capnp::ElementSize::FOUR_BYTES;
  const capnp::AnyList::Reader any(list);
  if (any.size() != count || (count > 0 && any.getElementSize() != kSize))
    throw FormatError(format("damaged: column {} does not fit the chunk", name));
  return {reinterpret_cast<const T*>(any.getRawBytes().begin()), count};
}

/// A column of bytes.
inline std::span<const std::uint8_t> column(capnp::Data::Reader data, std::size_t bytes,
                                            const char* name) {
  if (data.size() != bytes)
    throw FormatError(format("damaged: column {} does not fit the chunk", name));
  return {data.begin(), bytes};
}

/// The same of a message that is being built, to be filled. (Cap'n Proto has raw bytes for its
/// readers only.)
template <class T, class List>
std::span<T> column_to_fill(List list) {
  const auto bytes = capnp::AnyList::Reader(list.asReader()).getRawBytes();
  return {reinterpret_cast<T*>(const_cast<kj::byte*>(bytes.begin())), list.size()};
}

}  // namespace hapgrid
