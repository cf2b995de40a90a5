// Shards as messages: header, chunks, footer. Sizes and digests of the zstd frames are put into the
// footer, and the locator behind it; all else is the input's.
#include "libcore/base/locator.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/schema.hpp"
#include "tests/fuzz/messages.hpp"
#include "tests/fuzz/read_shard.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

/// The footer with what `fitting` says of the zstd frames before it.
Words with_sizes_and_digests(const Words& message, const SectionFooter& fitting,
                             const Digest& header) {
  SectionFooter footer = read_message(message, "footer", [](schema::Message::Reader in) {
    if (!in.isFooter()) throw FormatError("no footer");
    return decode_footer(in.getFooter());
  });
  footer.header_size = fitting.header_size;
  for (std::size_t i = 0; i < std::min(fitting.chunks.size(), footer.chunks.size()); ++i) {
    footer.chunks[i].size = fitting.chunks[i].size;
    footer.chunks[i].digest = fitting.chunks[i].digest;
    footer.chunks[i].stored = fitting.chunks[i].stored;
  }
  footer.digest = section_digest(header, footer.chunks);
  capnp::MallocMessageBuilder builder;
  encode_footer(footer, builder.initRoot<schema::Message>().initFooter());
  const auto flat = capnp::messageToFlatArray(builder);
  Words words(flat.size());
  std::memcpy(words.data(), flat.begin(), flat.size() * sizeof(std::uint64_t));
  return words;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<Words> messages = split({data, size});
  if (messages.empty()) return 0;
  static ZstdFrameEncoder encoder;
  std::vector<std::byte> shard;
  SectionFooter footer;
  const Digest header = digest_of(bytes_of(messages.front()));
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool last = i > 0 && i + 1 == messages.size();
    if (last) refusable([&] { messages[i] = with_sizes_and_digests(messages[i], footer, header); });
    const std::span<const std::byte> bytes = encoder.encode(bytes_of(messages[i]));
    append(shard, bytes);
    const auto stored = static_cast<std::uint32_t>(bytes.size());
    if (i == 0) {
      footer.header_size = stored;
    } else if (last) {
      append(shard, encode_locator({stored, hash_of(bytes)}));
    } else {
      ChunkInfo info;
      info.size = stored;
      info.digest = digest_of(bytes_of(messages[i]));
      info.stored = hash_of(bytes);
      footer.chunks.push_back(info);
    }
  }
  read_shard(shard);
  return 0;
}
