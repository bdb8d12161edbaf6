#include "generation/shard_queue.h"

#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

Manifest manifestOf(std::uint64_t num_episodes, std::uint64_t episodes_per_shard) {
  Manifest manifest;
  manifest.num_episodes = num_episodes;
  manifest.episodes_per_shard = episodes_per_shard;
  manifest.columns = {{"data/a", ScalarType::kFloat32, {3}, "N", "A.", false}, {"meta/b", ScalarType::kInt32, {}, "1", "B.", true}};
  return manifest;
}

TEST(ShardQueue, HandsOutEpisodesOfIncompleteShardsInOrder) {
  ShardQueue queue(manifestOf(7, 3), {false, true, false}, 4);
  EXPECT_EQ(queue.numEpisodesLeft(), 4u);
  std::vector<EpisodePlace> places;
  while (const auto place = queue.next()) places.push_back(*place);
  ASSERT_EQ(places.size(), 4u);
  const std::uint64_t episodes[] = {0, 1, 2, 6}, rows[] = {0, 1, 2, 0}, shards[] = {0, 0, 0, 2};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(places[i].episode, episodes[i]);
    EXPECT_EQ(places[i].row, rows[i]);
    EXPECT_EQ(places[i].buffer->shard, shards[i]);
  }
  EXPECT_EQ(queue.numEpisodesLeft(), 0u);
  // The last shard has one episode.
  const ShardBuffer& last = *places[3].buffer;
  EXPECT_EQ(last.data.episode_lengths, (std::vector<std::uint64_t>{4}));
  EXPECT_EQ(last.data.columns[0].size(), 4u * 3 * sizeof(float));
  EXPECT_EQ(last.data.columns[1].size(), sizeof(std::int32_t));
  EXPECT_EQ(last.columns[0], last.data.columns[0].data());
}

TEST(ShardQueue, HasNoEpisodesWhenAllShardsAreComplete) {
  ShardQueue queue(manifestOf(6, 3), {true, true}, 4);
  EXPECT_EQ(queue.numEpisodesLeft(), 0u);
  EXPECT_FALSE(queue.next());
}

TEST(ShardQueue, ReusesRecycledBuffers) {
  ShardQueue queue(manifestOf(7, 3), {false, false, false}, 4);
  std::unique_ptr<ShardBuffer> done;
  for (int i = 0; i < 3; ++i) done = queue.finish(*queue.next());
  ASSERT_TRUE(done);
  ShardBuffer* memory = done.get();
  queue.recycle(std::move(done));
  for (int i = 0; i < 3; ++i) done = queue.finish(*queue.next());
  EXPECT_EQ(done.get(), memory);
  EXPECT_EQ(done->shard, 1u);
  queue.recycle(std::move(done));
  const EpisodePlace last = *queue.next();
  EXPECT_EQ(last.buffer, memory);
  EXPECT_EQ(last.buffer->data.columns[0].size(), 4u * 3 * sizeof(float));
  EXPECT_EQ(last.buffer->data.episode_lengths.size(), 1u);
}

TEST(ShardQueue, RejectsAShardThatExceedsMemory) {
  constexpr std::uint64_t kTooMany = std::uint64_t{1} << 62;  // exceeds std::vector::max_size(), so no memory is requested
  ShardQueue queue(manifestOf(kTooMany, kTooMany), {false}, 1);
  EXPECT_THAT(support::inputError([&] { queue.next(); }), ::testing::HasSubstr("episodes_per_shard"));
}

// For any order in which episodes end: each episode is handed out once, and each incomplete shard is returned once, with its last episode.
RC_GTEST_PROP(ShardQueueProperty, ReturnsEveryShardOnce, ()) {
  const std::uint64_t num_episodes = *rc::gen::inRange(1, 60);
  const std::uint64_t per_shard = *rc::gen::inRange(1, 20);
  const std::size_t num_instances = *rc::gen::inRange(1, 30);
  const Manifest manifest = manifestOf(num_episodes, per_shard);
  const auto complete = *rc::gen::container<std::vector<bool>>(manifest.numShards(), rc::gen::arbitrary<bool>());
  ShardQueue queue(manifest, complete, 2);

  std::vector<EpisodePlace> running;
  std::set<std::uint64_t> episodes, shards;
  for (;;) {
    while (running.size() < num_instances) {
      const auto place = queue.next();
      if (!place) break;
      RC_ASSERT(episodes.insert(place->episode).second);
      RC_ASSERT(place->episode == place->buffer->shard * per_shard + place->row);
      running.push_back(*place);
    }
    if (running.empty()) break;
    const std::size_t which = *rc::gen::inRange<std::size_t>(0, running.size());
    const EpisodePlace place = running[which];
    running.erase(running.begin() + static_cast<std::ptrdiff_t>(which));
    if (auto done = queue.finish(place)) {
      RC_ASSERT(shards.insert(done->shard).second);
      for (const EpisodePlace& other : running) RC_ASSERT(other.buffer != done.get());
      queue.recycle(std::move(done));
    }
  }
  RC_ASSERT(queue.numOpen() == 0u);
  for (std::uint64_t episode = 0; episode < num_episodes; ++episode) {
    RC_ASSERT(episodes.contains(episode) == !complete[episode / per_shard]);
  }
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) RC_ASSERT(shards.contains(shard) == !complete[shard]);
}

}  // namespace
}  // namespace taxelsim
