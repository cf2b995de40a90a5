// Sessions as messages: header, ticks, footer. The places and the digests of the zstd frames are
// put into the footer, all else that it says is the input's.
#include "libcore/base/locator.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "tests/fuzz/messages.hpp"
#include "tests/fuzz/read_session.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<Words> messages = split({data, size});
  if (messages.empty()) return 0;
  static ZstdFrameEncoder encoder;
  std::vector<std::byte> session;
  std::vector<ChunkEntry> chunks;
  std::vector<Digest> digests;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool last = i > 0 && i + 1 == messages.size();
    if (last)
      refusable([&] {
        SessionFooter footer = decode_footer(messages[i], messages.size());
        for (std::size_t c = 0; c < std::min(chunks.size(), footer.chunks.size()); ++c) {
          footer.chunks[c].offset = chunks[c].offset;
          footer.chunks[c].size = chunks[c].size;
          footer.chunks[c].digest = chunks[c].digest;
        }
        footer.digest = digest_of(std::as_bytes(std::span(digests)));
        messages[i] = encode_footer(footer);
      });
    digests.push_back(digest_of(bytes_of(messages[i])));
    const std::span<const std::byte> frame = encoder.encode(bytes_of(messages[i]));
    if (i > 0) {
      ChunkEntry chunk;
      chunk.offset = session.size();
      chunk.size = frame.size();
      chunk.digest = digests.back();
      chunks.push_back(chunk);
    }
    append(session, frame);
    if (last) append(session, encode_locator({frame.size(), hash_of(frame)}));
  }
  read_session(session);
  return 0;
}
