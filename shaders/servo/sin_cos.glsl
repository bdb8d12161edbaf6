// Sine and cosine of an angle (rad) up to kLargestReducedAngle: the operations of src/base/sin_cos.h in the same order, hence the same
// bits.
void sinCos(double angle, out double sine_out, out double cosine_out) {
  const double kRound = 6755399441055744.0lf;
  const double kTwoOverPi = 0.6366197723675814lf;
  const double kFirst = 1.5707963267341256lf, kSecond = 6.077100506303966e-11lf, kThird = 2.0222662487959506e-21lf;
  double quarters = (angle * kTwoOverPi + kRound) - kRound;
  double near = angle - quarters * kFirst;
  double nearer = near - quarters * kSecond;
  double left_over = (near - nearer) - quarters * kSecond;
  double last = quarters * kThird - left_over;
  double x = nearer - last;
  double low = (nearer - x) - last;
  double z = x * x;
  double sine_sum =
      -1.0lf / 6.0lf +
      z * (1.0lf / 120.0lf + z * (-1.0lf / 5040.0lf +
                                  z * (1.0lf / 362880.0lf + z * (-1.0lf / 39916800.0lf +
                                                                 z * (1.0lf / 6227020800.0lf + z * (-1.0lf / 1307674368000.0lf +
                                                                                                    z * (1.0lf / 355687428096000.0lf)))))));
  double cosine_sum =
      1.0lf / 24.0lf +
      z * (-1.0lf / 720.0lf +
           z * (1.0lf / 40320.0lf + z * (-1.0lf / 3628800.0lf +
                                         z * (1.0lf / 479001600.0lf + z * (-1.0lf / 87178291200.0lf + z * (1.0lf / 20922789888000.0lf))))));
  double half_z = 0.5lf * z;
  double most = 1.0lf - half_z;
  double sine = x + (x * z * sine_sum + low * most);
  double cosine = most + (((1.0lf - most) - half_z) + (z * z * cosine_sum - x * low));

  int quadrant = int(quarters) & 3;
  bool swaps = (quadrant & 1) != 0;
  double s = swaps ? cosine : sine, c = swaps ? sine : cosine;
  sine_out = quadrant >= 2 ? -s : s;
  cosine_out = quadrant == 1 || quadrant == 2 ? -c : c;
}
