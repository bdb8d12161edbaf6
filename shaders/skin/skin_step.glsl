// Coefficients of one time step of a skin that relaxes, from StepRecord; the formulas are in skin/sample_states.glsl. Dimensionless.

struct SkinStep {
  float settled;  // equilibrium stiffness
  float gain;     // stiffness against strain that is added in this step
  vec4 fade;      // e of each term in two floats, since 1 - e is what matters in short steps
  vec4 fade_rest;
  vec4 growth;  // c of each term
  bool is_new;  // the first step: the skin was never pressed
};

SkinStep skinStep(bool is_new) {
  SkinStep step;
  step.settled = step_record.relaxation.x;
  step.gain = is_new ? 1.0 : step_record.relaxation.y;
  step.fade = step_record.relaxation_fade;
  step.fade_rest = step_record.relaxation_fade_rest;
  step.growth = is_new ? step_record.relaxation_fraction : step_record.relaxation_growth;
  step.is_new = is_new;
  return step;
}

SkinStep noSkinStep() { return SkinStep(1.0, 1.0, vec4(0), vec4(0), vec4(0), true); }
