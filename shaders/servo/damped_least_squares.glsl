// Inverse velocity kinematics by damped least squares: the operations of src/control/damped_least_squares.cpp in the same order, hence the
// same bits. In: robot, loop_state. Arrays of a size that pipelines choose cannot be arguments.

double velocities[NUM_JOINTS];  // velocities of the joints, the result
uint columns[NUM_JOINTS];       // the joints that are free

struct Gram {
  double a[6][6];  // the first GRAM_SIZE rows and columns are used
};

// Factor L of a symmetric matrix L L^T, in place: the lower triangle, with the inverses of the diagonal on it. Returns whether the matrix
// is positive definite; entries of the factor are not finite if it is not.
bool factorize(inout Gram gram) {
  bool is_positive = true;
  for (uint j = 0; j < GRAM_SIZE; ++j) {
    double pivot = gram.a[j][j];
    for (uint k = 0; k < j; ++k) pivot -= gram.a[j][k] * gram.a[j][k];
    is_positive = is_positive && pivot > 0.0lf;
    gram.a[j][j] = 1.0lf / sqrt(pivot);
    for (uint i = j + 1; i < GRAM_SIZE; ++i) {
      double sum = gram.a[i][j];
      for (uint k = 0; k < j; ++k) sum -= gram.a[i][k] * gram.a[j][k];
      gram.a[i][j] = sum * gram.a[j][j];
    }
  }
  return is_positive;
}

// Solves L L^T x = b in place.
void solveFactorized(Gram factor, inout double x[6]) {
  for (uint i = 0; i < GRAM_SIZE; ++i) {
    for (uint k = 0; k < i; ++k) x[i] -= factor.a[i][k] * x[k];
    x[i] *= factor.a[i][i];
  }
  for (uint n = 0; n < GRAM_SIZE; ++n) {
    uint i = GRAM_SIZE - 1 - n;
    for (uint k = i + 1; k < GRAM_SIZE; ++k) x[i] -= factor.a[k][i] * x[k];
    x[i] *= factor.a[i][i];
  }
}

// Jacobi rotation that makes the entry (p, q) zero.
void rotate(inout Gram gram, uint p, uint q) {
  double entry = gram.a[p][q];
  double ratio = (gram.a[q][q] - gram.a[p][p]) / (2.0lf * entry);
  double size_of_tangent = 1.0lf / (abs(ratio) + sqrt(ratio * ratio + 1.0lf));
  double tangent = ratio < 0.0lf ? -size_of_tangent : size_of_tangent;
  double cosine = 1.0lf / sqrt(tangent * tangent + 1.0lf), sine = tangent * cosine;
  gram.a[p][p] -= tangent * entry;
  gram.a[q][q] += tangent * entry;
  gram.a[p][q] = gram.a[q][p] = 0.0lf;
  [[dont_unroll]] for (uint r = 0; r < GRAM_SIZE; ++r) {
    if (r == p || r == q) continue;
    double rp = gram.a[r][p], rq = gram.a[r][q];
    gram.a[r][p] = gram.a[p][r] = cosine * rp - sine * rq;
    gram.a[r][q] = gram.a[q][r] = sine * rp + cosine * rq;
  }
}

double smallestEigenvalue(Gram gram) {
  const uint kMaxSweeps = 20;
  const double kNegligible = 1e-17lf;  // share of the trace
  double trace = 0.0lf;
  [[dont_unroll]] for (uint j = 0; j < GRAM_SIZE; ++j) trace += gram.a[j][j];
  bool rotates = true;
  [[dont_unroll]] for (uint sweep = 0; rotates && sweep < kMaxSweeps; ++sweep) {
    rotates = false;
    [[dont_unroll]] for (uint q = 1; q < GRAM_SIZE; ++q) {
      [[dont_unroll]] for (uint p = 0; p < q; ++p) {
        if (!(abs(gram.a[p][q]) > kNegligible * trace)) continue;
        rotates = true;
        rotate(gram, p, q);
      }
    }
  }
  double smallest = gram.a[0][0];
  [[dont_unroll]] for (uint j = 1; j < GRAM_SIZE; ++j) smallest = gram.a[j][j] < smallest ? gram.a[j][j] : smallest;
  return smallest;
}

// Adds lambda^2 to the diagonal. Returns whether the matrix is singular.
bool damp(inout Gram gram) {
  double threshold = robot.singular.x;
  Gram shifted = gram;
  for (uint j = 0; j < GRAM_SIZE; ++j) shifted.a[j][j] -= threshold;
  if (factorize(shifted)) return false;
  double eigenvalue = smallestEigenvalue(gram);
  double smallest = eigenvalue > 0.0lf ? eigenvalue : 0.0lf;
  if (!(smallest < threshold)) return false;
  double damping = robot.singular.y * (1.0lf - smallest / threshold);
  for (uint j = 0; j < GRAM_SIZE; ++j) gram.a[j][j] += damping;
  return true;
}

uint selectedRow(uint row) { return robot.rows[row >> 2][row & 3]; }

// Entry of A, the selected rows and free columns of the Jacobian, or of its transpose.
double entryOf(uint i, bool transposed, uint a, uint b) {
  return readJoint(i, columns[transposed ? a : b], kJointJacobian + selectedRow(transposed ? b : a));
}

// Velocities that follow a twist; 0 for joints that are not free, those without their bit. Returns whether damping was applied.
bool leastSquares(uint i, double twist[6], uint free_joints) {
  uint num_columns = 0;
  for (uint j = 0; j < NUM_JOINTS; ++j) {
    velocities[j] = 0.0lf;
    if ((free_joints & (1u << j)) != 0) columns[num_columns++] = j;
  }
  if (num_columns == 0) return false;
  bool is_wide = num_columns >= TWIST_ROWS;
  uint used = is_wide ? TWIST_ROWS : num_columns;
  uint inner = is_wide ? num_columns : TWIST_ROWS;

  Gram gram;
  double solution[6];
  for (uint a = 0; a < GRAM_SIZE; ++a) {
    solution[a] = 0.0lf;
    for (uint b = 0; b < GRAM_SIZE; ++b) gram.a[a][b] = a == b ? 1.0lf : 0.0lf;
  }
  for (uint a = 0; a < used; ++a) {
    for (uint b = 0; b <= a; ++b) {
      double sum = 0.0lf;
      for (uint k = 0; k < inner; ++k) sum += entryOf(i, !is_wide, a, k) * entryOf(i, !is_wide, b, k);
      gram.a[a][b] = gram.a[b][a] = sum;
    }
    if (is_wide) {
      solution[a] = twist[selectedRow(a)];
    } else {
      for (uint k = 0; k < inner; ++k) solution[a] += entryOf(i, true, a, k) * twist[selectedRow(k)];
    }
  }

  bool is_singular = damp(gram);
  factorize(gram);
  solveFactorized(gram, solution);
  for (uint c = 0; c < num_columns; ++c) {
    if (is_wide) {
      double sum = 0.0lf;
      for (uint a = 0; a < used; ++a) sum += entryOf(i, false, a, c) * solution[a];
      velocities[columns[c]] = sum;
    } else {
      velocities[columns[c]] = solution[c];
    }
  }
  return is_singular;
}
