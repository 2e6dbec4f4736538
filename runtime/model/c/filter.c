/* Sums over points of a motion: filtered samples, and means. */

enum { CHUNK = 64, TILE = 64, MOST_REACH = 16 }; /* points whose shares wait; columns whose rows stay near; bound */

/* A point's shares in the rows that its filter reaches: the first of them, and on which side of the start it is. */
typedef struct {
  whole row;
  double side;
  const double *y;
  double share[2 * MOST_REACH];
} sharing;

/* Find the shares of a point, ``ahead`` samples after the first row. The table holds the filter: for each part of a sample,
 * its values at the rows about the point. */
static void find_shares(whole reach, whole fine, const double *table, double ahead, double weight, sharing *s) {
  double first = ceil(ahead - (double)reach), place = (first - (ahead - (double)reach)) * (double)fine;
  whole low = (whole)smaller(place, (double)fine - 1);
  double part = place - (double)low;
  const double *one = table + 2 * reach * low, *two = one + 2 * reach;
  for (whole j = 0; j < 2 * reach; ++j) s->share[j] = weight * (one[j] + part * (two[j] - one[j]));
  s->row = (whole)first;
}

/* A point's share in a row, 0 where it does not reach it. */
static double share_in(const sharing *s, whole reach, whole row) {
  whole j = row - s->row;
  return j >= 0 && j < 2 * reach ? s->side * s->share[j] : 0;
}

/* Add what two points share to rows, some columns of them. Each row gets the first one's share before the second's, as if
 * they came one by one; where one of them does not reach, 0 is added. */
static void add_pair(const sharing *one, const sharing *two, whole reach, whole width, whole left, whole columns,
                     double *rows) {
  const double *restrict y = one->y + left, *restrict z = two->y + left;
  const whole low = one->row < two->row ? one->row : two->row, high = one->row < two->row ? two->row : one->row;
  for (whole row = low < 0 ? 0 : low; row < high + 2 * reach; ++row) {
    const double first = share_in(one, reach, row), second = share_in(two, reach, row);
    double *restrict to = rows + row * width + left;
    for (whole i = 0; i < columns; ++i) to[i] = (to[i] + first * y[i]) + second * z[i];
  }
}

/* Add what points share to rows, a tile of columns after the other, so that the rows of a tile stay near. */
static void add_shares(whole count, const sharing *all, whole width, whole reach, double *rows, double *weights) {
  const sharing none = {.row = all[count - 1].row, .y = all[count - 1].y};
  for (whole left = 0; left < width; left += TILE) {
    const whole columns = left + TILE < width ? TILE : width - left;
    for (whole k = 0; k < count; k += 2)
      add_pair(all + k, k + 1 < count ? all + k + 1 : &none, reach, width, left, columns, rows);
  }
  for (whole k = 0; k < count; ++k)
    for (whole j = all[k].row < 0 ? -all[k].row : 0; j < 2 * reach; ++j) weights[all[k].row + j] += all[k].share[j];
}

/* Add the shares of points to rows, the first of which is row ``first``: ``at`` is each one's place [samples]. Where the
 * motion begins it is continued by its image through the first point, so that neither value nor slope jumps there. */
EXPORTED void ltcgear_filter(whole points, whole width, whole reach, whole fine, const double *table, const double *at,
                             const double *weight, const double *y, whole first, double *rows, double *weights) {
  sharing all[CHUNK + 1];
  whole count = 0;
  for (whole k = 0; k < points; ++k) {
    find_shares(reach, fine, table, at[k] - (double)first, weight[k], all + count);
    all[count].side = 1, all[count].y = y + k * width;
    ++count;
    if (at[k] < (double)reach && first <= 0) {
      find_shares(reach, fine, table, -at[k] - (double)first, weight[k], all + count);
      all[count].side = -1, all[count].y = y + k * width;
      ++count;
    }
    if (count >= CHUNK || k == points - 1) add_shares(count, all, width, reach, rows, weights), count = 0;
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
