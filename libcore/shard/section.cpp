#include "libcore/shard/section.hpp"

#include <algorithm>
#include <span>

#include "libcore/base/error.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/schema.hpp"

namespace hapgrid {

namespace {

// A header carries the model's parameters in full, of which files have at most 64 MiB. A footer has
// 48 bytes a chunk, a third of them digests, and so is not much larger than its zstd frame.
constexpr std::uint64_t kMaxHeaderBytes = 80 << 20;
constexpr std::uint64_t kMaxFooterRatio = 16;

template <class F>
std::uint64_t sum(const Section& section, F&& of) {
  std::uint64_t sum = 0;
  for (const ChunkInfo& chunk : section.chunks) sum += of(chunk);
  return sum;
}

[[noreturn]] void fail(const InputFile& file, std::uint64_t offset, const std::string& what) {
  throw FormatError(format("{}: {}", at(file, offset), what));
}

/// Throws where the file is a shard, or anything else, that was compressed as a whole.
void fail_compressed(const InputFile& file) {
  if (const std::string by = outer_compression(file); !by.empty())
    fail(file, 0,
         format("this is {}, not a shard: unpack it first. Shards are compressed already", by));
}

/// Throws where a file cannot be a shard.
void require_zstd_frames(const InputFile& file) {
  if (file.size() == 0) throw FormatError(format("{}: empty, not a shard", file.name()));
  if (starts_with_zstd_frame(file)) return;
  fail_compressed(file);
  fail(file, 0, "not a shard: no zstd frame");
}

/// Decodes the zstd frame at `offset`, and hands its message to use(). Answers the message's
/// digest.
template <class F>
Digest decode(const InputFile& file, std::uint64_t offset, std::uint64_t size, F&& use) {
  std::vector<std::byte> stored(size);
  stored.resize(file.read(offset, stored));
  MessageWords words;
  try {
    decode_zstd_frame(stored, std::max(kMaxHeaderBytes, kMaxFooterRatio * size), "shard", words);
    read_message<schema::Message>(words, use);
  } catch (const FormatError& e) {
    fail(file, offset, e.what());
  }
  return digest_of(std::as_bytes(std::span(words)));
}

/// Answers where the footer starts.
std::uint64_t read_footer(Section& section) {
  const InputFile& file = *section.file;
  const std::uint64_t end = section.end;
  Locator locator;
  const auto bytes = std::as_writable_bytes(std::span(&locator, 1));
  if (end < bytes.size() || file.read(end - bytes.size(), bytes) != bytes.size() ||
      !locator.is_valid()) {
    if (end == file.size()) fail_compressed(file);
    fail(file, end, "truncated: a shard ends with an index");
  }
  const std::uint64_t footer_end = end - bytes.size();
  if (locator.footer > footer_end) fail(file, footer_end, "damaged: the footer is not in the file");
  const std::uint64_t offset = footer_end - locator.footer;
  decode(file, offset, locator.footer, [&](schema::Message::Reader message) {
    if (!message.isFooter()) throw FormatError("damaged: no footer where there must be one");
    decode_footer(message.getFooter(), section);
  });
  return offset;
}

/// The zstd frames stand one after the other, the header's first, and end where the footer starts.
void place_chunks(std::uint64_t footer, Section& section) {
  std::uint64_t size = section.header_size;
  for (const ChunkInfo& chunk : section.chunks) size += chunk.size;
  if (size > footer)
    fail(*section.file, footer,
         "truncated: the footer's section is larger than what stands before it");
  section.begin = footer - size;
  std::uint64_t offset = section.begin + section.header_size;
  for (ChunkInfo& chunk : section.chunks) {
    chunk.offset = offset;
    offset += chunk.size;
  }
}

void check_order(std::uint64_t footer, const Section& section) {
  const ChunkInfo* before = nullptr;
  for (const ChunkInfo& chunk : section.chunks) {
    if (chunk.last_point < chunk.first_point ||
        (before && chunk.first_point < before->last_point) || chunk.frontier > chunk.rows)
      fail(*section.file, footer, "damaged: chunks out of order");
    before = &chunk;
  }
}

/// The section that ends at `end`.
Section read_section(const std::shared_ptr<const InputFile>& file, std::uint64_t end) {
  Section section;
  section.file = file;
  section.end = end;
  const std::uint64_t footer = read_footer(section);
  place_chunks(footer, section);
  const Digest header =
      decode(*file, section.begin, section.header_size, [&](schema::Message::Reader message) {
        if (!message.isHeader())
          throw FormatError("damaged: no header where a footer's section starts");
        section.header = decode_header(message.getHeader());
      });
  if (section_digest(header, section.chunks) != section.digest)
    fail(*file, footer, "damaged: the digest in the footer does not fit the content");
  check_order(footer, section);
  return section;
}

/// All of a file, by place.
std::vector<Section> sections_of(const std::shared_ptr<const InputFile>& file) {
  require_zstd_frames(*file);
  std::vector<Section> found;
  for (std::uint64_t end = file->size(); end > 0; end = found.back().begin)
    found.push_back(read_section(file, end));
  std::reverse(found.begin(), found.end());
  return found;
}

}  // namespace

std::string Section::name() const { return format("{:016x}{:016x}", digest.high, digest.low); }
std::uint64_t Section::records() const {
  return sum(*this, [](const ChunkInfo& chunk) { return chunk.rows; });
}
std::uint64_t Section::frontier() const {
  return sum(*this, [](const ChunkInfo& chunk) { return chunk.frontier; });
}
std::uint64_t Section::conversions() const {
  return sum(*this, [](const ChunkInfo& chunk) { return chunk.conversions; });
}

std::vector<Section> open_sections(const std::vector<std::string>& names) {
  std::vector<Section> sections;
  for (const std::string& name : names) {
    std::vector<Section> found = sections_of(std::make_shared<const InputFile>(name));
    sections.insert(sections.end(), std::make_move_iterator(found.begin()),
                    std::make_move_iterator(found.end()));
  }
  for (const Section& section : sections) {
    const Section& first = sections.front();
    if (section.header.spec == first.header.spec) continue;
    throw FormatError(format("{}: another grid than {}: {}", section.file->name(),
                             first.file->name(),
                             difference(section.header.spec, first.header.spec)));
  }
  return sections;
}

Section open_grid(const std::string& name) {
  return open_grid(std::make_shared<const InputFile>(name));
}

Section open_grid(const std::shared_ptr<const InputFile>& file) {
  const std::vector<Section> sections = sections_of(file);
  const Section& grid = sections.back();
  if (grid.header.content != Content::kGrid)
    throw FormatError(format("{}: holds {} where a grid is needed", grid.file->name(),
                             to_string(grid.header.content)));
  if (sections.size() > 1)
    throw FormatError(format("{}: holds {} sections where one grid is needed", grid.file->name(),
                             sections.size()));
  return grid;
}

}  // namespace hapgrid
