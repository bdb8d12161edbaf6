// The reader of data sets, for taxelsim.Dataset: it reads manifest and view, checks shards, reads rows in child processes, and scales
// pictures.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "bind.h"
#include "figures/colours.h"
#include "taxelsim/counts_range.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

std::vector<std::array<int, 3>> valueColours() {
  std::vector<std::array<int, 3>> colours;
  const auto byte = [](double level) { return static_cast<int>(std::lround(255 * level)); };
  for (int i = 0; i < 256; ++i) {
    const figures::Colour colour = figures::along(figures::kViridis, i / 255.0);
    colours.push_back({byte(colour.red), byte(colour.green), byte(colour.blue)});
  }
  return colours;
}

template <typename T>
nb::object arrayOf(std::vector<T> values) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = owned->data();
  const std::size_t size = owned->size();
  const nb::capsule owner(owned.release(), [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  return nb::ndarray<nb::numpy, T, nb::ndim<1>>(data, {size}, owner).cast();
}

// Not isolated: refuses a missing or broken view, instead of reading all shards in its place.
void open(DatasetReader* self, const std::filesystem::path& folder, bool isolated) {
  const WithoutGil released;
  if (!isolated) {
    const ViewStatus view = checkView(folder);
    if (view.state == ViewStatus::State::kBroken) throw Error(ErrorKind::kInput, view.problem);
    if (view.state == ViewStatus::State::kMissing)
      throw Error(ErrorKind::kInput,
                  folder.string() + ": the data set is not complete: it has no dataset.h5; run generate again to resume it");
  }
  new (self) DatasetReader(folder, /*allow_incomplete=*/false, isolated);
}

nb::object readRows(const DatasetReader& reader, const std::string& column, std::uint64_t first, std::uint64_t count) {
  std::vector<std::byte> rows;
  {
    const WithoutGil released;
    rows = reader.read(column, first, count);
  }
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(rows.data());
  return arrayOf(std::vector<std::uint8_t>(bytes, bytes + rows.size()));
}

double rangeOfCounts(const nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>& counts, double noise) {
  return countsRange({counts.data(), counts.size()}, noise);
}

double rangeOfColumn(const DatasetReader& reader, const std::string& column) {
  return countsRange(reader, column, 0, reader.numFrames());
}

}  // namespace

void bindDataset(nb::module_& module) {
  nb::class_<Column>(module, "DatasetColumn", "A column of a manifest.")
      .def_ro("name", &Column::name)
      .def_prop_ro("type", [](const Column& self) { return nameOf(self.type); })
      .def_ro("text_length", &Column::text_length)
      .def_ro("shape", &Column::shape)
      .def_ro("unit", &Column::unit)
      .def_ro("description", &Column::description)
      .def_ro("value_names", &Column::value_names)
      .def_ro("bit_names", &Column::bit_names);
  nb::class_<DatasetReader>(module, "DatasetReader", "Reads a data set. isolated: in child processes, as always for format 1.")
      .def("__init__", &open, "folder"_a, "isolated"_a)
      .def_prop_ro("columns", [](const DatasetReader& self) { return self.manifest().columns; })
      .def_prop_ro("format_version", [](const DatasetReader& self) { return self.manifest().format_version; })
      .def_prop_ro("seed", [](const DatasetReader& self) { return self.manifest().seed; })
      .def_prop_ro("scene", [](const DatasetReader& self) { return nb::bytes(self.manifest().scene.data(), self.manifest().scene.size()); })
      .def_prop_ro("policy", [](const DatasetReader& self) { return self.manifest().policy; })
      .def_prop_ro("program_version", [](const DatasetReader& self) { return self.manifest().program_version; })
      .def_prop_ro("device", [](const DatasetReader& self) { return self.manifest().device; })
      .def_prop_ro("num_shards", [](const DatasetReader& self) { return self.manifest().numShards(); })
      .def_prop_ro("episodes_per_shard", [](const DatasetReader& self) { return self.manifest().episodes_per_shard; })
      .def_prop_ro(
          "episode_ends", [](const DatasetReader& self) { return arrayOf(self.episodeEnds()); },
          nb::sig("def episode_ends(self) -> numpy.typing.NDArray[typing.Any]"))
      .def("check_shard", &DatasetReader::checkShard, "shard"_a, "contents"_a, nb::call_guard<WithoutGil>(),
           "Checks a shard, so that HDF5 can read its columns without leaving the file. contents: whether to compare the file, or all "
           "columns of format 1, with their SHA-256.")
      .def("read", &readRows, "column"_a, "first"_a, "count"_a,
           nb::sig("def read(self, column: str, first: int, count: int) -> numpy.typing.NDArray[typing.Any]"),
           "Bytes of rows [first, first + count).")
      .def("counts_range", &rangeOfColumn, "column"_a, nb::call_guard<WithoutGil>(),
           "Counts of the brightest colour of pictures of the data set.");
  module.def("value_colours", &valueColours, "Colours of tactile images, 256 of red, green, blue, from dark to bright.");
  module.attr("SHEAR_DEVIATIONS") = kShearDeviations;
  module.def("counts_range", &rangeOfCounts, "counts"_a, "noise"_a, "Counts of the brightest colour of pictures of `counts`.");
  module.def("write_view", &writeDatasetView, "folder"_a, "num_frames"_a, nb::call_guard<WithoutGil>(),
             "Writes dataset.h5 and its checksum next to a manifest whose shards are elsewhere. num_frames: of an episode.");
}

}  // namespace taxelsim::python
