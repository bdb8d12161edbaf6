#include "dataset/view.h"

#include <span>

#include "dataset/hdf5.h"
#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kMetadataBytes = 2048;  // HDF5's default

void writeVirtualColumn(FileImage& image, const Column& column, const std::vector<std::vector<std::uint64_t>>& shard_ends) {
  std::vector<hsize_t> shape{0};
  shape.insert(shape.end(), column.shape.begin(), column.shape.end());
  for (const std::vector<std::uint64_t>& ends : shard_ends) shape[0] += column.per_episode ? ends.size() : ends.back();
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);

  const Handle properties = image.datasetProperties();
  std::vector<hsize_t> start(shape.size(), 0);
  std::vector<hsize_t> count = shape;
  for (std::size_t shard = 0; shard < shard_ends.size(); ++shard) {
    count[0] = column.per_episode ? shard_ends[shard].size() : shard_ends[shard].back();
    const Handle source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
    checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
    checked(H5Pset_virtual(properties, space, shardName(shard).c_str(), ("/" + column.name).c_str(), source));
    start[0] += count[0];
  }
  const Handle data = image.createDataset(column.name, column.type, shape, properties);
  writeAttribute(data, "unit", column.unit);
  writeAttribute(data, "description", column.description);
}

}  // namespace

FileContent viewImage(const Manifest& manifest, const std::vector<std::vector<std::uint64_t>>& shard_ends) {
  std::vector<std::uint64_t> ends;
  std::uint64_t first_frame = 0;
  for (const std::vector<std::uint64_t>& shard : shard_ends) {
    for (const std::uint64_t end : shard) ends.push_back(first_frame + end);
    first_frame += shard.back();
  }
  try {
    const Hdf5Session session;
    FileImage image(H5F_LIBVER_V110, kMetadataBytes);  // the first version with virtual data sets
    writeAttribute(image.file(), "format_version", kFormatVersion);
    writeAttribute(image.file(), "num_shards", shard_ends.size());
    writeAttribute(image.file(), "num_episodes", ends.size());
    writeAttribute(image.file(), "num_frames", first_frame);
    writeAttribute(image.file(), "seed", manifest.seed);
    writeAttribute(image.file(), "scene_sha256", sceneHash(manifest));
    {
      // A virtual data set cannot add the offset of each shard, so the values are stored.
      const hsize_t shape[] = {ends.size()};
      const Handle data = image.createDataset(kEpisodeEnds, ScalarType::kUint64, shape, image.datasetProperties());
      writeAttribute(data, "unit", std::string("1"));
      writeAttribute(data, "description",
                     std::string("Number of frames up to the end of each episode, counted from the first frame of all."));
      checked(H5Dwrite(data, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, ends.data()));
    }
    for (const Column& column : manifest.columns) writeVirtualColumn(image, column, shard_ends);
    return image.close();
  } catch (const Hdf5Error& error) {
    throw Error(ErrorKind::kIo, std::string("cannot create ") + kViewName + ": " + error.what());
  }
}

}  // namespace taxelsim::dataset
