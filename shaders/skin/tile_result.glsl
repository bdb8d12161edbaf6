// The result of one tile: force (N) and torque (N m) in S from the lanes' partial sums, and the window of its active taxels.
// Out: tile_results; the state that friction and relaxation keep of the tile.

void writeTileResult(Tile tile, TileStep step, ActiveTaxels taxels, Box samples) {
  vec4 total = sumOfPartials();
  if (usesTile() && REPEAT > 1) clearSamples(tile, samples);
  if (RELAXATION > 0 && kUpdatesSkin) updateRestOfSkin(tile, step.skin, taxels.first, taxels.count);
  vec3 force = -total.x * tile.X_PS.row2.xyz;  // rows of R_PS are the axes of P in S
  vec3 torque = total.y * tile.X_PS.row0.xyz + total.z * tile.X_PS.row1.xyz;
  if (kShears) {
    vec2 shear = sumOfPartialShears();
    force += shear.x * tile.X_PS.row0.xyz + shear.y * tile.X_PS.row1.xyz;
    torque += total.w * tile.X_PS.row2.xyz;
  }
  if (!FLAT) {
    vec3 origin = -(tile.X_PS.row0.xyz * tile.X_PS.row0.w + tile.X_PS.row1.xyz * tile.X_PS.row1.w +
                    tile.X_PS.row2.xyz * tile.X_PS.row2.w);  // of P in S
    torque += cross(origin, force);
  }
  uvec2 first = tile.first_taxel + taxels.first;
  bool none = taxels.count.x * taxels.count.y == 0;
  uvec4 window = none ? uvec4(0) : uvec4(first.x, first.x + taxels.count.x, first.y, first.y + taxels.count.y);
  if (kStoresTouched) writeRectangle(step.state, kTouchedTaxels, none ? uvec4(0) : uvec4(taxels.first, taxels.first + taxels.count).xzyw);
  if (NUM_ROWS == 0) window = uvec4(any_behind, 0, 0, 0);
  vec4 force_row = vec4(force, float(num_deep));
  vec4 torque_row = vec4(torque, kSumsSlopes ? total.w * tile.X_PS.row2.z * tile.X_PS.row2.z : total.x);
  for (uint k = gl_LocalInvocationIndex; k < 4; k += WORKGROUP) {  // one word per invocation
    tile_results[step.result].force[k] = force_row[k];
    tile_results[step.result].torque[k] = torque_row[k];
    tile_results[step.result].window[k] = window[k];
  }
}
