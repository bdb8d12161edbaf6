// HDF5's C API with owners and exceptions. No knowledge of shards.
#pragma once

#include <hdf5.h>

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

#include "dataset/files.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// Held around every use of HDF5: the library has global state and need not be built thread-safe. Its habit of printing errors is
// switched off meanwhile and put back after.
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

// HDF5's error stack as part of one line: the call that failed and the deepest reason.
std::string hdf5Problem();

// An HDF5 failure while a file is read or made; the caller adds the file's name.
class Hdf5Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Owner of one identifier.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  // Throws Hdf5Error when `id` is a failure.
  Handle(hid_t id, Closer closer);
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): passed to C functions only
  // Closes it now; throws Hdf5Error when that fails.
  void close();

 private:
  hid_t id_;
  Closer closer_;
};

// Throws Hdf5Error for a negative return value, else gives it back.
template <typename T>
T checked(T value) {
  if (value < 0) throw Hdf5Error(hdf5Problem());
  return value;
}

hid_t memoryType(ScalarType type);
hid_t fileType(ScalarType type);  // little-endian on every machine

// Attributes of a file or data set.
void writeAttribute(hid_t object, const char* name, const std::string& value);
void writeAttribute(hid_t object, const char* name, std::uint64_t value);
std::string readTextAttribute(hid_t object, const char* name);
std::uint64_t readNumberAttribute(hid_t object, const char* name);

// A file being made in memory, so that HDF5 never meets a full disk (it cannot close a file that it fails to flush).
class FileImage {
 public:
  // `format` is that of the oldest HDF5 that shall read the file. `metadata_bytes`: of everything but rows, as a guess; what is more is
  // put between the rows.
  FileImage(H5F_libver_t format, std::size_t metadata_bytes);
  ~FileImage();
  FileImage(const FileImage&) = delete;
  FileImage& operator=(const FileImage&) = delete;

  hid_t file() const { return *file_; }
  // Property list for data sets: no time stamps, no fill values.
  Handle datasetProperties() const;
  // Creates a data set, with groups on the way.
  Handle createDataset(const std::string& name, ScalarType type, std::span<const hsize_t> shape, hid_t properties);
  // Gives the data set its rows without copying them: they are written to the file from where they lie, so they must outlive its content.
  // The data set is in one piece, its space allocated early, its type in the file that in memory.
  void placeRows(hid_t data, std::span<const std::byte> rows);
  // Closes the file and gives its content, once. Every handle into it must be gone.
  FileContent close();

 private:
  struct Buffer {
    void* data = nullptr;  // as malloc() gave it, handed over by HDF5 when it closes the file
    std::size_t size = 0;
  };
  friend struct ImageCallbacks;

  Buffer buffer_;
  std::vector<FilePiece> placed_;
  std::optional<Handle> file_;
};

Handle openForReading(const std::filesystem::path& file);

}  // namespace taxelsim::dataset
