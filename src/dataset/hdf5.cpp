#include "dataset/hdf5.h"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

namespace taxelsim::dataset {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are hashed in memory order, and files are little-endian");

constexpr std::size_t kImageIncrement = std::size_t{256} << 10;  // bytes; step by which a file in memory grows

constexpr unsigned kMaxCompactAttributes = 32;  // of the file: with more HDF5 moves attributes into a heap and a B-tree

constexpr std::size_t kSuperblockVersionOffset = 8;  // bytes
constexpr std::size_t kEndOfFileOffset = 28;
constexpr std::size_t kSuperblockSize = 48;

std::mutex& libraryMutex() {
  static std::mutex mutex;
  // Any fork() of the process waits for the lock, so that the child finds it free.
  [[maybe_unused]] static const int registered = ::pthread_atfork([] { mutex.lock(); }, [] { mutex.unlock(); }, [] { mutex.unlock(); });
  return mutex;
}

herr_t collect(unsigned, const H5E_error2_t* error, void* data) {
  static_cast<std::vector<std::string>*>(data)->emplace_back(error->desc != nullptr ? error->desc : "");
  return 0;
}

// UTF-8 of a fixed length, padded with zeros. HDF5 has no texts of length 0.
Handle textType(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  checked(H5Tset_size(type, std::max<std::size_t>(length, 1)));
  checked(H5Tset_cset(type, H5T_CSET_UTF8));
  checked(H5Tset_strpad(type, H5T_STR_NULLPAD));
  return type;
}

hid_t numberType(ScalarType type) {
  switch (type) {
    case ScalarType::kUint8:
      return H5T_STD_U8LE;
    case ScalarType::kUint16:
      return H5T_STD_U16LE;
    case ScalarType::kInt16:
      return H5T_STD_I16LE;
    case ScalarType::kInt32:
      return H5T_STD_I32LE;
    case ScalarType::kUint64:
      return H5T_STD_U64LE;
    case ScalarType::kFloat32:
      return H5T_IEEE_F32LE;
    case ScalarType::kFloat64:
    case ScalarType::kText:
      break;
  }
  return H5T_IEEE_F64LE;
}

// A text of format 1.
std::string readVariableText(hid_t attribute) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  checked(H5Tset_size(type, H5T_VARIABLE));
  checked(H5Tset_cset(type, H5T_CSET_UTF8));
  char* text = nullptr;
  checked(H5Aread(attribute, type, &text));
  std::string value = text != nullptr ? text : "";
  H5free_memory(text);
  return value;
}

}  // namespace

Hdf5Session::Hdf5Session() : lock_(libraryMutex()) {
  // Its handler prints an additional line for each object that a failed read leaves open. Files that are written are closed by then.
  [[maybe_unused]] static const herr_t no_exit_handler = H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &printer_, &printer_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Session::~Hdf5Session() {
  H5Eset_auto2(H5E_DEFAULT, printer_, printer_data_);
}

pid_t forkWithHdf5() {
  libraryMutex();  // whose handlers make the child safe
  return ::fork();
}

std::string hdf5Problem() {
  std::vector<std::string> reasons;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, collect, &reasons);
  H5Eclear2(H5E_DEFAULT);
  if (reasons.empty()) return "HDF5 failed";
  std::string line = "HDF5: " + reasons.front();
  if (reasons.size() > 1) line += ": " + reasons.back();
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

Handle::Handle(hid_t id, Closer closer) : id_(checked(id)), closer_(closer) {}

void Handle::close() {
  checked(closer_(id_));
  id_ = -1;
}

Handle typeOf(const Column& column) {
  if (column.type == ScalarType::kText) return textType(column.text_length);
  return Handle(H5Tcopy(numberType(column.type)), H5Tclose);
}

void writeAttribute(hid_t object, const char* name, const std::string& value) {
  const Handle type = textType(value.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  checked(H5Awrite(attribute, type, value.c_str()));
}

void writeAttribute(hid_t object, const char* name, std::span<const std::string> values) {
  std::size_t length = 1;
  for (const std::string& value : values) length = std::max(length, value.size());
  std::string texts;
  for (const std::string& value : values) texts += value + std::string(length - value.size(), '\0');
  const Handle type = textType(length);
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  checked(H5Awrite(attribute, type, texts.data()));
}

void writeAttribute(hid_t object, const char* name, std::uint64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, H5T_STD_U64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  checked(H5Awrite(attribute, H5T_NATIVE_UINT64, &value));
}

std::string readTextAttribute(hid_t object, const char* name, std::uint64_t format) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const bool is_variable = checked(H5Tis_variable_str(stored)) > 0;
  if (H5Tget_class(stored) != H5T_STRING || is_variable != (format == 1) || H5Sget_simple_extent_npoints(space) != 1)
    throw Hdf5Error(std::string("attribute ") + name + " is not a text as in format " + std::to_string(format));
  if (is_variable) return readVariableText(attribute);
  std::string value(H5Tget_size(stored), '\0');
  checked(H5Aread(attribute, stored, value.data()));
  return value.substr(0, value.find('\0'));
}

std::uint64_t readNumberAttribute(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(stored) != H5T_INTEGER || H5Sget_simple_extent_npoints(space) != 1)
    throw Hdf5Error(std::string("attribute ") + name + " is not a whole number");
  std::uint64_t value = 0;
  checked(H5Aread(attribute, H5T_NATIVE_UINT64, &value));
  return value;
}

// Callbacks that keep the buffer when HDF5 closes the file. H5Fget_file_image() is no alternative: it clears the flag "open for writing" in
// the superblock without updating the superblock's checksum.
struct ImageCallbacks {
  static void* allocate(size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
  static void* copy(void* to, const void* from, size_t size, H5FD_file_image_op_t, void*) { return std::memcpy(to, from, size); }
  static void* reallocate(void* data, size_t size, H5FD_file_image_op_t, void* user) {
    void* moved = std::realloc(data, size);
    if (moved != nullptr) static_cast<FileImage::Buffer*>(user)->size = size;
    return moved;
  }
  static herr_t release(void* data, H5FD_file_image_op_t operation, void* user) {
    if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
      static_cast<FileImage::Buffer*>(user)->data = data;
    else
      std::free(data);
    return 0;
  }
  static void* share(void* user) { return user; }
  static herr_t freeUserData(void*) { return 0; }
};

FileImage::FileImage(H5F_libver_t format, std::size_t metadata_bytes) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  checked(H5Pset_fapl_core(access, kImageIncrement, false));
  checked(H5Pset_libver_bounds(access, format, format));
  // All metadata in one block at the start, so that the buffer contains no space for rows.
  checked(H5Pset_meta_block_size(access, metadata_bytes));
  H5FD_file_image_callbacks_t callbacks{ImageCallbacks::allocate,
                                        ImageCallbacks::copy,
                                        ImageCallbacks::reallocate,
                                        ImageCallbacks::release,
                                        ImageCallbacks::share,
                                        ImageCallbacks::freeUserData,
                                        &buffer_};
  checked(H5Pset_file_image_callbacks(access, &callbacks));
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  checked(H5Pset_obj_track_times(creation, false));
  checked(H5Pset_attr_phase_change(creation, kMaxCompactAttributes, 0));
  file_.emplace(H5Fcreate("taxelsim", H5F_ACC_TRUNC, creation, access), H5Fclose);
}

FileImage::~FileImage() {
  file_.reset();
  std::free(buffer_.data);
}

Handle FileImage::datasetProperties() const {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  checked(H5Pset_obj_track_times(properties, false));
  checked(H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER));
  return properties;
}

Handle FileImage::createDataset(const Column& column, std::span<const hsize_t> shape, hid_t properties) {
  const std::string& name = column.name;
  // Groups that HDF5 creates implicitly would have time stamps.
  for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1)) {
    const std::string group = name.substr(0, slash);
    if (checked(H5Lexists(*file_, group.c_str(), H5P_DEFAULT)) > 0) continue;
    const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    checked(H5Pset_obj_track_times(creation, false));
    const Handle created(H5Gcreate2(*file_, group.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose);
  }
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  return Handle(H5Dcreate2(*file_, name.c_str(), typeOf(column), space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
}

void FileImage::placeRows(hid_t data, std::span<const std::byte> rows) {
  const haddr_t offset = H5Dget_offset(data);
  if (offset == HADDR_UNDEF || H5Dget_storage_size(data) != rows.size())
    throw Hdf5Error("the storage of a data set does not match its rows");
  placed_.push_back({.offset = offset, .bytes = rows});
}

FileContent FileImage::close() {
  file_->close();
  file_.reset();
  FileContent content;
  content.buffer.reset(std::exchange(buffer_.data, nullptr));
  // The buffer may be larger than the file, since it grows in steps, or smaller, since rows are not in it. The size of the file is in its
  // superblock (HDF5 File Format Specification, "Superblock (Version 2 and 3)").
  const std::span image(static_cast<const std::byte*>(content.buffer.get()), content.buffer ? buffer_.size : 0);
  if (image.size() < kSuperblockSize || image[kSuperblockVersionOffset] < std::byte{2})
    throw Hdf5Error("the superblock of the file in memory is invalid");
  std::memcpy(&content.size, image.data() + kEndOfFileOffset, sizeof(content.size));

  std::sort(placed_.begin(), placed_.end(), [](const FilePiece& a, const FilePiece& b) { return a.offset < b.offset; });
  std::uint64_t end_of_pieces = 0;
  const auto addImageUntil = [&](std::uint64_t end) {
    end = std::min<std::uint64_t>(end, image.size());
    if (end_of_pieces < end)
      content.pieces.push_back({.offset = end_of_pieces, .bytes = image.subspan(end_of_pieces, end - end_of_pieces)});
  };
  for (const FilePiece& rows : placed_) {
    if (rows.offset < end_of_pieces) throw Hdf5Error("rows overlap in a file in memory");
    addImageUntil(rows.offset);
    content.pieces.push_back(rows);
    end_of_pieces = rows.offset + rows.bytes.size();
  }
  addImageUntil(content.size);
  const FilePiece& last = content.pieces.back();
  if (last.offset + last.bytes.size() > content.size) throw Hdf5Error("the file in memory ends before its rows");
  return content;
}

Handle openForReading(const std::filesystem::path& file) {
  // Complete shards are immutable, and some file systems do not support locks.
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  checked(H5Pset_file_locking(access, false, true));
  checked(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG));  // also closes objects that HDF5 failed to open completely
  return Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
}

}  // namespace taxelsim::dataset
