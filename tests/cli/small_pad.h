// A sensor file of 2 x 3 taxels that read 1000 counts / N, ten bits, and the columns of a table of its images.
#pragma once

#include <string>

namespace taxelsim::testing {

inline const std::string kSmallPad = R"(format_version: 1
name: small pad
num_rows: 2
num_cols: 3
pitch_mm: 2
samples_per_taxel: 2
frame_rate: 0
skin: {thickness_mm: 2, law: winkler, normal_contact_stiffness: 1e8, normal_exponent: 1, normal_damping: 0}
psf: {gaussian: {sigma: 0.5, size: 3}, normalization: per_source}
readout:
  curve: {counts_per_newton: 1000}
  trigger: 0
  adc_bits: 10
  saturation: 1000
)";

inline const std::string kSmallPadColumns = "r0_c0,r0_c1,r0_c2,r1_c0,r1_c1,r1_c2\n";

}  // namespace taxelsim::testing
