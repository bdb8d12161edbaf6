// Clears the outputs of the taxels that the step before has written (all of them where it is not known) outside the window. `lane`: of the
// team.
void clearOutside(uint instance, uint lane, ImageWindow window, bool new_frame) {
  if (!kOnePatch) return;
  uvec4 before = KEEPS_WINDOW ? image_windows[instance] : uvec4(0, 0, kRows, kCols);
  uvec2 first = before.xy, count = before.zw;
  bool covered = all(greaterThanEqual(first, window.first)) && all(lessThanEqual(first + count, window.first + window.count));
  uint num_rows = covered ? 0 : count.x, end = first.y + count.y;
  uint i = lane;
  for (; i < num_rows; i += TEAM) {
    uvec2 at = first + uvec2(i, 0);
    bool in_row = at.x - window.first.x < window.count.x;
    for (; at.y < end; ++at.y) {
      if (in_row && at.y - window.first.y < window.count.y) continue;
      uint t = instance * NUM_TAXELS + at.x * kCols + at.y;
      if (OUTPUT_NORMAL) spread_normal[t] = 0.0;
      if (SHEAR) spread_shear[2 * t] = spread_shear[2 * t + 1] = 0.0;
      if (new_frame) image[t] = 0;
    }
    checkLoop(at.y < end);
  }
  checkLoop(i < num_rows);
}
