#include "dataset/column_io.h"

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

Handle openColumn(hid_t file, const Column& column, std::uint64_t num_rows, std::uint64_t format) {
  Handle data(H5Dopen2(file, column.name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::vector<hsize_t> shape = shapeOf(column, num_rows);
  std::vector<hsize_t> found(static_cast<std::size_t>(checked(H5Sget_simple_extent_ndims(space))));
  if (!found.empty()) checked(H5Sget_simple_extent_dims(space, found.data(), nullptr));
  expect(checked(H5Tequal(type, typeOf(column))) > 0 && found == shape, "column " + column.name + " has another type or shape");
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

std::vector<std::uint64_t> readEnds(hid_t data, const Column& column, std::uint64_t num_episodes) {
  std::vector<std::uint64_t> ends(num_episodes);
  readRows(data, column, 0, num_episodes, std::as_writable_bytes(std::span(ends)).data());
  for (std::size_t i = 0; i < ends.size(); ++i) expect(ends[i] > (i > 0 ? ends[i - 1] : 0), "meta/episode_ends is not increasing");
  return ends;
}

}  // namespace taxelsim::dataset
