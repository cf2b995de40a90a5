// Shards as messages: header, chunks, footer. The frames' digests are put into the footer, all else
// that it says is the input's.
#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/schema.hpp"
#include "libcore/shard/section_digest.hpp"
#include "tests/fuzz/messages.hpp"
#include "tests/fuzz/read_shard.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

/// The footer with the digests of what stands before it.
Words with_digests(const Words& message, const std::vector<ChunkInfo>& chunks,
                   const Digest& section) {
  SectionFooter footer = read_message(message, "footer", [](schema::Message::Reader in) {
    if (!in.isFooter()) throw FormatError("no footer");
    return decode_footer(in.getFooter());
  });
  for (std::size_t i = 0; i < std::min(chunks.size(), footer.chunks.size()); ++i) {
    footer.chunks[i].digest = chunks[i].digest;
    footer.chunks[i].stored = chunks[i].stored;
  }
  footer.digest = section;
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
  std::vector<ChunkInfo> chunks;
  SectionDigester digester(bytes_of(messages.front()));
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool last = i > 0 && i + 1 == messages.size();
    if (last)
      refusable([&] { messages[i] = with_digests(messages[i], chunks, digester.digest()); });
    const std::span<const std::byte> frame = encoder.encode(bytes_of(messages[i]));
    append(shard, frame);
    if (i == 0 || last) continue;
    ChunkInfo info;
    info.digest = digest_of(bytes_of(messages[i]));
    info.stored = hash_of(frame);
    digester.add(info.digest);
    chunks.push_back(info);
  }
  read_shard(shard);
  return 0;
}
