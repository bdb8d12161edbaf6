// Sine and cosine of an angle (rad) up to kLargestReducedAngle: the operations of src/base/sin_cos.h in the same order, hence the same bits.
void sinCos(double angle, out double sine_out, out double cosine_out) {
  const double kRound = 6755399441055744.0lf;
  const double kTwoOverPi = 6.36619772367581382433e-01lf;
  const double kFirst = 1.57079632673412561417e+00lf, kSecond = 6.07710050630396597660e-11lf, kThird = 2.02226624879595063154e-21lf;
  double quarters = (angle * kTwoOverPi + kRound) - kRound;
  double t = angle - quarters * kFirst;
  double second = quarters * kSecond;
  double r = t - second;
  double w = quarters * kThird - ((t - r) - second);
  double x = r - w;
  double y = (r - x) - w;

  double z = x * x;
  double sine_terms =
      8.33333333332248946124e-03lf +
      z * (-1.98412698298579493134e-04lf +
           z * (2.75573137070700676789e-06lf + z * (-2.50507602534068634195e-08lf + z * 1.58969099521155010221e-10lf)));
  double v = z * x;
  double sine = x - ((z * (0.5lf * y - v * sine_terms) - y) - v * -1.66666666666666324348e-01lf);
  double cosine_terms =
      z * (4.16666666666666019037e-02lf +
           z * (-1.38888888888741095749e-03lf +
                z * (2.48015872894767294178e-05lf +
                     z * (-2.75573143513906633035e-07lf + z * (2.08757232129817482790e-09lf + z * -1.13596475577881948265e-11lf)))));
  double half_square = 0.5lf * z;
  double rest = 1.0lf - half_square;
  double cosine = rest + (((1.0lf - rest) - half_square) + (z * cosine_terms - x * y));

  int quadrant = int(quarters) & 3;
  bool swaps = (quadrant & 1) != 0;
  double s = swaps ? cosine : sine, c = swaps ? sine : cosine;
  sine_out = quadrant >= 2 ? -s : s;
  cosine_out = quadrant == 1 || quadrant == 2 ? -c : c;
}
