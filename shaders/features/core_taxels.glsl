// Core taxels of a contact: those so far inside it that the spread brings them as much force as it takes away. All taxels of the patch around a core taxel
// report. A taxel at the patch's border is never one, since the contact may end anywhere beyond it. Twin: src/reference/contact_features.cpp.

// Whether all taxels of a taxel's row within the patch's core distance report, and the taxel is not at the end of the row.
bool isCoreInRow(uint first_taxel, uint t) {
  Place place = placeOf(t);
  uint row = place.grid.z + place.at.x * place.grid.y;
  uint last = min(place.at.y + place.grid.w, place.grid.y - 1);
  bool core = place.at.y > 0 && place.at.y + 1 < place.grid.y;
  for (uint j = place.at.y - min(place.at.y, place.grid.w); j <= last && core; ++j) core = reportsAt(first_taxel, row + j);
  return core;
}

// The same for the block of taxels around it, once every taxel's kCoreInRow has been set.
bool isCore(uint first_taxel, uint t) {
  Place place = placeOf(t);
  uint column = place.grid.z + place.at.y;
  uint last = min(place.at.x + place.grid.w, place.grid.x - 1);
  bool core = place.at.x > 0 && place.at.x + 1 < place.grid.x;
  for (uint i = place.at.x - min(place.at.x, place.grid.w); i <= last && core; ++i) {
    core = (taxel_regions[first_taxel + column + i * place.grid.y] & kCoreInRow) != 0;
  }
  return core;
}

// Marks the core taxels of grid patches.
void markCore(Instance instance, uint lane) {
  uint t = lane;
  if (kGrids) {
    for (; t < instance.end; t += TEAM) {
      uint word = taxel_regions[instance.first_taxel + t];
      if (reports(word) && isCoreInRow(instance.first_taxel, t)) taxel_regions[instance.first_taxel + t] = word | kCoreInRow;
    }
    teamBarrier();
    for (t = lane; t < instance.end; t += TEAM) {
      uint word = taxel_regions[instance.first_taxel + t];
      bool in_range = CLEAN || float(image[instance.first_taxel + t]) < SATURATION;
      if (in_range && isCore(instance.first_taxel, t)) taxel_regions[instance.first_taxel + t] = word | kCoreTaxel;
    }
  }
  checkLoop(kGrids && t < instance.end);
}
