// Core taxels of a contact: those so far inside it that the spread brings them as much force as it takes away. All taxels of the patch
// around a core taxel report. A taxel at the patch's border is never one, since the contact may end anywhere beyond it. Reference:
// src/reference/contact_features.cpp.
//
// A taxel is one where all taxels of its row within the patch's core distance report, and the same holds for all of its column within that
// distance. A line of taxels is read once: a window ends at taxel j, and `run` counts the taxels up to j that have the wanted mark.

// Whether the window of taxel j - distance, the part of it on the line, has the mark throughout; false for the ends of the line.
bool isInside(uint j, uint distance, uint size, uint run) {
  uint middle = j - distance;  // wraps to a large number before the first window
  uint first = middle - min(middle, distance), last = min(j, size - 1u);
  return middle > 0u && middle + 1u < size && run > last - first;
}

// Marks the taxels of a row whose window reports. `first`: taxel of the instance.
void markCoreInRow(uint first_word, uint first, uvec4 grid) {
  uint run = 0, j = 0, distance = min(grid.w, grid.y);
  for (; j < grid.y + distance; ++j) {
    if (j < grid.y) run = reportsAt(first_word, first + j) ? run + 1u : 0u;
    if (isInside(j, distance, grid.y, run)) taxel_regions[first_word + first + j - distance] |= kCoreInRow;
  }
  checkLoop(j < grid.y + distance);
}

// Marks the core taxels of a column, whose rows have been marked.
void markCoreInColumn(Instance instance, uint first, uvec4 grid) {
  uint run = 0, i = 0, distance = min(grid.w, grid.x);
  for (; i < grid.x + distance; ++i) {
    if (i < grid.x) run = (taxel_regions[instance.first_word + first + i * grid.y] & kCoreInRow) != 0 ? run + 1u : 0u;
    if (!isInside(i, distance, grid.x, run)) continue;
    uint taxel = first + (i - distance) * grid.y;
    if (is_clean || float(wordOfFours(Image, instance.first_taxel + taxel)) < SATURATION)
      taxel_regions[instance.first_word + taxel] |= kCoreTaxel;
  }
  checkLoop(i < grid.x + distance);
}

// Marks the core taxels of grid patches. An invocation owns rows, then columns.
void markCore(Instance instance, uint lane) {
  if (!kGrids) return;
  for (uint patch_number = 0; patch_number < NUM_PATCHES; ++patch_number) {
    uvec4 grid = planeRecord(patch_number).grid;
    uint rows = instance.end > 0 ? grid.x : 0u, cols = instance.end > 0 ? grid.y : 0u;
    for (uint row = lane; row < rows; row += TEAM) markCoreInRow(instance.first_word, grid.z + row * grid.y, grid);
    teamBarrier();
    for (uint col = lane; col < cols; col += TEAM) markCoreInColumn(instance, grid.z + col, grid);
  }
}
