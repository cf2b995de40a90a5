// Shards: all that is read of one. The mutator changes the messages in it and keeps what stands
// around them right (mutate.hpp).
#include <limits>

#include "libcore/check/invariants.hpp"
#include "libcore/follow/branch_nodes.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/schema.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

/// The rows of a section, chunk by chunk, as expand and merge read them.
void read_rows(const Section& section) {
  SectionReader reader(section);
  Chunk rows;
  for (std::size_t i = 0; i < section.chunks.size(); ++i) refusable([&] { reader.read(i, rows); });
}

/// The grid as play takes it, whatever its links are: along a diagonal of its box and back, a jump,
/// and no number.
void play(const Grid& grid) {
  const Box& box = grid.spec().box;
  PaperTraversal traversal(grid);
  const auto place = [&](double share) {
    Vec3 x{};
    for (int a = 0; a < 3; ++a) x[a] = box.origin[a] + share * box.spacing * (box.counts[a] - 1);
    return x;
  };
  traversal.start(place(0.5));
  for (int i = 0; i <= 40; ++i) traversal.step(place(0.5 + 0.03 * (i <= 20 ? i : 40 - i)));
  traversal.step(place(0));
  traversal.step(place(std::numeric_limits<double>::quiet_NaN()));
}

/// What verify says of the grid alone, whatever its links are.
void check_grid(const Grid& grid) {
  const tiny::TestModel model(grid.spec(), nullptr);
  const auto distances = find_distances(grid);
  check_links(grid);
  check_finite(grid);
  check_distinct(grid, model);
  check_reachable(grid, distances);
  check_generations(grid, distances);
  check_continuous(grid, BranchNodes(grid));
}

void read_shard(std::span<const std::byte> bytes) {
  bool small = true;  // tables of millions of points take the time and show nothing new
  refusable([&] {
    MemoryFile memory(bytes);
    for (const Section& section : open_sections({memory.name()})) {
      small = small && section.header.spec.box.points() <= 1 << 16;
      read_rows(section);
    }
  });
  if (!small) return;
  refusable([&] {
    MemoryFile memory(bytes);
    const Grid grid = load_grid(memory.name());
    check_grid(grid);
    play(grid);
  });
}

/// The footer's header_size, its chunks' sizes and digests, and its own digest.
void fit_footer(Words& words, std::span<const Framed> before) {
  if (before.empty()) return;
  Section section;
  read_message<schema::Message>(words, [&](schema::Message::Reader in) {
    if (!in.isFooter()) throw FormatError("no footer");
    decode_footer(in.getFooter(), section);
  });
  section.header_size = static_cast<std::uint32_t>(before[0].size);
  section.chunks.resize(before.size() - 1);
  for (std::size_t i = 1; i < before.size(); ++i) {
    ChunkInfo& chunk = section.chunks[i - 1];
    chunk.size = static_cast<std::uint32_t>(before[i].size);
    chunk.digest = before[i].digest;
  }
  section.digest = section_digest(before[0].digest, section.chunks);
  capnp::MallocMessageBuilder builder;
  encode_footer(section, builder.initRoot<schema::Message>().initFooter());
  const auto flat = capnp::messageToFlatArray(builder);
  words.resize(flat.size());
  std::memcpy(words.data(), flat.begin(), flat.size() * sizeof(std::uint64_t));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_shard(std::as_bytes(std::span(data, size)));
  return 0;
}

HAPGRID_FUZZ_MESSAGES(fit_footer)
