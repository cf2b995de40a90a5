#include "libcore/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

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
  struct stat status;
  if (::fstat(fd, &status) != 0) fail(name);
  return status;
}

/// Reads what there is, at least one byte; 0 at the end.
std::size_t read_some(int fd, std::span<std::byte> bytes, const std::string& name) {
  for (;;) {
    const ssize_t count = ::read(fd, bytes.data(), bytes.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) fail(name);
  }
}

/// What a file, pipe or device has from where it stands, at most `limit` bytes.
std::string rest_of(int fd, const std::string& name, std::uint64_t limit) {
  const struct stat status = status_of(fd, name);
  const off_t at = ::lseek(fd, 0, SEEK_CUR);
  if (S_ISREG(status.st_mode) && at >= 0 && status.st_size > at &&
      static_cast<std::uint64_t>(status.st_size - at) > limit)
    throw Error(format("{}: {} bytes, the limit is {}", name, status.st_size - at, limit));
  std::string text;
  std::array<std::byte, 1 << 16> buffer;
  while (const std::size_t count = read_some(fd, buffer, name)) {
    text.append(reinterpret_cast<const char*>(buffer.data()), count);
    if (text.size() > limit)
      throw Error(format("{}: more than {} bytes, which is the limit", name, limit));
  }
  return text;
}

/// Gives `make` names `directory`/.hapgrid.XXXXXX until it returns no EEXIST; sets `name`.
/// @return what it returns, negative when errno says why there is none
template <class Make>
int with_fresh_name(const fs::path& directory, std::string& name, const Make& make) {
  static constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  for (int attempt = 0;; ++attempt) {
    name = (directory / ".hapgrid.").string();
    for (int i = 0; i < 6; ++i) name += kLetters[random() % kLetters.size()];
    const int made = make(name.c_str());
    if (made >= 0 || errno != EEXIST || attempt == 100) return made;
  }
}

/// A fresh file `directory`/.hapgrid.XXXXXX; sets `name`. None when errno says why it
/// cannot be created. @param mode as of open(): the kernel takes the umask away, which another
/// thread could only read by changing it (mkostemp() would need that).
FileDescriptor named_temporary(const fs::path& directory, std::string& name, mode_t mode) {
  return FileDescriptor(with_fresh_name(directory, name, [&](const char* fresh) {
    return ::open(fresh, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  }));
}

std::string own_link(int fd) { return format("/proc/self/fd/{}", fd); }

/// A file in `directory` that has no name yet, and is gone if the program is killed. None where the
/// file system has no such files, or where it could get no name later.
FileDescriptor nameless_file(const fs::path& directory) {
  FileDescriptor file(::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666));
  if (file && ::access(own_link(file.get()).c_str(), F_OK) != 0) return {};
  return file;
}

/// An unlinked file in `directory`, which is gone when it is closed. @throw std::system_error
FileDescriptor unlinked_file(const fs::path& directory) {
  std::string name;
  FileDescriptor file = named_temporary(directory, name, 0600);
  if (!file) fail(format("{}: cannot create a file", directory.string()));
  ::unlink(name.c_str());
  return file;
}

// The names of the output files that are not finished. A signal's handler reads them, which can
// wait for no lock. No tool has more of them at a time; a file beyond these only stays after a
// signal.
constexpr std::size_t kMaxUnfinished = 16;
std::array<std::atomic<const std::string*>, kMaxUnfinished> unfinished_files;
static_assert(std::atomic<const std::string*>::is_always_lock_free);

/// Puts `now` into the first place that has `before`; null is a free place.
void change_unfinished(const std::string* before, const std::string* now) {
  for (auto& place : unfinished_files) {
    const std::string* expected = before;
    if (place.compare_exchange_strong(expected, now)) return;
  }
}

/// Copies a stream until it ends, or only its first bytes when these are no zstd frame.
/// Answers how much that is.
std::uint64_t copy_stream(int from, int to, const std::string& name) {
  constexpr std::size_t kFirst = kZstdMagic.size();
  const std::string copy = format("{}, copied to {}", name, temporary_directory().string());
  std::array<std::byte, 1 << 16> buffer;
  std::uint64_t size = 0;
  std::size_t count = 0;
  while (count < kFirst)  // a pipe may give one byte at a time
    if (const std::size_t more =
            read_some(from, std::span(buffer).subspan(count, kFirst - count), name))
      count += more;
    else
      break;
  // A terminal that has said its end is not asked again: it would wait for more.
  const bool goes_on = std::equal(kZstdMagic.begin(), kZstdMagic.end(), buffer.begin(),
                                  buffer.begin() + static_cast<std::ptrdiff_t>(count));
  do {
    write_all(to, std::span(buffer).first(count), copy);
    size += count;
  } while (goes_on && (count = read_some(from, buffer, name)) > 0);
  return size;
}

/// The absolute name of the file that `name` leads to through symbolic links, also where the last
/// of them leads nowhere yet, which weakly_canonical() would not follow.
std::string followed(const std::string& name) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::error_code error;
  fs::path path = fs::absolute(name, error);
  for (int i = 0; i < kMaxLinks && fs::is_symlink(path, error); ++i)
    path = path.parent_path() / fs::read_symlink(path, error);
  path = fs::weakly_canonical(path, error);
  return error ? name : path.string();
}

bool is_special(const std::string& name) {
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  return fs::exists(status) && !fs::is_regular_file(status);
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

void remove_unfinished_files() noexcept {
  for (const auto& place : unfinished_files)
    if (const std::string* const name = place.load()) ::unlink(name->c_str());
}

OutputFile::OutputFile(const std::string& name, bool binary)
    : OutputFile(name == "-"        ? to_standard_output(binary)
                 : is_special(name) ? direct(name)
                                    : temporary_of(followed(name), name)) {}

OutputFile::OutputFile(std::string shown_name, FileDescriptor file)
    : shown_name_(std::move(shown_name)), owned_(std::move(file)), fd_(owned_.get()) {}

OutputFile OutputFile::to_standard_output(bool binary) {
  OutputFile out("standard output", FileDescriptor());
  out.fd_ = STDOUT_FILENO;
  if (binary && ::isatty(out.fd_))
    throw Error("standard output is a terminal: redirect it, or name a file with -o");
  return out;
}

OutputFile OutputFile::direct(const std::string& name) {
  FileDescriptor file(::open(name.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file) fail(name);
  return {name, std::move(file)};
}

OutputFile OutputFile::replacing(const std::string& name) {
  return temporary_of(fs::absolute(name).string(), name);
}

OutputFile OutputFile::temporary_of(const std::string& target, const std::string& shown_name) {
  const fs::path folder = fs::path(target).parent_path();
  OutputFile out(shown_name, nameless_file(folder));
  if (!out.owned_) {
    std::string temporary;
    out.owned_ = named_temporary(folder, temporary, 0666);
    if (!out.owned_) fail(shown_name);
    out.fd_ = out.owned_.get();
    out.set_temporary(std::move(temporary));
  }
  out.target_ = target;
  return out;
}

void OutputFile::set_temporary(std::string name) {
  temporary_ = std::make_unique<const std::string>(std::move(name));
  change_unfinished(nullptr, temporary_.get());
}

void OutputFile::give_name() {
  const std::string link = own_link(fd_);
  std::string name;
  if (with_fresh_name(fs::path(target_).parent_path(), name, [&](const char* fresh) {
        return ::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, fresh, AT_SYMLINK_FOLLOW);
      }) != 0)
    fail(shown_name_);
  set_temporary(std::move(name));
}

OutputFile::~OutputFile() {
  if (!temporary_) return;
  ::unlink(temporary_->c_str());
  change_unfinished(temporary_.get(), nullptr);
}

void OutputFile::write(std::span<const std::byte> bytes) { write_all(fd_, bytes, shown_name_); }

void OutputFile::commit() {
  if (target_.empty()) {
    if (owned_ && ::close(owned_.release()) != 0) fail(shown_name_);
    return;
  }
  if (::fsync(owned_.get()) != 0) fail(shown_name_);
  if (!temporary_) give_name();
  if (::rename(temporary_->c_str(), target_.c_str()) != 0) fail(shown_name_);
  // The name must be on the disk before a file that this one makes needless is removed. The file
  // is there, whatever a file system says that cannot do this.
  const FileDescriptor folder(
      ::open(fs::path(target_).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder) ::fsync(folder.get());
  change_unfinished(temporary_.get(), nullptr);
  temporary_.reset();
  target_.clear();
  owned_ = FileDescriptor();
  fd_ = -1;
}

void write_text(const std::string& name, const std::string& text) {
  OutputFile output(name, /*binary=*/false);
  output.write(text);
  output.commit();
}

InputFile::InputFile(const std::string& name) : shown_name_(name) {
  if (shown_name_ == "-") {
    fd_ = STDIN_FILENO;
    shown_name_ = "standard input";
  } else {
    owned_ = FileDescriptor(::open(shown_name_.c_str(), O_RDONLY | O_CLOEXEC));
    if (!owned_) fail(shown_name_);
    fd_ = owned_.get();
  }
  const struct stat status = status_of(fd_, shown_name_);
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
  size_ = copy_stream(fd_, spool.get(), shown_name_);
  owned_ = std::move(spool);
  fd_ = owned_.get();
}

InputFile::InputFile(FileDescriptor file, std::string name)
    : shown_name_(std::move(name)), owned_(std::move(file)), fd_(owned_.get()) {
  size_ = static_cast<std::uint64_t>(status_of(fd_, shown_name_).st_size);
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
    throw Error(format("{}: is no regular file", name));
  return rest_of(file.get(), name, limit);
}

fs::path own_folder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

}  // namespace hapgrid
