// Arrays by name, as numpy.load() opens them: a ZIP archive with an entry NAME.npy an array.
// Source: numpy, "NEP 1: A simple file format for NumPy arrays", version 1.0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"

struct archive;

namespace hapgrid {

/// Writes an archive piece by piece, so that it may be a pipe. Nothing is compressed: a reader can
/// then map the arrays, and the grid as it is stored is small already. No times are stored.
class NpzFile {
 public:
  /// @param output outlives this.
  explicit NpzFile(OutputFile& output);
  ~NpzFile();

  /// Begins the array `name`, which gets `bytes` bytes by write().
  /// @param type as numpy's descr says it, with its quotes: "'<f8'"; little-endian
  /// @param shape C order; empty: a number
  /// @throw std::system_error, Error
  void begin(const std::string& name, const std::string& type,
             const std::vector<std::uint64_t>& shape, std::uint64_t bytes);
  void write(std::span<const std::byte> bytes);
  /// After the last array.
  void end();

  template <class T>
  void add(const std::string& name, const std::string& type,
           const std::vector<std::uint64_t>& shape, const std::vector<T>& values) {
    begin(name, type, shape, values.size() * sizeof(T));
    write(std::as_bytes(std::span(values)));
  }

 private:
  void require(long result) const;

  OutputFile& output_;
  std::exception_ptr failure_;  // of the output; no exception passes through the library
  std::unique_ptr<archive, int (*)(archive*)> archive_;
};

}  // namespace hapgrid
