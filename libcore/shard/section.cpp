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
  for (const ChunkInfo& chunk : section.footer.chunks) sum += of(chunk);
  return sum;
}

/// Reads sections from the end of a file to its beginning.
class BackwardReader {
 public:
  explicit BackwardReader(std::shared_ptr<const InputFile> file) : file_(std::move(file)) {
    if (file_->size() == 0) throw FormatError(format("{}: empty, not a shard", file_->name()));
    if (starts_with_zstd_frame(*file_)) return;
    fail_compressed();
    fail(0, "not a shard: no zstd frame");
  }

  /// The section that ends at `end`.
  Section read(std::uint64_t end) {
    Section section;
    section.file = file_;
    section.end = end;
    const std::uint64_t footer = read_footer(end, section.footer);
    place_chunks(footer, section);
    std::uint64_t at = section.begin;
    decode(at, section.footer.header_size, [&](schema::Message::Reader message) {
      if (!message.isHeader())
        throw FormatError("damaged: no header where a footer's section starts");
      section.header = decode_header(message.getHeader());
    });
    const Digest header = digest_of(std::as_bytes(std::span(words_)));
    if (section_digest(header, section.footer.chunks) != section.footer.digest)
      fail(footer, "damaged: the digest in the footer does not fit the content");
    check_order(footer, section);
    return section;
  }

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& what) const {
    throw FormatError(format("{}: {}", at(*file_, offset), what));
  }

  /// Throws where the file is a shard, or anything else, that was compressed as a whole.
  void fail_compressed() const {
    if (const std::string by = outer_compression(*file_); !by.empty())
      fail(0,
           format("this is {}, not a shard: unpack it first. Shards are compressed already", by));
  }

  /// Answers where the footer starts.
  std::uint64_t read_footer(std::uint64_t end, SectionFooter& footer) {
    Locator locator;
    const auto bytes = std::as_writable_bytes(std::span(&locator, 1));
    if (end < bytes.size() || file_->read(end - bytes.size(), bytes) != bytes.size() ||
        !locator.is_valid()) {
      if (end == file_->size()) fail_compressed();
      fail(end, "truncated: a shard ends with an index");
    }
    const std::uint64_t footer_end = end - bytes.size();
    if (locator.footer > footer_end) fail(footer_end, "damaged: the footer is not in the file");
    const std::uint64_t offset = footer_end - locator.footer;
    decode(offset, locator.footer, [&](schema::Message::Reader message) {
      if (!message.isFooter()) throw FormatError("damaged: no footer where there must be one");
      footer = decode_footer(message.getFooter());
    });
    return offset;
  }

  /// The zstd frames stand one after the other, the header's first, and end where the footer
  /// starts.
  void place_chunks(std::uint64_t footer, Section& section) const {
    std::uint64_t size = section.footer.header_size;
    for (const ChunkInfo& chunk : section.footer.chunks) size += chunk.size;
    if (size > footer)
      fail(footer, "truncated: the footer's section is larger than what stands before it");
    section.begin = footer - size;
    std::uint64_t offset = section.begin + section.footer.header_size;
    for (ChunkInfo& chunk : section.footer.chunks) {
      chunk.offset = offset;
      offset += chunk.size;
    }
  }

  void check_order(std::uint64_t footer, const Section& section) const {
    const ChunkInfo* before = nullptr;
    for (const ChunkInfo& chunk : section.footer.chunks) {
      if (chunk.last_point < chunk.first_point ||
          (before && chunk.first_point < before->last_point) || chunk.frontier > chunk.rows)
        fail(footer, "damaged: chunks out of order");
      before = &chunk;
    }
  }

  /// Decodes the zstd frame at `offset` and hands its message to use(); stored_ and words_ hold it.
  template <class F>
  void decode(std::uint64_t offset, std::uint64_t size, F&& use) {
    stored_.resize(size);
    stored_.resize(file_->read(offset, stored_));
    try {
      decoder_.decode(stored_, std::max(kMaxHeaderBytes, kMaxFooterRatio * size), words_);
      read_message<schema::Message>(words_, use);
    } catch (const FormatError& e) {
      fail(offset, e.what());
    }
  }

  std::shared_ptr<const InputFile> file_;
  ZstdFrameDecoder decoder_{"shard"};
  std::vector<std::byte> stored_;
  MessageWords words_;
};

}  // namespace

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
    const auto file = std::make_shared<const InputFile>(name);
    BackwardReader reader(file);
    std::vector<Section> found;
    for (std::uint64_t end = file->size(); end > 0; end = found.back().begin)
      found.push_back(reader.read(end));
    sections.insert(sections.end(), std::make_move_iterator(found.rbegin()),
                    std::make_move_iterator(found.rend()));
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
  const std::vector<Section> sections = open_sections({name});
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
