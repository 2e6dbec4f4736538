/* Sums over points of a motion: filtered samples, and means. */

/* Add the share of a point, ``ahead`` samples after the first row, in all rows that its filter reaches. The table holds
 * the filter: for each part of a sample, its values at the rows about the point. */
static void spread(whole width, whole reach, whole fine, const double *restrict table, double ahead, double weight,
                   double side, const double *restrict y, double *restrict rows, double *restrict weights) {
  double first = ceil(ahead - (double)reach), place = (first - (ahead - (double)reach)) * (double)fine;
  whole low = (whole)smaller(place, (double)fine - 1), row = (whole)first;
  double part = place - (double)low;
  const double *one = table + 2 * reach * low, *two = one + 2 * reach;
  for (whole j = 0; j < 2 * reach; ++j) {
    double share = weight * (one[j] + part * (two[j] - one[j])), signed_share = side * share;
    if (row + j < 0) continue;
    double *restrict to = rows + (row + j) * width;
    for (whole i = 0; i < width; ++i) to[i] += signed_share * y[i];
    weights[row + j] += share;
  }
}

/* Add the shares of points to rows, the first of which is row ``first``: ``at`` is each one's place [samples]. Where the
 * motion begins it is continued by its image through the first point, so that neither value nor slope jumps there. */
EXPORTED void ltcgear_filter(whole points, whole width, whole reach, whole fine, const double *table, const double *at,
                             const double *weight, const double *y, whole first, double *rows, double *weights) {
  for (whole k = 0; k < points; ++k) {
    const double *now = y + k * width;
    spread(width, reach, fine, table, at[k] - (double)first, weight[k], 1.0, now, rows, weights);
    if (at[k] < (double)reach && first <= 0)
      spread(width, reach, fine, table, -at[k] - (double)first, weight[k], -1.0, now, rows, weights);
  }
}

/* Add points to the sums of their weights, of values and of squares, and to the extremes; five rows of ``width``. */
EXPORTED void ltcgear_sums(whole points, whole width, const double *weight, const double *y, double *sums) {
  double *restrict whole_weight = sums, *restrict one = sums + width, *restrict two = one + width;
  double *restrict low = two + width, *restrict high = low + width;
  for (whole k = 0; k < points; ++k) {
    const double *restrict now = y + k * width;
    const double share = weight[k];
    for (whole i = 0; i < width; ++i) {
      const double value = now[i];
      whole_weight[i] += share;
      one[i] += share * value;
      two[i] += share * value * value;
      low[i] = smaller(value, low[i]);
      high[i] = larger(value, high[i]);
    }
  }
}
