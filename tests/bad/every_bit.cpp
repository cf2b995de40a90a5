// every_bit KIND FILE...: reads each file with every single bit flipped, and cut at every byte.
// KIND says what the files are: shard, session or frames. A shard must be refused, by one line, or
// hold what it held, bit by bit. A session must be refused, or hold the first of the ticks that it
// held; where some are missing in a damaged one, it must say so. A stream of frames carries no
// checksum, so a flipped bit may show; but no frame of a cut one is another.
//
// every_bit.sh makes the files with the tools and calls this. Memory is limited, and a reading that
// takes seconds ends the program by SIGALRM.
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/scene/stream.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/recording.hpp"
#include "libcore/shard/reader.hpp"

using namespace hapgrid;

namespace {

// An honest file of these takes some 20 MB; the sanitizers' own memory cannot be limited so.
constexpr rlim_t kMemory = rlim_t{512} << 20;
constexpr unsigned kSeconds = 20;

/// What was read, as bytes: doubles by their bits, texts and lists with their sizes.
class Content {
 public:
  template <class T>
  void add(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else {
      add(std::size(value));
      for (const auto& entry : value) add(entry);
    }
  }
  template <class... T>
  void add_all(const T&... values) {
    (add(values), ...);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// A file in memory that is damaged and mended again.
class Patient {
 public:
  explicit Patient(const std::string& name) : good_(read_text(name, 1 << 20)) {
    if (!file_ || good_.empty()) throw std::runtime_error(name + ": nothing to damage");
    put(0, good_);
  }
  std::size_t size() const { return good_.size(); }
  void flip(std::size_t bit) {
    put(bit / 8, std::string(1, static_cast<char>(good_[bit / 8] ^ (1 << bit % 8))));
  }
  void cut(std::size_t bytes) {
    if (::ftruncate(file_.get(), static_cast<off_t>(bytes)) != 0) throw std::runtime_error("cut");
  }
  /// After flip() and cut() of that byte.
  void mend(std::size_t byte) { put(byte, good_.substr(byte)); }

  std::string name() const { return "/proc/self/fd/" + std::to_string(file_.get()); }

 private:
  void put(std::size_t at, const std::string& bytes) {
    if (::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(at)) !=
        static_cast<ssize_t>(bytes.size()))
      throw std::runtime_error("no file in memory");
  }

  FileDescriptor file_{::memfd_create("patient", MFD_CLOEXEC)};
  std::string good_;
};

void add(Content& content, const GridSpec& spec) {
  content.add_all(spec.box.origin, spec.box.spacing, spec.box.counts, spec.model, spec.state_size,
                  spec.tolerance, spec.tolerance_unit, spec.equality.norm, spec.equality.weights,
                  spec.equality.periods, spec.max_levels, spec.length_unit, spec.energy_unit,
                  spec.hip_radius, spec.force_scale, spec.stored.force, spec.stored.energy,
                  spec.stored.shape);
  for (const Parameter& parameter : spec.parameters) {
    content.add_all(parameter.key, parameter.value.index());
    std::visit([&](const auto& value) { content.add(value); }, parameter.value);
  }
  for (const Sphere& sphere : spec.spheres)
    content.add_all(sphere.radius, sphere.colour, sphere.label);
}

void add(Content& content, const ChunkInfo& chunk) {
  content.add_all(chunk.size, chunk.rows, chunk.frontier, chunk.conversions, chunk.first_point,
                  chunk.last_point, chunk.digest.low, chunk.digest.high);
}

void add_rows(Content& content, const Section& section) {
  SectionReader reader(section);
  Chunk rows;
  for (std::size_t i = 0; i < section.chunks.size(); ++i) {
    reader.read(i, rows);
    content.add_all(rows.point, rows.level, rows.generation, rows.links, rows.directions,
                    rows.numbers);
  }
}

/// All that a filter can take from a shard: sections, footers, rows.
std::string read_shard(const std::string& name) {
  Content content;
  for (const Section& section : open_sections({name})) {
    content.add_all(section.header.content, section.header.generation, section.begin, section.end,
                    section.digest.low, section.digest.high);
    add(content, section.header.spec);
    for (const ChunkInfo& chunk : section.chunks) add(content, chunk);
    add_rows(content, section);
  }
  return content.bytes();
}

/// As stats, verify and play take a grid.
std::string load(const std::string& name) {
  const Section section = open_grid(name);
  const Grid grid = load_grid(section);
  Content content;
  add(content, grid.spec());
  content.add_all(grid.generation(), section.name(), grid.records());
  for (RecordIndex r = 0; r < grid.records(); ++r)
    content.add_all(grid.point(r), grid.level(r), grid.record_generation(r), grid.row(r),
                    grid.links(r));
  return content.bytes();
}

void add(Content& content, const SessionHeader& header) {
  content.add_all(header.model, header.grid_digest, header.length_unit, header.box.origin,
                  header.box.spacing, header.box.counts, header.rate_hz, header.flags,
                  header.settings);
}

std::string bytes_of(const TickRecord& tick) {
  Content content;
  content.add_all(tick.number, tick.hip, tick.raw_force, tick.force, tick.levels, tick.flags,
                  tick.lateness_ns, tick.compute_ns);
  return content.bytes();
}

struct Session {
  std::string head;
  std::vector<std::string> ticks;
  bool ended_early = false;
};

Session read_session(const std::string& name) {
  SessionReader reader(name);
  Session session;
  Content head;
  add(head, reader.header());
  session.head = head.bytes();
  for (std::vector<TickRecord> ticks; reader.next(ticks);)
    for (const TickRecord& tick : ticks) session.ticks.push_back(bytes_of(tick));
  session.ended_early = !reader.ended_early().empty();
  return session;
}

/// As play --device replay: reads it.
Session read_recording(const std::string& name) {
  SessionReader reader(name);
  const std::vector<DeviceInput> inputs = load_recording(reader);
  Session session;
  session.ended_early = !reader.ended_early().empty();
  Content head;
  add(head, reader.header());
  session.head = head.bytes();
  for (const DeviceInput& tick : inputs) {
    Content content;
    content.add_all(tick.missed, tick.position, tick.clutch, tick.stalled, tick.reset, tick.next,
                    tick.begins);
    session.ticks.push_back(content.bytes());
  }
  return session;
}

/// The scene and the frames, one after the other; they end where the stream does or is refused.
std::vector<std::string> read_frames(const std::string& name) {
  std::vector<std::string> parts;
  try {
    SceneReader reader(name);
    Content scene;
    const Scene& s = reader.scene();
    scene.add_all(s.model, s.length_unit, s.energy_unit, s.box.origin, s.box.spacing, s.box.counts,
                  s.state_size, s.hip_radius, s.spheres.size());
    for (const Sphere& sphere : s.spheres)
      scene.add_all(sphere.radius, sphere.colour, sphere.label);
    for (const Torsion& torsion : s.torsions) scene.add_all(torsion.spheres, torsion.name);
    parts.push_back(scene.bytes());
    for (Frame frame; reader.next(frame);) {
      Content content;
      content.add_all(frame.tick, frame.time_s, frame.hip, frame.position, frame.force, frame.row,
                      frame.energy, frame.own_energy, frame.centres);
      parts.push_back(content.bytes());
    }
  } catch (const FormatError&) {
  }
  return parts;
}

int findings = 0;
void finding(const std::string& what) {
  std::cout << what << std::endl;
  if (++findings >= 20) std::exit(1);
}

using Read = std::function<std::string(const std::string&)>;

/// Reads the patient: what it holds, nothing when it is refused.
std::optional<std::string> diagnose(const Patient& patient, const Read& read,
                                    const std::string& damage) {
  ::alarm(kSeconds);
  try {
    return read(patient.name());
  } catch (const Error& e) {
    // A recording that is no session any more is taken for a text, whose lines have no byte.
    if (std::string(e.what()).find('\n') != std::string::npos)
      finding(damage + ": not one line: " + e.what());
  } catch (const std::exception& e) {
    finding(damage + ": not refused but ended by " + e.what());
  }
  return std::nullopt;
}

struct Counts {
  std::size_t damaged = 0, accepted = 0;
};

/// Calls look(what was done) for every flipped bit and every cut.
template <class F>
void damage_everywhere(Patient& patient, const std::string& name, std::size_t each, F&& look) {
  for (std::size_t bit = 0; bit < 8 * patient.size(); bit += each) {
    patient.flip(bit);
    look(name + ": bit " + std::to_string(bit), false);
    patient.mend(bit / 8);
  }
  for (std::size_t size = 0; size < patient.size(); size += each) {
    patient.cut(size);
    look(name + ": cut to " + std::to_string(size), true);
    patient.mend(size);
  }
}

/// Each damage is refused by `read`, or changes nothing; but a cut between two sections leaves the
/// first one whole.
Counts examine(const std::string& name, std::size_t each, const Read& read) {
  Patient patient(name);
  const std::optional<std::string> right = diagnose(patient, read, name);
  if (!right) finding(name + ": refused as it is");
  Counts counts;
  damage_everywhere(patient, name, each, [&](const std::string& damage, bool is_cut) {
    ++counts.damaged;
    const std::optional<std::string> content = diagnose(patient, read, damage);
    if (!content) return;
    ++counts.accepted;
    if (content != right && !(is_cut && right->starts_with(*content)))
      finding(damage + ": other content");
  });
  if (diagnose(patient, read, name) != right) finding(name + ": not mended");
  return counts;
}

/// Of a damaged session the header and the first ticks are right, and it says that it ended early
/// when there are not all of them. A cut between two zstd frames cannot be seen: there is one for
/// each chunk.
Counts examine_session(const std::string& name, std::size_t each,
                       const std::function<Session(const std::string&)>& read) {
  Patient patient(name);
  const Session right = read(patient.name());
  if (right.ended_early || right.ticks.size() < 3) finding(name + ": cut as it is");
  std::size_t unseen = (right.ticks.size() - 1) / kChunkTicks + 1;
  Counts counts;
  damage_everywhere(patient, name, each, [&](const std::string& damage, bool is_cut) {
    ++counts.damaged;
    Session found;
    const Read reading = [&](const std::string& file) { return found = read(file), file; };
    if (!diagnose(patient, reading, damage)) return;
    ++counts.accepted;
    const bool is_whole = found.ticks.size() == right.ticks.size();
    if (found.head != right.head || found.ticks.size() > right.ticks.size() ||
        !std::equal(found.ticks.begin(), found.ticks.end(), right.ticks.begin()))
      finding(damage + ": other content");
    else if (!is_whole && !found.ended_early && !(is_cut && unseen-- > 0))
      finding(damage + ": ticks are missing, and nothing is said");
  });
  return counts;
}

Counts examine_frames(const std::string& name, std::size_t each) {
  Patient patient(name);
  const std::vector<std::string> right = read_frames(patient.name());
  if (right.size() < 3) finding(name + ": too few frames");
  Counts counts;
  damage_everywhere(patient, name, each, [&](const std::string& damage, bool is_cut) {
    ++counts.damaged;
    std::vector<std::string> found;
    diagnose(
        patient,
        [&](const std::string& file) {
          found = read_frames(file);
          return std::string();
        },
        damage);
    counts.accepted += found == right;
    if (is_cut &&
        !(found.size() < right.size() && std::equal(found.begin(), found.end(), right.begin())))
      finding(damage + ": frames that were not there");
  });
  return counts;
}

bool is_grid(const std::string& name) {
  return open_sections({name}).front().header.content == hapgrid::Content::kGrid;
}

void report(const std::string& name, const char* how, const Counts& counts) {
  std::cout << name << " as " << how << ": damaged " << counts.damaged << " times, "
            << counts.accepted << " times accepted" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "every_bit shard|session|frames EACH FILE...: EACH = 1 for every bit" << std::endl;
    return 2;
  }
  const std::string kind = argv[1];
  const std::size_t each = std::stoul(argv[2]);
  // A build with sanitizers looks at each 7th bit only: it maps more memory than there is.
  if (const rlimit limit{kMemory, kMemory}; each == 1) ::setrlimit(RLIMIT_AS, &limit);
  for (const std::string& name : std::vector<std::string>(argv + 3, argv + argc)) {
    if (kind == "shard") {
      report(name, "rows", examine(name, each, read_shard));
      if (!is_grid(name)) continue;
      report(name, "a grid", examine(name, each, load));
    } else if (kind == "session") {
      report(name, "a session", examine_session(name, each, read_session));
      report(name, "a recording", examine_session(name, each, read_recording));
    } else {
      report(name, "frames", examine_frames(name, each));
    }
  }
  return findings == 0 ? 0 : 1;
}
