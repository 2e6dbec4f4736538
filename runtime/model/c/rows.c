/* A generated function at many rows of its arguments; an argument whose step is zero stays. */
EXPORTED int ltcgear_rows(function *f, whole rows, const double *x, whole x_step, const double *s, whole s_step,
                          const double *p, whole p_step, double *y, whole y_step) {
  for (whole k = 0; k < rows; ++k) {
    f->res[0] = y + k * y_step;
    if (call(f, x + k * x_step, s + k * s_step, p + k * p_step)) return 1;
  }
  return 0;
}
