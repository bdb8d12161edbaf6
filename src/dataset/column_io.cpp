#include "dataset/column_io.h"

#include <algorithm>

namespace taxelsim::dataset {

std::vector<hsize_t> shapeOf(const Column& column, std::uint64_t num_rows) {
  std::vector<hsize_t> shape{num_rows};
  shape.insert(shape.end(), column.shape.begin(), column.shape.end());
  return shape;
}

void writeColumnAttributes(hid_t data, const Column& column) {
  writeAttribute(data, "unit", column.unit);
  writeAttribute(data, "description", column.description);
  if (!column.value_names.empty()) writeAttribute(data, "value_names", column.value_names);
  if (!column.bit_names.empty()) writeAttribute(data, "bit_names", column.bit_names);
}

void expect(bool holds, const std::string& problem) {
  if (!holds) throw Hdf5Error(problem);
}

void expectNumber(hid_t object, const char* name, std::uint64_t expected) {
  const std::uint64_t found = readNumberAttribute(object, name);
  expect(found == expected,
         std::string(name) + " is " + std::to_string(found) + ", not " + std::to_string(expected) + " as in the manifest");
}

void expectText(hid_t object, const char* name, const std::string& expected, std::uint64_t format) {
  const std::string found = readTextAttribute(object, name, format);
  expect(found == expected, std::string(name) + " is " + found + ", not " + expected + " as in the manifest");
}

namespace {

// deflate expands a byte to at most 1032 bytes; with room for the padding of a last chunk.
constexpr std::uint64_t kMaxExpansion = 1100;

// Links to other files lead HDF5 out of the data set; HDF5 follows links of any kind in a path.
void checkLinks(hid_t file, const std::string& name) {
  for (std::size_t end = name.find('/'); true; end = name.find('/', end + 1)) {
    H5L_info_t link{};
    checked(H5Lget_info(file, name.substr(0, end).c_str(), &link, H5P_DEFAULT));
    expect(link.type == H5L_TYPE_HARD, name + " is a link");
    if (end == std::string::npos) return;
  }
}

// The rows must be in the file, and as many as their bytes can hold: a header of a few bytes can claim any number.
void checkStorage(hid_t file, hid_t data, const Column& column, std::uint64_t num_rows) {
  hsize_t file_bytes = 0;
  checked(H5Fget_filesize(file, &file_bytes));
  const std::uint64_t row_bytes = rowBytes(column);
  const std::uint64_t stored = H5Dget_storage_size(data);
  const Handle properties(H5Dget_create_plist(data), H5Pclose);
  const H5D_layout_t layout = checked(H5Pget_layout(properties));
  expect(checked(H5Pget_external_count(properties)) == 0 && (layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED),
         "column " + column.name + " is not stored in this file");
  const std::uint64_t max_bytes = layout == H5D_CONTIGUOUS ? stored : stored * kMaxExpansion;
  expect(stored <= file_bytes && num_rows <= max_bytes / row_bytes, "column " + column.name + " claims " + std::to_string(num_rows) +
                                                                        " rows, more than its " + std::to_string(stored) + " bytes of " +
                                                                        std::to_string(file_bytes) + " hold");
  if (layout == H5D_CONTIGUOUS) return;
  std::vector<hsize_t> chunk(column.shape.size() + 1);
  expect(H5Pget_chunk(properties, static_cast<int>(chunk.size()), chunk.data()) == static_cast<int>(chunk.size()) &&
             std::equal(column.shape.begin(), column.shape.end(), chunk.begin() + 1) &&
             (chunk[0] == 1 || chunk[0] <= kMaxChunkBytes / row_bytes),
         "column " + column.name + " has chunks of another shape");
  for (int filter = 0; filter < checked(H5Pget_nfilters(properties)); ++filter) {
    unsigned flags = 0, settings = 0;
    std::size_t num_settings = 0;
    const H5Z_filter_t kind =
        H5Pget_filter2(properties, static_cast<unsigned>(filter), &flags, &num_settings, nullptr, 0, nullptr, &settings);
    expect(kind == H5Z_FILTER_SHUFFLE || kind == H5Z_FILTER_DEFLATE,
           "column " + column.name + " has another filter than shuffle and deflate");
  }
}

}  // namespace

Handle openColumn(hid_t file, const Column& column, std::uint64_t num_rows, std::uint64_t format) {
  checkLinks(file, column.name);
  Handle data(H5Dopen2(file, column.name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::vector<hsize_t> shape = shapeOf(column, num_rows);
  std::vector<hsize_t> found(static_cast<std::size_t>(checked(H5Sget_simple_extent_ndims(space))));
  if (!found.empty()) checked(H5Sget_simple_extent_dims(space, found.data(), nullptr));
  expect(checked(H5Tequal(type, typeOf(column))) > 0 && found == shape, "column " + column.name + " has another type or shape");
  checkStorage(file, data, column, num_rows);
  expectText(data, "unit", column.unit, format);
  expectText(data, "description", column.description, format);
  return data;
}

void readRows(hid_t data, const Column& column, std::uint64_t first, std::uint64_t count, std::byte* rows) {
  std::vector<hsize_t> start(column.shape.size() + 1, 0);
  start[0] = first;
  const std::vector<hsize_t> shape = shapeOf(column, count);
  const Handle space(H5Dget_space(data), H5Sclose);
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr));
  const Handle memory(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  checked(H5Dread(data, typeOf(column), memory, space, H5P_DEFAULT, rows));
}

void readEnds(hid_t data, const Column& column, std::span<std::uint64_t> ends) {
  readRows(data, column, 0, ends.size(), std::as_writable_bytes(ends).data());
  for (std::size_t i = 0; i < ends.size(); ++i) expect(ends[i] > (i > 0 ? ends[i - 1] : 0), "meta/episode_ends is not increasing");
}

}  // namespace taxelsim::dataset
