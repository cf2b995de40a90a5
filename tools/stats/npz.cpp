#include "tools/stats/npz.hpp"

#include <archive.h>
#include <archive_entry.h>

#include <bit>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little);

NpzFile::NpzFile(OutputFile& output)
    : output_(output), archive_(archive_write_new(), archive_write_free) {
  const auto write = [](archive*, void* self, const void* bytes, std::size_t size) -> la_ssize_t {
    auto& file = *static_cast<NpzFile*>(self);
    try {
      file.output_.write(std::span(static_cast<const std::byte*>(bytes), size));
      return static_cast<la_ssize_t>(size);
    } catch (...) {
      file.failure_ = std::current_exception();
      return -1;
    }
  };
  require(archive_write_set_format_zip(archive_.get()));
  require(archive_write_set_format_option(archive_.get(), "zip", "compression", "store"));
  require(archive_write_set_bytes_per_block(archive_.get(), 1 << 20));
  require(archive_write_set_bytes_in_last_block(archive_.get(), 1));
  require(archive_write_open(archive_.get(), this, nullptr, write, nullptr));
}

NpzFile::~NpzFile() {
  // What was not ended is not wanted: the archive is not finished behind an error's back.
  archive_write_fail(archive_.get());
}

void NpzFile::require(long result) const {
  if (failure_) std::rethrow_exception(failure_);
  if (result < ARCHIVE_OK)
    throw Error(format("{}: {}", output_.name(), archive_error_string(archive_.get())));
}

void NpzFile::begin(const std::string& name, const std::string& type,
                    const std::vector<std::uint64_t>& shape, std::uint64_t bytes) {
  std::string header = format("{{'descr': {}, 'fortran_order': False, 'shape': (", type);
  for (const std::uint64_t size : shape) header += format("{}, ", size);
  header += "), }";
  constexpr std::size_t kMagic = 10, kAligned = 64;
  header.resize((kMagic + header.size() + 1 + kAligned - 1) / kAligned * kAligned - kMagic - 1,
                ' ');
  header += '\n';
  std::string magic("\x93NUMPY\x01\x00", 8);
  magic += static_cast<char>(header.size() & 0xff);
  magic += static_cast<char>(header.size() >> 8);
  header = magic + header;

  const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                       archive_entry_free);
  archive_entry_set_pathname(entry.get(), (name + ".npy").c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(header.size() + bytes));
  require(archive_write_header(archive_.get(), entry.get()));
  write(std::as_bytes(std::span(header)));
}

void NpzFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const la_ssize_t written = archive_write_data(archive_.get(), bytes.data(), bytes.size());
    require(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void NpzFile::end() { require(archive_write_close(archive_.get())); }

}  // namespace hapgrid
