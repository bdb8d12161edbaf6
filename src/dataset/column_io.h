// A column as an HDF5 data set: its attributes, its rows, and checks of a file against the manifest.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dataset/column.h"
#include "dataset/hdf5.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// (num_rows x shape of a row)
std::vector<hsize_t> shapeOf(const Column& column, std::uint64_t num_rows);

// Unit, description and names of values or bits.
void writeColumnAttributes(hid_t data, const Column& column);

// Throws Hdf5Error with this problem unless the condition holds.
void expect(bool holds, const std::string& problem);

// Throw Hdf5Error unless the attribute is that of the manifest.
void expectNumber(hid_t object, const char* name, std::uint64_t expected);
void expectText(hid_t object, const char* name, const std::string& expected, std::uint64_t format);

// Opens a column. Throws Hdf5Error if its type, shape, unit or description is not as expected, if it is not stored in this file, or if its
// bytes cannot hold so many rows.
Handle openColumn(hid_t file, const Column& column, std::uint64_t num_rows, std::uint64_t format);

// Reads rows [first, first + count), which must exist.
void readRows(hid_t data, const Column& column, std::uint64_t first, std::uint64_t count, std::byte* rows);

// Reads the rows of meta/episode_ends to `ends`. Throws Hdf5Error if they do not increase.
void readEnds(hid_t data, const Column& column, std::span<std::uint64_t> ends);

}  // namespace taxelsim::dataset
