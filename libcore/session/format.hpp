// Turns headers and ticks into Cap'n Proto messages and back. Only for the sources of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid {

inline constexpr std::size_t kChunkTicks = 4096;  ///< A chunk has at most so many ticks.
/// The most bytes of the messages of a header and of a chunk, whoever wrote them.
inline constexpr std::uint64_t kHeaderLimit = 1 << 20;
inline constexpr std::uint64_t kChunkLimit = 128 * kChunkTicks;

MessageWords encode_header(const SessionHeader& header);
/// @param ticks 1 to kChunkTicks, ascending. @param dropped see schemas/session.capnp
MessageWords encode_ticks(std::span<const TickRecord> ticks, std::uint64_t dropped);

/// Whether the message is the header of a session of any version. @throw FormatError
bool is_header(const MessageWords& message);
/// @throw FormatError (without the file's name) for a message of another kind, or with impossible
/// content.
SessionHeader decode_header(const MessageWords& message);
/// Returns `dropped`.
std::uint64_t decode_ticks(const MessageWords& message, std::vector<TickRecord>& ticks);

}  // namespace hapgrid
