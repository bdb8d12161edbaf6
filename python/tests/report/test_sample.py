"""Ranges of frames of a sample."""

from itertools import pairwise

import numpy as np
import pytest

from taxelsim.report.sample import BLOCK_FRAMES, NUM_BLOCKS, blocks_of


@pytest.mark.parametrize("num_frames", [1, BLOCK_FRAMES, BLOCK_FRAMES + 1, 5 * BLOCK_FRAMES - 1])
def test_small_data_sets_are_read_as_a_whole(num_frames):
    blocks = blocks_of(num_frames, 10 * BLOCK_FRAMES)
    np.testing.assert_array_equal(np.concatenate([np.arange(*block) for block in blocks]), np.arange(num_frames))


@pytest.mark.parametrize(("num_frames", "max_frames"), [(2, 1), (101, 100), (1000, 65), (10**12, 10**6), (10**6 + 1, 10**6)])
def test_samples_are_disjoint_ranges_from_first_to_last(num_frames, max_frames):
    blocks = blocks_of(num_frames, max_frames)
    assert sum(end - first for first, end in blocks) == max_frames
    assert len(blocks) == min(NUM_BLOCKS, max_frames)
    assert blocks[0][0] == 0
    assert all(before[1] <= after[0] for before, after in pairwise(blocks))
    assert blocks[-1][1] == num_frames or max_frames == 1
