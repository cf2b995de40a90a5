// Between the structs of format.hpp and Cap'n Proto's builders and readers. Only for the sources of
// this folder.
#pragma once

#include <capnp/any.h>
#include <capnp/serialize.h>
#include <kj/exception.h>

#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/shard/format.hpp"
#include "shard.capnp.h"

namespace hapgrid {

inline constexpr std::uint64_t kMagic = 0x6861706772696431;  // "hapgrid1"
inline constexpr std::uint32_t kFormatVersion = 1;

/// Decodes one message and hands it to `use`; everything that Cap'n Proto throws becomes a
/// FormatError.
template <class F>
auto read_message(const std::vector<std::uint64_t>& words, const std::string& where, F&& use) {
  try {
    capnp::ReaderOptions options;
    // Columns are looked at once to validate and once to copy; lists of texts in headers more.
    options.traversalLimitInWords = 4 * words.size() + 1024;
    options.nestingLimit = 8;
    const auto* begin = reinterpret_cast<const capnp::word*>(words.data());
    capnp::FlatArrayMessageReader reader(kj::arrayPtr(begin, words.size()), options);
    if (reader.getEnd() != begin + words.size())
      throw FormatError("bytes behind the message in a zstd frame");
    return use(reader.getRoot<schema::Message>());
  } catch (const FormatError& e) {
    throw FormatError(where + ": " + e.what());
  } catch (const kj::Exception& e) {
    throw FormatError(where + ": damaged: " + std::string(e.getDescription().cStr()));
  }
}

/// A place in a file, for messages.
inline std::string at(const InputFile& file, std::uint64_t offset) {
  return file.name() + ": byte " + std::to_string(offset);
}

void encode_header(const SectionHeader& header, schema::Header::Builder out);
void encode_footer(const SectionFooter& footer, schema::Footer::Builder out);

/// @throw FormatError (without the file's name) when the header cannot be a grid's.
SectionHeader decode_header(schema::Header::Reader in);
SectionFooter decode_footer(schema::Footer::Reader in);

}  // namespace hapgrid
