// The sensor of a model: patches, tiles, taxels, readout. Constant after the model is made.
#ifndef TAXELSIM_SHADERS_SHARED_SENSOR_H
#define TAXELSIM_SHADERS_SHARED_SENSOR_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// A planar grid of taxels.
struct PatchRecord {
  vec4 row0, row1, row2;  // X_PS: rows of (R_PS | p), m
  uvec4 grid;             // rows, cols, first taxel, 0
  vec4 spacing;           // sample spacing along x and y of P, m; sample area, m^2; largest depth under the skin that is seen, m
};

// A rectangle of whole taxels that one workgroup computes.
struct TileRecord {
  uvec4 place;  // patch, first row, first col, 0
  uvec4 size;   // rows, cols, 0, 0
};

// One taxel.
struct TaxelRecord {
  vec4 chart;    // position in C, m; area, m^2
  vec4 readout;  // gain; trigger, N; patch; z of the place in `reception`
  // What the point spread brings to the taxel if every taxel has the same force: the mean place it comes from, in C, x and y, m; the
  // trigger again, so that a fit takes one fetch; its sum over that force, times the calibrated gain.
  vec4 reception;
};

TAXELSIM_CONSTANT kMaxCurvePieces = 16u;

// Readout of the whole sensor. Force-to-output curve: a polynomial, or straight pieces.
struct SensorRecord {
  vec4 curve0;                         // coefficients 1 to 4, counts/N^k for coefficient k
  vec4 curve1;                         // coefficient 5, 0, 0, 0
  vec4 curve_pieces[kMaxCurvePieces];  // start of each straight piece, N and counts; its slope, counts/N; inverse slope, N/counts
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  vec4 hysteresis_strength;  // of up to four elements
  vec4 hysteresis_width;     // of up to four elements, N
  vec4 creep_fraction;       // of up to four terms
};

// A plane in which moments are computed: that of a patch (C is P), or xy of S (C is S), which is the last one.
struct PlaneRecord {
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  uvec4 grid;   // rows; cols; first taxel; a taxel at least this far from all silent taxels belongs to a wide face, in taxels
  vec4 pitch;   // along x and y of C, m; the larger of both, m; taxel force per pressure on a wide face, N/Pa
  vec4 spread;  // what the point spread and the taxel size add to second moments: xx, xy, yy of C, m^2; 0
  vec4 even;    // second moments of the plane's taxels under even pressure: xx, xy, yy of C, m^2; 0
};

// The mask of the law deformation_mask on grids: RobWorkSim's, integrated over a taxel and over its neighbours along sides and diagonals.
TAXELSIM_FLOAT kMaskMiddle = 0.52464f, kMaskSide = 0.10387f, kMaskCorner = 0.01497f;

// Columns of the image pass for a sensor that is not one grid patch, or whose point spread is not a kernel.
TAXELSIM_CONSTANT kListCols = 16u;

TAXELSIM_LAYOUT_END

#endif
