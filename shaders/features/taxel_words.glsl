// Where forces[], taxel_regions[] and region_sums[] have the words of an instance: one per taxel, padded so that they can be fetched four
// at a time.
const uint kTaxelFours = (NUM_TAXELS + 3u) / 4u;
