// Random searches of the toy model, and the filters on files of shards, for the tests of this
// folder.
#pragma once

#include <fcntl.h>

#include "libcore/model/plugin_model.hpp"
#include "libcore/search/complete.hpp"
#include "libcore/search/expand.hpp"
#include "libcore/search/merge.hpp"
#include "libcore/search/seed.hpp"
#include "libcore/shard/reader.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/search/reference.hpp"

namespace hapgrid {

inline const Plugin& toy_plugin() {
  static const Plugin plugin("toy", {std::string(HAPGRID_BUILD_DIR) + "/tests/plugins"});
  return plugin;
}

using Random = std::mt19937_64;

inline int draw(Random& random, int least, int most) {
  return std::uniform_int_distribution<int>(least, most)(random);
}

/// A random model, box and seeds, twice: for libcore and for the reference.
struct Case {
  Definition definition;
  toy::Toy toy;
  reference::Grid grid;
  std::vector<std::pair<std::array<int, 3>, std::vector<std::vector<double>>>> seeds;

  /// Of more points a side: the seeds stay where they are.
  void resize(const std::array<int, 3>& counts) {
    for (std::size_t a = 0; a < 3; ++a) {
      grid.counts[a] = counts[a];
      definition.box.counts[a] = static_cast<std::uint32_t>(counts[a]);
    }
  }

  /// The seeds must be of its state size.
  void set_model(const toy::Toy& model) {
    toy = model;
    definition.parameters = {{"amplitude", toy.amplitude},
                             {"memory", toy.memory},
                             {"salt", static_cast<double>(toy.salt)},
                             {"state_size", static_cast<double>(toy.state_size)},
                             {"tolerance", toy.tolerance}};
  }

  explicit Case(Random& random) {
    toy::Toy model;
    model.state_size = draw(random, 0, 3) ? 2 : static_cast<std::uint32_t>(draw(random, 1, 5));
    model.salt = static_cast<std::uint64_t>(draw(random, 0, 1 << 30));
    model.amplitude = std::array{0.05, 0.3, 1.0}[static_cast<std::size_t>(draw(random, 0, 2))];
    model.tolerance = std::array{0.2, 0.35, 0.5}[static_cast<std::size_t>(draw(random, 0, 2))];
    set_model(model);
    definition.model = "toy";
    definition.max_levels = 254;
    grid.origin = {-1.5, 0.25, 2};
    grid.spacing = 1.125;
    definition.box.origin = grid.origin;
    definition.box.spacing = grid.spacing;
    std::array<int, 3> counts;
    for (int& count : counts) count = draw(random, 1, 6);
    resize(counts);

    for (int i = draw(random, 1, 4); i > 0; --i) {
      std::array<int, 3> at;
      for (int a = 0; a < 3; ++a) at[a] = draw(random, 0, grid.counts[a] - 1);
      if (std::any_of(seeds.begin(), seeds.end(), [&](const auto& s) { return s.first == at; }))
        continue;
      std::vector<std::vector<double>> states;
      for (int l = draw(random, 1, 2); l > 0; --l) {
        std::vector<double> s(toy.state_size);
        for (double& c : s) c = std::uniform_real_distribution<double>(0, 1)(random);
        const bool known = std::any_of(states.begin(), states.end(), [&](const auto& other) {
          return toy::equal(toy, s.data(), other.data());
        });
        if (!known) states.push_back(s);
      }
      seeds.emplace_back(at, states);
      SeedDefinition seed;
      for (int a = 0; a < 3; ++a) seed.position[a] = grid.origin[a] + grid.spacing * at[a];
      seed.states = states;
      definition.seeds.push_back(seed);
    }
  }

  reference::Search search() const {
    reference::Search search(grid, toy);
    for (const auto& [at, states] : seeds) search.seed(at, states);
    return search;
  }
};

/// Not an OutputFile: thousands of syncs would take longer than the tests. Neither is a file
/// truncated or renamed over another one: ext4 syncs that too.
inline FileDescriptor open_plain(const std::string& name) {
  std::filesystem::remove(name);
  FileDescriptor file(::open(name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  REQUIRE(file);
  return file;
}

/// Writes one shard into a file; `write` finishes the writer.
inline void write_shard(const std::string& name, const SectionHeader& header,
                        const std::function<void(SectionWriter&)>& write) {
  const FileDescriptor file = open_plain(name);
  SectionWriter out(file.get(), name, header);
  write(out);
}

inline void write_seed_shard(const Case& c, const std::string& name) {
  const auto model = toy_plugin().create(c.definition.parameters);
  const GridSpec spec = spec_of(c.definition, *model);
  write_shard(name, {Content::kGrid, 0, spec},
              [&](SectionWriter& out) { write_seeds(c.definition, spec, *model, out); });
}

inline void complete_shard(const std::string& from, const std::string& to, unsigned threads,
                           const Plugin& plugin = toy_plugin()) {
  const Section grid = open_grid(from);
  Progress progress;
  Converter converter(plugin, grid.header.spec, threads, progress);
  const FileDescriptor file = open_plain(to);
  complete(grid, converter, progress,
           [&](const SectionHeader& header) { return SectionWriter(file.get(), to, header); });
}

inline void expand_shard(const std::string& from, Part part, const std::string& to,
                         unsigned threads = 1) {
  const Section grid = open_grid(from);
  Progress progress;
  const SectionHeader header{Content::kRequests, grid.header.generation, grid.header.spec};
  Converter converter(toy_plugin(), header.spec, threads, progress);
  FrontierReader frontier(grid, part);
  const std::uint64_t expected = frontier.conversions();
  write_shard(to, header, [&](SectionWriter& out) {
    expand([&](FrontierRecord& record) { return frontier.next(record); }, converter, header.spec,
           [&out](const FrontierRecord& record, const double* rows) {
             out.requests(record.point, record.level, record.todo, rows);
           });
    out.finish();
  });
  REQUIRE(open_sections({to}).front().conversions() == expected);
}

inline void merge_shards(const std::vector<std::string>& from, const std::string& to) {
  std::vector<Section> requests = open_sections(from);
  const Section grid = take_grid(requests);
  const auto model = toy_plugin().create(grid.header.spec.parameters);
  Progress progress;
  OutputFile out(to);
  merge(grid, requests, *model, out.fd(), out.name(), progress);
  out.commit();
}

/// Compares a grid with X, record by record.
inline void require_same(const std::string& shard, const reference::Search& search) {
  const Grid grid = load_grid(shard);
  REQUIRE(grid.generation() == search.generation());
  REQUIRE(grid.records() == search.x().size());
  RecordIndex r = 0;
  for (const auto& [key, record] : search.x()) {
    // One assertion for millions of records: each costs more than the search for one.
    const bool same = grid.point(r) == key.first && grid.level(r) == key.second &&
                      grid.record_generation(r) == record.generation &&
                      std::ranges::equal(grid.state(r), record.s) &&
                      std::ranges::equal(grid.links(r), record.D);
    if (!same) FAIL("the record of point " << key.first << ", level " << int{key.second});
    ++r;
  }
}

}  // namespace hapgrid
