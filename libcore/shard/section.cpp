#include "libcore/shard/section.hpp"

#include <algorithm>
#include <span>

#include "libcore/base/error.hpp"
#include "libcore/base/frame.hpp"
#include "libcore/base/text.hpp"
#include "libcore/shard/frame_reader.hpp"
#include "libcore/shard/schema.hpp"
#include "libcore/shard/section_digest.hpp"

namespace hapgrid {

namespace {

// A header carries the model's parameters in full and 8 bytes for each number of a row; a footer
// 48 bytes a chunk, half of them hashes, and so not much more than its frame.
constexpr std::uint64_t kMaxHeaderBytes = 64 << 20;
constexpr std::uint64_t kMaxFooterBytes = 256 << 20;
constexpr std::uint64_t kMaxFooterRatio = 16;

}  // namespace

std::vector<Section> open_sections(const std::shared_ptr<const InputFile>& file) {
  if (file->size() == 0) throw FormatError(file->name() + ": empty, not a shard");
  constexpr std::uint64_t kMaxFrame = kMaxFooterBytes;
  FrameReader frames(*file, 0, file->size());
  FrameDecoder decoder("shard");
  std::vector<std::uint64_t> words;
  std::vector<std::uint64_t> offsets;
  while (!frames.at_end()) {
    offsets.push_back(frames.offset());
    frames.next(kMaxFrame);
  }
  offsets.push_back(file->size());
  const auto message = [&](std::size_t frame, std::uint64_t limit, auto&& use) {
    frames.seek(offsets[frame]);
    const std::string where = at(*file, offsets[frame]);
    try {
      const auto bytes = frames.next(kMaxFrame);
      decoder.decode(
          bytes, std::min(limit, std::max(kMaxHeaderBytes, kMaxFooterRatio * bytes.size())), words);
    } catch (const FormatError& e) {
      throw FormatError(where + ": " + e.what());
    }
    read_message(words, where, use);
  };
  // From the end backwards: a footer says how many chunks stand between it and its header.
  std::vector<Section> found;
  for (std::size_t end = offsets.size() - 1; end > 0;) {
    Section section;
    section.file = file;
    section.end = offsets[end];
    message(end - 1, kMaxFooterBytes, [&](schema::Message::Reader last) {
      if (!last.isFooter()) throw FormatError("truncated: the shard does not end with a footer");
      section.footer = decode_footer(last.getFooter());
    });
    const std::size_t chunks = section.footer.chunks.size();
    if (chunks + 2 > end)
      throw FormatError(file->name() + ": truncated: a footer counts " + std::to_string(chunks) +
                        " chunks, " + std::to_string(end - 1) + " messages stand before it");
    const std::size_t first = end - 2 - chunks;
    section.begin = offsets[first + 1];
    section.stored_bytes = section.end - offsets[first];
    message(first, kMaxHeaderBytes, [&](schema::Message::Reader head) {
      if (!head.isHeader()) throw FormatError("damaged: no header where a footer's section starts");
      section.header = decode_header(head.getHeader());
      SectionDigester digester(std::as_bytes(std::span(words)));
      for (const ChunkInfo& chunk : section.footer.chunks) digester.add(chunk.digest);
      if (digester.digest() != section.footer.digest)
        throw FormatError("damaged: the digest in the footer does not fit the content");
    });
    found.push_back(std::move(section));
    end = first;
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::vector<Section> open_sections(const std::vector<std::string>& names) {
  std::vector<Section> sections;
  for (const std::string& name : names) {
    std::vector<Section> found = open_sections(std::make_shared<const InputFile>(name));
    sections.insert(sections.end(), std::make_move_iterator(found.begin()),
                    std::make_move_iterator(found.end()));
  }
  for (const Section& section : sections) {
    const Section& first = sections.front();
    if (section.header.spec == first.header.spec) continue;
    throw FormatError(section.file->name() + ": another grid than " + first.file->name() + ": " +
                      difference(section.header.spec, first.header.spec));
  }
  return sections;
}

std::uint32_t generation_of(const std::vector<Section>& sections) {
  std::uint32_t youngest = 0;
  for (const Section& section : sections) youngest = std::max(youngest, section.header.generation);
  return youngest;
}

void require_content(const std::vector<Section>& sections, Content content) {
  const std::uint32_t youngest = generation_of(sections);
  const auto reference = std::find_if(sections.begin(), sections.end(), [&](const Section& s) {
    return s.header.generation == youngest;
  });
  for (const Section& section : sections) {
    if (section.header.content != content)
      throw FormatError(section.file->name() + ": holds " + to_string(section.header.content) +
                        " where a shard of " + to_string(content) + " is needed");
    if (section.header.generation == youngest) continue;
    if (content == Content::kGrid && section.footer.frontier == 0) continue;
    throw FormatError(section.file->name() + ": generation " +
                      std::to_string(section.header.generation) + ", but " +
                      reference->file->name() + " has generation " + std::to_string(youngest));
  }
}

void require_same_precision(const std::vector<Section>& sections) {
  const Section& first = sections.front();
  for (const Section& section : sections)
    if (section.header.coding.bounds != first.header.coding.bounds ||
        section.header.coding.precision != first.header.coding.precision)
      throw FormatError(section.file->name() + ": precision " +
                        to_text(section.header.coding.precision) + ", but " + first.file->name() +
                        " has precision " + to_text(first.header.coding.precision) +
                        ", or other bounds");
}

void require_lossless(const std::vector<Section>& sections) {
  for (const Section& section : sections)
    if (section.header.coding.is_lossy())
      throw FormatError(section.file->name() + ": precision " +
                        to_text(section.header.coding.precision) +
                        ": its numbers are not the model's; take the grid that it was made from");
}

}  // namespace hapgrid
