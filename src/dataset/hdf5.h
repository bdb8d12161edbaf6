// RAII wrappers and exceptions for HDF5's C API. Independent of the shard format.
#pragma once

#include <hdf5.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/files.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// Global lock that must be held during every use of HDF5: the library has global state and may be built without thread safety. Suppresses
// HDF5's printing of errors for its lifetime.
class Hdf5Session {
 public:
  Hdf5Session();
  ~Hdf5Session();
  Hdf5Session(const Hdf5Session&) = delete;
  Hdf5Session& operator=(const Hdf5Session&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  H5E_auto2_t printer_ = nullptr;
  void* printer_data_ = nullptr;
};

// fork(), while no other thread uses HDF5: the child can use it.
pid_t forkWithHdf5();

// HDF5's error stack as text without line breaks: the failed call and the deepest cause.
std::string hdf5Problem();

// A failure of HDF5, or a file that is not as expected. Callers add the name of the file.
class Hdf5Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Owns one HDF5 identifier.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  // Throws Hdf5Error if `id` is negative.
  Handle(hid_t id, Closer closer);
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): passed to C functions only
  // Closes the identifier. Throws Hdf5Error on failure, which the destructor ignores.
  void close();

 private:
  hid_t id_;
  Closer closer_;
};

// Returns `value` unless it is negative, which is HDF5's error code; throws Hdf5Error then.
template <typename T>
T checked(T value) {
  if (value < 0) throw Hdf5Error(hdf5Problem());
  return value;
}

// Type of a column's values in file and memory: little-endian, or text of a fixed length.
Handle typeOf(const Column& column);

// Attributes of a file or data set. Throw Hdf5Error. Texts have a fixed length: libhdf5 1.10.8 reads past its buffer where the length of a
// variable-length text is damaged.
void writeAttribute(hid_t object, const char* name, const std::string& value);
void writeAttribute(hid_t object, const char* name, std::span<const std::string> values);  // not empty
void writeAttribute(hid_t object, const char* name, std::uint64_t value);
// `format`: of the data set. Format 1 has texts of variable length, which are refused in later formats.
std::string readTextAttribute(hid_t object, const char* name, std::uint64_t format);
std::uint64_t readNumberAttribute(hid_t object, const char* name);

// An HDF5 file that is created in memory. HDF5 cannot close a file that it fails to flush, so it must not write to a disk that may be full.
class FileImage {
 public:
  // `format`: format version of the file, which is the oldest HDF5 that can read it. `metadata_bytes`: estimated size of everything except
  // rows; larger metadata are placed between rows.
  FileImage(H5F_libver_t format, std::size_t metadata_bytes);
  ~FileImage();
  FileImage(const FileImage&) = delete;
  FileImage& operator=(const FileImage&) = delete;

  hid_t file() const { return *file_; }
  // Creation properties for data sets without time stamps and fill values.
  Handle datasetProperties() const;
  // Creates a data set, and the groups in its path.
  Handle createDataset(const Column& column, std::span<const hsize_t> shape, hid_t properties);
  // Adds rows to a data set without copying them; they must outlive the FileContent. The data set must be contiguous with early allocation,
  // and have the same type in file and memory.
  void placeRows(hid_t data, std::span<const std::byte> rows);
  // Closes the file and returns its content. May be called once, after all handles into the file are closed.
  FileContent close();

 private:
  struct Buffer {
    void* data = nullptr;  // allocated with malloc(); HDF5 passes it on when it closes the file
    std::size_t size = 0;
  };
  friend struct ImageCallbacks;

  Buffer buffer_;
  std::vector<FilePiece> placed_;
  std::optional<Handle> file_;
};

Handle openForReading(const std::filesystem::path& file);

}  // namespace taxelsim::dataset
