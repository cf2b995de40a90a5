#include "libcore/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/zstd_walk.hpp"

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

fs::path temporary_directory() {
  const char* directory = std::getenv("TMPDIR");
  return directory && *directory ? directory : "/tmp";
}

struct stat status_of(int fd, const std::string& name) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail(name);
  return status;
}

/// What a file, pipe or device has from where it stands, at most `limit` bytes.
std::string rest_of(int fd, const std::string& name, std::uint64_t limit) {
  const struct stat status = status_of(fd, name);
  const off_t at = ::lseek(fd, 0, SEEK_CUR);
  if (S_ISREG(status.st_mode) && at >= 0 && status.st_size > at &&
      static_cast<std::uint64_t>(status.st_size - at) > limit)
    throw Error(name + ": " + std::to_string(status.st_size - at) + " bytes, the limit is " +
                std::to_string(limit));
  std::string text;
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t count = ::read(fd, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(name);
    if (count == 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
    if (text.size() > limit)
      throw Error(name + ": more than " + std::to_string(limit) + " bytes, which is the limit");
  }
}

/// A fresh file `directory`/.`stem`.XXXXXX; sets `name`.
int named_temporary(const fs::path& directory, const std::string& stem, std::string& name) {
  name = (directory / ("." + stem + ".XXXXXX")).string();
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) fail(directory.string() + ": cannot create a file");
  return fd;
}

/// @throw Error when so little of the file system is left that other programs need it.
void require_room(int fd, const std::string& name) {
  constexpr std::uint64_t kReserve = 50;  // one part in so many
  struct statvfs room {};
  if (::fstatvfs(fd, &room) != 0 || room.f_bavail > room.f_blocks / kReserve) return;
  throw Error(name + ": more than " + temporary_directory().string() +
              " has room for; TMPDIR names another folder");
}

/// Copies what comes until it ends or is not what it has to be. Answers how much that is.
std::uint64_t copy_stream(int from, int to, bool may_be_text, const std::string& name) {
  constexpr std::uint64_t kBetweenLooks = 1 << 20;
  std::array<std::byte, 1 << 16> buffer;
  ZstdWalk walk;
  bool is_text = false;
  std::uint64_t size = 0, looked = 0;
  for (;;) {
    const ssize_t count = ::read(from, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(name);
    const auto bytes = std::span(buffer).first(static_cast<std::size_t>(count));
    if (bytes.empty()) return size;
    if (size == 0) is_text = may_be_text && bytes.front() != ZstdWalk::kFirstByte;
    write_all(to, bytes, name + ", copied to " + temporary_directory().string());
    size += bytes.size();
    const bool fits =
        is_text ? std::memchr(bytes.data(), 0, bytes.size()) == nullptr : walk.take(bytes);
    if (!fits) return size;
    if (size - looked < kBetweenLooks) continue;
    require_room(to, name);
    looked = size;
  }
}

}  // namespace

void write_all(int fd, std::span<const std::byte> bytes, const std::string& name) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(name);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) ::close(fd_);
}

FileDescriptor unlinked_file(const fs::path& directory) {
  const int fd = ::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd >= 0) return FileDescriptor(fd);
  std::string name;
  FileDescriptor file(named_temporary(directory, "hapgrid", name));
  ::unlink(name.c_str());
  return file;
}

OutputFile::OutputFile(std::string name, bool binary, Unfinished unfinished, Links links)
    : shown_name_(std::move(name)) {
  if (shown_name_ == "-") {
    fd_ = STDOUT_FILENO;
    shown_name_ = "standard output";
    if (binary && ::isatty(fd_))
      throw Error("standard output is a terminal: redirect it, or name a file with -o");
    return;
  }
  struct stat status {};
  const bool follows = links == Links::kFollowed;
  if (follows && ::stat(shown_name_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    owned_ = FileDescriptor(::open(shown_name_.c_str(), O_WRONLY | O_CLOEXEC));
    if (!owned_) fail(shown_name_);
    fd_ = owned_.get();
    return;
  }
  // A symbolic link is followed, so that the file it names is replaced and not the link; also one
  // that leads nowhere yet, which weakly_canonical() would not follow.
  std::error_code ignored;
  fs::path resolved = fs::absolute(shown_name_, ignored);
  constexpr int kMaxLinks = 40;  // as the kernel
  for (int i = 0; follows && i < kMaxLinks && fs::is_symlink(resolved, ignored); ++i)
    resolved = resolved.parent_path() / fs::read_symlink(resolved, ignored);
  if (follows) resolved = fs::weakly_canonical(resolved, ignored);
  target_ = ignored ? shown_name_ : resolved.string();
  if (unfinished == Unfinished::kStays) {
    const std::string part = target_ + ".part";
    owned_ = FileDescriptor(::open(part.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666));
    if (!owned_ && errno == EEXIST)
      throw Error(part +
                  ": is there already, from a run that is not over or was "
                  "interrupted: move it away");
    if (!owned_) fail(part);
    temporary_ = part;
    stays_ = true;
    fd_ = owned_.get();
    return;
  }
  const fs::path directory = fs::path(target_).parent_path();
  owned_ = FileDescriptor(::open(directory.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
  if (!owned_) {
    if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL) fail(shown_name_);
    owned_ = FileDescriptor(
        named_temporary(directory, fs::path(target_).filename().string(), temporary_));
    const mode_t mask = ::umask(0);
    ::umask(mask);
    if (::fchmod(owned_.get(), 0666 & ~mask) != 0) fail(shown_name_);
  }
  fd_ = owned_.get();
}

OutputFile::~OutputFile() {
  if (!temporary_.empty() && owned_ && !stays_) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) { write_all(fd_, bytes, shown_name_); }

bool OutputFile::link_to(const std::string& name) {
  const std::string self = "/proc/self/fd/" + std::to_string(fd_);
  if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
  if (errno != EEXIST) fail(shown_name_);
  return false;
}

void OutputFile::commit() {
  if (target_.empty()) {
    if (owned_ && ::close(std::exchange(owned_, FileDescriptor()).get()) != 0) fail(shown_name_);
    return;
  }
  if (::fsync(fd_) != 0) fail(shown_name_);
  if (temporary_.empty() && !link_to(target_)) {
    // linkat() cannot replace an existing file: the new one gets a name of its own first.
    const fs::path target(target_);
    const std::string name = (target.parent_path() /
                              ("." + target.filename().string() + "." + std::to_string(::getpid())))
                                 .string();
    ::unlink(name.c_str());
    if (!link_to(name)) fail(shown_name_);
    temporary_ = name;
  }
  if (!temporary_.empty() && ::rename(temporary_.c_str(), target_.c_str()) != 0) fail(shown_name_);
  temporary_.clear();
  owned_ = FileDescriptor();
  fd_ = -1;
}

InputFile::InputFile(std::string name, Content content) : shown_name_(std::move(name)) {
  if (shown_name_ == "-") {
    fd_ = STDIN_FILENO;
    shown_name_ = "standard input";
  } else {
    owned_ = FileDescriptor(::open(shown_name_.c_str(), O_RDONLY | O_CLOEXEC));
    if (!owned_) fail(shown_name_);
    fd_ = owned_.get();
  }
  struct stat status {};
  if (::fstat(fd_, &status) != 0) fail(shown_name_);
  if (S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    fail(shown_name_);
  }
  if (S_ISREG(status.st_mode)) {
    const off_t position = ::lseek(fd_, 0, SEEK_CUR);
    start_ = position > 0 ? static_cast<std::uint64_t>(position) : 0;
    const auto end = static_cast<std::uint64_t>(status.st_size);
    size_ = end > start_ ? end - start_ : 0;
    return;
  }
  FileDescriptor spool = unlinked_file(temporary_directory());
  size_ = copy_stream(fd_, spool.get(), content == Content::kFramesOrText, shown_name_);
  owned_ = std::move(spool);
  fd_ = owned_.get();
}

InputFile::InputFile(FileDescriptor file, std::string name)
    : shown_name_(std::move(name)), owned_(std::move(file)), fd_(owned_.get()) {
  struct stat status {};
  if (::fstat(fd_, &status) != 0) fail(shown_name_);
  size_ = static_cast<std::uint64_t>(status.st_size);
}

std::size_t InputFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(fd_, bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(start_ + offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(shown_name_);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

std::string read_text(const std::string& name, std::uint64_t limit) {
  if (name == "-") return rest_of(STDIN_FILENO, "standard input", limit);
  const FileDescriptor file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) fail(name);
  return rest_of(file.get(), name, limit);
}

std::string read_regular_text(const std::string& name, std::uint64_t limit) {
  // Without waiting: for the other end of a pipe, or for a modem.
  const FileDescriptor file(::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file) fail(name);
  if (const mode_t mode = status_of(file.get(), name).st_mode; !S_ISREG(mode) && !S_ISDIR(mode))
    throw Error(name + ": is no regular file");
  return rest_of(file.get(), name, limit);
}

}  // namespace hapgrid
