// Between the structs of format.hpp and Cap'n Proto's builders and readers. Only for the sources of
// this folder.
#pragma once

#include <string>

#include "libcore/base/file.hpp"
#include "libcore/base/message.hpp"
#include "libcore/shard/section.hpp"
#include "shard.capnp.h"

namespace hapgrid {

inline constexpr std::uint64_t kMagic = 0x6861706772696431;  // "hapgrid1"
inline constexpr std::uint32_t kFormatVersion = 1;

/// A place in a file, for messages.
inline std::string at(const InputFile& file, std::uint64_t offset) {
  return format("{}: byte {}", file.name(), offset);
}

void encode_header(const SectionHeader& header, schema::Header::Builder out);
void encode_footer(const Section& section, schema::Footer::Builder out);

/// @throw FormatError (without the file's name) when the header cannot be a grid's.
SectionHeader decode_header(schema::Header::Reader in);
void decode_footer(schema::Footer::Reader in, Section& section);

}  // namespace hapgrid
