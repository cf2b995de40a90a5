// Files that appear whole or not at all, and inputs that can be read anywhere.
#include "libcore/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <sstream>

#include "libcore/base/parallel.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
namespace fs = std::filesystem;

namespace {

std::string content(const std::string& name) {
  std::ostringstream out;
  out << std::ifstream(name, std::ios::binary).rdbuf();
  return out.str();
}

void put(const std::string& name, const std::string& text) {
  std::ofstream(name, std::ios::binary) << text;
}

std::size_t entries(const fs::path& directory) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

std::string read(const InputFile& file, std::uint64_t offset, std::size_t size) {
  std::string text(size, '?');
  text.resize(file.read(offset, std::as_writable_bytes(std::span(text))));
  return text;
}

}  // namespace

TEST_CASE("what a signal's handler removes: the files that are not finished, and no others") {
  const TemporaryDirectory dir;
  OutputFile finished(dir.file("finished"));
  OutputFile moved(dir.file("moved"));
  const OutputFile unfinished(std::move(moved));
  { const OutputFile over(dir.file("over")); }
  finished.commit();
  // Most file systems have files without a name, which need no handler.
  REQUIRE(entries(dir.path()) <= 2);
  remove_unfinished_files();
  REQUIRE(entries(dir.path()) == 1);
  REQUIRE(fs::exists(dir.file("finished")));
}

TEST_CASE("two that write the same file: the last commit() wins, whole") {
  const TemporaryDirectory dir;
  OutputFile a(dir.file("out"));
  OutputFile b(dir.file("out"));
  a.write("a");
  b.write("b");
  b.commit();
  REQUIRE(content(dir.file("out")) == "b");
  a.commit();
  REQUIRE(content(dir.file("out")) == "a");
  REQUIRE(entries(dir.path()) == 1);
}

TEST_CASE("symbolic links are followed, also one to nowhere and a chain") {
  const TemporaryDirectory dir;
  fs::create_directory(dir.path() / "d");
  fs::create_symlink("d/real", dir.path() / "link");
  fs::create_symlink("link", dir.path() / "chain");
  for (const char* text : {"first", "second"}) {
    OutputFile out(dir.file("chain"));
    out.write(text);
    out.commit();
    REQUIRE(content((dir.path() / "d" / "real").string()) == text);
  }
  REQUIRE(fs::is_symlink(dir.path() / "link"));
  {
    OutputFile out = OutputFile::replacing(dir.file("link"));
    out.write("third");
    out.commit();
  }
  REQUIRE(!fs::is_symlink(dir.path() / "link"));
  REQUIRE(content(dir.file("link")) == "third");
  REQUIRE(content((dir.path() / "d" / "real").string()) == "second");
  REQUIRE(fs::is_symlink(dir.path() / "chain"));
  fs::create_symlink("loop", dir.path() / "loop");
  REQUIRE_THROWS_AS(InputFile(dir.file("loop")), std::system_error);
}

TEST_CASE("an input can be read at any offset, from a file and from a pipe") {
  const TemporaryDirectory dir;
  std::string text = "\x28\xB5\x2F\xFD";  // as a zstd frame begins
  for (int i = 0; i < 50000; ++i) text += std::to_string(i) + ' ';
  put(dir.file("in"), text);
  const auto check = [&](const InputFile& file) {
    REQUIRE(file.size() == text.size());
    for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{70000}, std::uint64_t{3},
                                       file.size() - 5, file.size(), file.size() + 9}) {
      REQUIRE(read(file, offset, 1000) == (offset < text.size() ? text.substr(offset, 1000) : ""));
    }
    REQUIRE(read(file, 0, 2 * text.size()) == text);
  };
  check(InputFile(dir.file("in")));
  check(InputFile(FileDescriptor(::open(dir.file("in").c_str(), O_RDONLY)), "given"));

  const std::string pipe = dir.file("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  {
    std::jthread writer([&] { put(pipe, text); });
    check(InputFile(pipe));
  }
  {
    std::jthread writer([&] { put(pipe, "no zstd frame"); });
    REQUIRE(InputFile(pipe).size() == 4);  // only what shows that it is none
  }
  // Standard input that a shell has read from before: from where it stands.
  const int saved = ::dup(STDIN_FILENO);
  const int file = ::open(dir.file("in").c_str(), O_RDONLY);
  ::lseek(file, 10, SEEK_SET);
  ::dup2(file, STDIN_FILENO);
  {
    const InputFile input("-");
    REQUIRE(input.name() == "standard input");
    REQUIRE(input.size() == text.size() - 10);
    REQUIRE(read(input, 5, 20) == text.substr(15, 20));
  }
  ::dup2(saved, STDIN_FILENO);
  ::close(saved);
  ::close(file);
}

TEST_CASE("there are as many threads as the control groups allow") {
  const auto threads = [](const std::string& groups, const std::string& file,
                          const std::string& text, const std::string& period = "") {
    const TemporaryDirectory root;
    const std::string control = root.file("sys/fs/cgroup/") + file;
    fs::create_directories(root.file("proc/self"));
    fs::create_directories(fs::path(control).parent_path());
    put(root.file("proc/self/cgroup"), groups);
    put(control, text);
    if (!period.empty())
      put((fs::path(control).parent_path() / "cpu.cfs_period_us").string(), period);
    return all_threads(root.file(""));
  };
  const int all = all_threads("/nowhere/");
  CHECK(all >= 1);
  CHECK(threads("0::/a/b\n", "a/b/cpu.max", "max 100000\n") == all);
  CHECK(threads("0::/a/b\n", "a/b/cpu.max", "20000 100000\n") == 1);
  CHECK(threads("0::/a/b\n", "a/cpu.max", "150000 100000\n") == std::min(all, 2));
  CHECK(threads("0::/\n", "cpu.max", "50000 100000\n") == 1);
  const std::string before = "5:memory:/x\n4:cpu,cpuacct:/docker/x\n0::/\n";
  CHECK(threads(before, "cpu,cpuacct/cpu.cfs_quota_us", "100000\n", "100000\n") == 1);
  CHECK(threads(before, "cpu,cpuacct/docker/x/cpu.cfs_quota_us", "60000\n", "50000\n") ==
        std::min(all, 2));
  CHECK(threads(before, "cpu,cpuacct/cpu.cfs_quota_us", "-1\n", "100000\n") == all);
  CHECK(threads(before, "memory/x/cpu.cfs_quota_us", "10000\n", "100000\n") == all);
}
