// What a step does to a skin that relaxes; its formulas are in relaxation.glsl.

float skin_settled, skin_gain;
vec4 skin_fade, skin_fade_rest;  // e in two floats: 1 - e is what matters where steps are short
vec4 skin_growth;                // c

// `is_new`: the skin was never pressed.
void loadSkinStep(bool is_new) {
  skin_settled = step_record.relaxation.x;
  skin_gain = is_new ? 1.0 : step_record.relaxation.y;
  skin_fade = step_record.relaxation_fade;
  skin_fade_rest = step_record.relaxation_fade_rest;
  skin_growth = is_new ? step_record.relaxation_fraction : step_record.relaxation_growth;
}
