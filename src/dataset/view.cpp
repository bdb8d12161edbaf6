#include "dataset/view.h"

#include <span>

#include "dataset/checksum.h"
#include "dataset/column_io.h"
#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kViewMetadataBytes = 2048;  // HDF5's default

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
  writeColumnAttributes(image.createDataset(column, shape, properties), column);
}

Column allEndsColumn() {
  Column column = episodeEndsColumn();
  column.description = "Number of frames up to the end of each episode, counted from the first frame of all.";
  return column;
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
    FileImage image(H5F_LIBVER_V110, kViewMetadataBytes);  // the first version with virtual data sets
    writeAttribute(image.file(), "format_version", manifest.format_version);
    writeAttribute(image.file(), "num_shards", shard_ends.size());
    writeAttribute(image.file(), "num_episodes", ends.size());
    writeAttribute(image.file(), "num_frames", first_frame);
    writeAttribute(image.file(), "seed", manifest.seed);
    writeAttribute(image.file(), "scene_sha256", sceneHash(manifest));
    writeAttribute(image.file(), "policy", manifest.policy);
    {
      // A virtual data set cannot add the offset of each shard, so the values are stored.
      const Column column = allEndsColumn();
      const Handle data = image.createDataset(column, shapeOf(column, ends.size()), image.datasetProperties());
      writeColumnAttributes(data, column);
      checked(H5Dwrite(data, typeOf(column), H5S_ALL, H5S_ALL, H5P_DEFAULT, ends.data()));
    }
    for (const Column& column : manifest.columns) writeVirtualColumn(image, column, shard_ends);
    return image.close();
  } catch (const Hdf5Error& error) {
    throw Error(ErrorKind::kIo, std::string("cannot create ") + kViewName + ": " + error.what());
  }
}

std::vector<std::uint64_t> viewEnds(const std::filesystem::path& file, const Manifest& manifest, Isolation isolation) {
  const std::uint64_t format = manifest.format_version;
  verifyChecksum(file);
  checkCounts(file, manifest.num_episodes);
  std::vector<std::uint64_t> ends(manifest.num_episodes);
  readHdf5(file, "view", "resume the data set to write it again", isolation, std::as_writable_bytes(std::span(ends)),
           [&](std::span<std::byte> bytes) {
             const Handle handle = openForReading(file);
             expectNumber(handle, "format_version", format);
             expectNumber(handle, "num_shards", manifest.numShards());
             expectNumber(handle, "num_episodes", manifest.num_episodes);
             expectNumber(handle, "seed", manifest.seed);
             expectText(handle, "scene_sha256", sceneHash(manifest), format);
             expectText(handle, "policy", manifest.policy, format);
             const Column column = allEndsColumn();
             readEnds(openColumn(handle, column, manifest.num_episodes, format), column, episodeEnds(bytes));
           });
  return ends;
}

}  // namespace taxelsim::dataset
