/* Kalman prediction and update, and what a tick of the filter needs beside them, in a fixed order of sums.

   Every sum runs over its index in rising order and is rounded after each multiplication and each addition.
   Compiled without contraction (-ffp-contract=off) and without -ffast-math, IEEE doubles then give the same bits
   on every machine. Inner loops run over independent sums side by side, so that they vectorise without
   reordering. Matrices are C-contiguous doubles by rows; P is symmetric, and stays exactly so. */

#define PY_SSIZE_T_CLEAN
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <Python.h>
#include <numpy/arrayobject.h>
#include <math.h>
#include <string.h>

#ifndef SOURCE_SHA256
#define SOURCE_SHA256 ""
#endif

#define MOST_STATES 64
#define MOST_MEASURED 6
#define MOST_TURNS 4
#define MOST_KICKS 3
#define MOST_MAPPED 512 /* entries of a matrix that a map goes to */
#define MOST_MAPS 3
#define MOVING 6 /* attitude and rate: the rows of the transition that are not the identity's */

/* Compiled for wider registers too, which the processor's kind chooses: as many sums at a time as fit in, each to
   the same bits. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

/* row (n) gains the sum of each of these factors times its row of B (count,n); fresh: from zero. Count and fresh are
   known when this is compiled: the sums of some columns stay in registers */
static inline __attribute__((always_inline)) void add_rows(const int count, const int fresh, int n,
                                                          const double *restrict factors, const double *restrict B,
                                                          double *restrict row)
{
    for (int c = 0; c < n; c++) {
        double sum = fresh ? 0.0 : row[c];
        for (int j = 0; j < count; j++) sum += factors[j] * B[(size_t)j * n + c];
        row[c] = sum;
    }
}

/* out (m,n) = A (m,k) B (k,n) */
WIDE static void multiply(int m, int k, int n, const double *restrict A, const double *restrict B,
                          double *restrict out)
{
    for (int i = 0; i < m; i++, A += k, out += n) {
        const int few = k % 4; /* the first ones, so that the others come by four */
        int j = few;
        if (few == 1) add_rows(1, 1, n, A, B, out);
        else if (few == 2) add_rows(2, 1, n, A, B, out);
        else if (few == 3) add_rows(3, 1, n, A, B, out);
        else if (k > 0) add_rows(4, 1, n, A, B, out), j = 4;
        else memset(out, 0, sizeof(double) * n);
        for (; j + 8 <= k; j += 8) add_rows(8, 0, n, A + j, B + (size_t)j * n, out);
        if (j < k) add_rows(4, 0, n, A + j, B + (size_t)j * n, out);
    }
}

/* out (n,m) = M^T, M being (m,n) */
static void transpose(int m, int n, const double *restrict M, double *restrict out)
{
    for (int i = 0; i < m; i++)
        for (int c = 0; c < n; c++) out[(size_t)c * m + i] = M[(size_t)i * n + c];
}

/* half the sum of a matrix and its transpose, in its place */
static void symmetrise(int n, double *out)
{
    for (int r = 1; r < n; r++) {
        double *left = out + (size_t)r * n, *above = out + r;
        for (int c = 0; c < r; c++, left++, above += n) *left = *above = 0.5 * (*left + *above);
    }
}

/* out = F P F^T + Q, F being the first k rows of the transition (k,n), the others those of the identity; to the
   block of the rate in Q, v v^T is added for each of these kicks v (kicks,3) */
WIDE static void predict(int n, int k, int kicks, const double *restrict P, const double *restrict F,
                         const double *restrict Q, const double *restrict v, double *restrict out)
{
    double rows[MOST_STATES * MOST_STATES], columns[MOST_STATES * MOST_STATES], block[MOST_STATES * MOST_STATES];
    multiply(k, n, n, F, P, rows);
    transpose(k, n, F, columns);
    multiply(k, n, k, rows, columns, block);
    for (int i = 0; i < k; i++) {
        for (int j = 0; j <= i; j++) {
            double noise = Q[i * n + j];
            if (j >= 3 && i < 6)
                for (int kick = 0; kick < kicks; kick++) noise += v[3 * kick + i - 3] * v[3 * kick + j - 3];
            out[i * n + j] = out[j * n + i] = block[i * k + j] + noise;
        }
        for (int c = k; c < n; c++) out[i * n + c] = out[c * n + i] = rows[i * n + c] + Q[i * n + c];
    }
    for (size_t i = k, at = i * n; i < (size_t)n; i++, at += n)
        for (size_t c = at + k; c < at + n; c++) out[c] = P[c] + Q[c];
}

/* Gauss-Jordan with partial pivoting; 1: M (m,m) is singular */
static int invert(int m, const double *M, double *inverse)
{
    double a[MOST_STATES * MOST_STATES];
    for (int i = 0; i < m * m; i++) { a[i] = M[i]; inverse[i] = 0.0; }
    for (int i = 0; i < m; i++) inverse[i * m + i] = 1.0;
    for (int c = 0; c < m; c++) {
        int pivot = c;
        for (int r = c + 1; r < m; r++)
            if (fabs(a[r * m + c]) > fabs(a[pivot * m + c])) pivot = r;
        if (a[pivot * m + c] == 0.0) return 1;
        if (pivot != c)
            for (int k = 0; k < m; k++) {
                double kept = a[pivot * m + k];
                a[pivot * m + k] = a[c * m + k];
                a[c * m + k] = kept;
                kept = inverse[pivot * m + k];
                inverse[pivot * m + k] = inverse[c * m + k];
                inverse[c * m + k] = kept;
            }
        const double factor = 1.0 / a[c * m + c];
        for (int k = 0; k < m; k++) { a[c * m + k] *= factor; inverse[c * m + k] *= factor; }
        for (int r = 0; r < m; r++) {
            if (r == c) continue;
            const double part = a[r * m + c];
            for (int k = 0; k < m; k++) {
                a[r * m + k] -= part * a[c * m + k];
                inverse[r * m + k] -= part * inverse[c * m + k];
            }
        }
    }
    return 0;
}

/* S = H P H^T + R, K = P H^T S^-1 with zero rows from first to last, x = K y, nis = y^T S^-1 y,
   out = (1 - K H) P (1 - K H)^T + K R K^T, expanded from the left, then from the right.
   Columns of H that are zero, of states that are not measured, are left out. All (n) columns of K^T lie side by
   side in gain (m,n), and those of other matrices whose transpose is computed. 1: S is singular */
static inline __attribute__((always_inline)) int
update_few(int n, const int m, const double *restrict P, const double *restrict H, const double *restrict R,
           const double *restrict y, int first, int last, double *restrict out, double *restrict x,
           double *restrict gain, double *restrict S, double *restrict SI, double *restrict nis)
{
    double h[MOST_MEASURED * MOST_STATES], rows[MOST_STATES * MOST_STATES], columns[MOST_STATES * MOST_MEASURED];
    double ph[MOST_MEASURED * MOST_STATES], changes[MOST_MEASURED * MOST_STATES], weighed[MOST_MEASURED];
    int places[MOST_STATES], count = 0;
    for (int c = 0; c < n; c++) {
        int shows = 0;
        for (int i = 0; i < m; i++) shows |= H[i * n + c] != 0.0;
        if (shows) places[count++] = c;
    }
    for (int j = 0; j < count; j++) {
        for (int i = 0; i < m; i++) h[i * count + j] = H[i * n + places[j]];
        memcpy(rows + (size_t)j * n, P + (size_t)places[j] * n, sizeof(double) * n);
    }
    multiply(m, count, n, h, rows, ph); /* (P H^T)^T, as P is symmetric */
    for (int j = 0; j < count; j++)
        for (int i = 0; i < m; i++) columns[j * m + i] = ph[i * n + places[j]];
    multiply(m, count, m, h, columns, S);
    for (int i = 0; i < m * m; i++) S[i] += R[i];
    if (invert(m, S, SI)) return 1;
    multiply(m, m, 1, SI, y, weighed);
    multiply(1, m, 1, y, weighed, nis);
    transpose(m, m, SI, columns);
    multiply(m, m, n, columns, ph, gain);
    for (int i = 0; i < m; i++)
        for (int c = first; c < last; c++) gain[i * n + c] = 0.0;
    multiply(1, m, n, y, gain, x);
    for (int r = 0; r < n; r++) { /* (P - K H P)^T */
        const double *before = P + (size_t)r * n;
        double *row = out + (size_t)r * n, factors[MOST_MEASURED];
        for (int i = 0; i < m; i++) factors[i] = ph[i * n + r];
        for (int c = 0; c < n; c++) {
            double left = before[c];
            for (int i = 0; i < m; i++) left -= gain[(size_t)i * n + c] * factors[i];
            row[c] = left;
        }
    }
    for (int j = 0; j < count; j++) memcpy(rows + (size_t)j * n, out + (size_t)places[j] * n, sizeof(double) * n);
    multiply(m, count, n, h, rows, ph); /* ((P - K H P) H^T)^T */
    transpose(m, m, R, columns);
    multiply(m, m, n, columns, gain, changes);
    for (int c = 0; c < m * n; c++) changes[c] -= ph[c]; /* (K R - (P - K H P) H^T)^T */
    for (int r = 0; r < n; r++) {
        double *row = out + (size_t)r * n, factors[MOST_MEASURED];
        for (int i = 0; i < m; i++) factors[i] = gain[i * n + r];
        for (int c = 0; c < n; c++) {
            double right = row[c];
            for (int i = 0; i < m; i++) right += changes[(size_t)i * n + c] * factors[i];
            row[c] = right;
        }
    }
    symmetrise(n, out);
    return 0;
}

WIDE static int update(int n, int m, const double *P, const double *H, const double *R, const double *y, int first,
                  int last, double *out, double *x, double *gain, double *S, double *SI, double *nis)
{
    switch (m) { /* the loops over the measured numbers are unrolled for those that fly */
    case 1: return update_few(n, 1, P, H, R, y, first, last, out, x, gain, S, SI, nis);
    case 3: return update_few(n, 3, P, H, R, y, first, last, out, x, gain, S, SI, nis);
    case 6: return update_few(n, 6, P, H, R, y, first, last, out, x, gain, S, SI, nis);
    default: return update_few(n, m, P, H, R, y, first, last, out, x, gain, S, SI, nis);
    }
}

/* out (r,n) = constant; its first w columns gain the sum of each number times its row of a map (k,r w), the sums
   of several maps being added first */
typedef struct { int k; const double *numbers, *rows; } Map;

WIDE static void linear(int r, int n, int w, int maps, const Map *map, const double *restrict constant,
                   double *restrict sum, double *restrict part, double *restrict out)
{
    memcpy(out, constant, sizeof(double) * r * n);
    for (int at = 0; at < maps; at++) {
        double *to = at ? part : sum;
        for (int c = 0; c < r * w; c++) to[c] = 0.0;
        for (int j = 0; j < map[at].k; j++) {
            const double factor = map[at].numbers[j], *row = map[at].rows + (size_t)j * r * w;
            if (factor == 0.0) continue;
            for (int c = 0; c < r * w; c++) to[c] += factor * row[c];
        }
        if (at)
            for (int c = 0; c < r * w; c++) sum[c] += part[c];
    }
    for (int i = 0; i < r; i++)
        for (int c = 0; c < w; c++) out[i * n + c] += sum[i * w + c];
}

/* out (3,n) gains [a x] in three of its columns */
static void add_skew(int n, const double *a, double *out)
{
    out[1] -= a[2], out[2] += a[1];
    out[n] += a[2], out[n + 2] -= a[0];
    out[2 * n] -= a[1], out[2 * n + 1] += a[0];
}

/* H of sensors that see directions u (sensors,3), out (3 sensors,n): by attitude, rate, and where there are such
   places, age, misalignment and scale errors of each; all else as constant */
static void sensitivity(int n, int sensors, const double *constant, const double *u, const double *omega,
                        const double *age, const int *places, double *out)
{
    memcpy(out, constant, sizeof(double) * 3 * sensors * n);
    for (int sensor = 0; sensor < sensors; sensor++, u += 3, age++, places += 3, out += 3 * n) {
        const double w[3] = {*age * omega[0], *age * omega[1], *age * omega[2]};
        const double along = u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
        const double by_attitude[3][3] = {
            {w[0] * u[0] - along, w[0] * u[1] - u[2], w[0] * u[2] + u[1]},
            {w[1] * u[0] + u[2], w[1] * u[1] - along, w[1] * u[2] - u[0]},
            {w[2] * u[0] - u[1], w[2] * u[1] + u[0], w[2] * u[2] - along},
        };
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < 3; c++) out[i * n + c] += by_attitude[i][c];
        if (places[0] >= 0) {
            const double since[3] = {-*age * u[0], -*age * u[1], -*age * u[2]};
            add_skew(n, since, out + 3);
            out[places[0]] += omega[1] * u[2] - omega[2] * u[1];
            out[n + places[0]] += omega[2] * u[0] - omega[0] * u[2];
            out[2 * n + places[0]] += omega[0] * u[1] - omega[1] * u[0];
        }
        if (places[1] >= 0) add_skew(n, u, out + places[1]);
        for (int i = 0; i < 3 && places[2] >= 0; i++) out[i * n + places[2] + i] += u[i];
    }
}

/* The rows of attitude and rate of 1 + A h, out (6,n): [turn x], turn being -h omega; h domega/dt by all, J^-1 h
   (3,3) times the torque's derivative by the first w numbers (3,w); all else, and of the attitude, as constant */
WIDE static void system_rows(int n, int w, const double *restrict constant, const double *restrict turn,
                        const double *restrict inverse_h, const double *restrict torque, double *restrict out)
{
    double rate[3 * MOST_STATES];
    memcpy(out, constant, sizeof(double) * MOVING * n);
    const double skew[9] = {0.0, -turn[2], turn[1], turn[2], 0.0, -turn[0], -turn[1], turn[0], 0.0};
    multiply(3, 3, w, inverse_h, torque, rate);
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 3; c++) out[i * n + c] = skew[3 * i + c];
        for (int c = 0; c < w; c++) out[(3 + i) * n + c] = rate[i * w + c];
    }
    for (int i = 0; i < MOVING; i++) out[i * n + i] += 1.0;
}

/* The rows of attitude and rate of exp(A h), out (6,n), from those of 1 + A h, to second or to fourth order */
WIDE static void series(int n, int order, const double *restrict linear, double *restrict out)
{
    double moving[MOVING * MOVING], change[MOVING * MOST_STATES], sums[MOVING * MOST_STATES];
    memcpy(change, linear, sizeof(double) * MOVING * n);
    for (int i = 0; i < MOVING; i++)
        for (int c = 0; c < MOVING; c++) {
            if (order > 2 && c == i) change[i * n + c] -= 1.0;
            moving[i * MOVING + c] = change[i * n + c];
            if (order == 2) change[i * n + c] = c == i ? 1.0 : 0.0;
        }
    if (order == 2) { /* (1 + A h)^2: the mean of it and 1 is the series */
        multiply(MOVING, MOVING, n, moving, linear, out);
        for (int c = 0; c < MOVING * n; c++) out[c] = (out[c] + change[c]) * 0.5;
        return;
    }
    memcpy(out, change, sizeof(double) * MOVING * n);
    for (; order > 1; order--) {
        multiply(MOVING, MOVING, n, moving, out, sums);
        for (int c = 0; c < MOVING * n; c++) out[c] = change[c] + sums[c] / order;
    }
    for (int i = 0; i < MOVING; i++) out[i * n + i] += 1.0;
}

/* A trace over an update: t = H effect, its last column y; sums += t^T S^-1 t, effect -= K t, gain (m,n) being
   K^T. Returned to sums_out (k,k) and out (n,k) */
WIDE static void trace_update(int n, int m, int k, const double *restrict effect, const double *restrict sums,
                              const double *restrict y, const double *restrict H, const double *restrict gain,
                              const double *restrict SI, double *restrict out, double *restrict sums_out)
{
    double t[MOST_MEASURED * MOST_STATES], weighed[MOST_MEASURED * MOST_STATES];
    double columns[MOST_STATES * MOST_MEASURED];
    multiply(m, n, k, H, effect, t);
    for (int i = 0; i < m; i++) t[i * k + k - 1] = y[i];
    multiply(m, m, k, SI, t, weighed);
    transpose(m, k, t, columns);
    multiply(k, m, k, columns, weighed, sums_out);
    for (int c = 0; c < k * k; c++) sums_out[c] = sums[c] + sums_out[c];
    transpose(m, n, gain, columns);
    multiply(n, m, k, columns, t, out);
    for (int c = 0; c < n * k; c++) out[c] = effect[c] - out[c];
}

/* s_yy - s_y^T (s + 1)^-1 s_y, s_y being the last column of the sums (k,k), s those before; NaN if it is singular */
static double unexplained(int k, const double *restrict sums)
{
    double M[MOST_STATES * MOST_STATES], weights[MOST_STATES * MOST_STATES];
    double evidence[MOST_STATES], weighed[MOST_STATES], explained;
    const int n = k - 1;
    if (n < 1) return sums[0];
    for (int i = 0; i < n; i++) {
        for (int c = 0; c < n; c++) M[i * n + c] = sums[i * k + c] + (i == c ? 1.0 : 0.0);
        evidence[i] = sums[i * k + n];
    }
    if (invert(n, M, weights)) return NAN;
    multiply(n, n, 1, weights, evidence, weighed);
    multiply(1, n, 1, evidence, weighed, &explained);
    return sums[n * k + n] - explained;
}

/* out = T P T^T, T = 1 + D W (n,n): D (m,k) in the rows from first on is linear in the error e there, by moving
   (m,m k), its last column times a factor; W (k,n) */
WIDE static void turn_along(int n, int m, int k, int first, const double *restrict P, const double *restrict e,
                       double factor, const double *restrict W, const double *restrict moving,
                       double *restrict out)
{
    double D[MOST_STATES * MOST_TURNS], transposed[MOST_TURNS * MOST_STATES], half[MOST_STATES * MOST_TURNS];
    double known[MOST_TURNS * MOST_STATES], own[MOST_TURNS * MOST_TURNS], change[MOST_STATES * MOST_STATES];
    multiply(1, m, m * k, e + first, moving, D);
    for (int i = 0; i < m; i++) D[i * k + k - 1] *= factor;
    transpose(m, k, D, transposed);
    for (int i = 0; i < k; i++)
        for (int c = 0; c < n; c++) half[c * k + i] = 0.5 * W[i * n + c];
    multiply(k, n, n, W, P, known); /* W P + half of W P W^T D^T: half of the terms, twice of which are all */
    multiply(k, n, k, known, half, own);
    multiply(k, k, m, own, transposed, change);
    for (int i = 0; i < k; i++)
        for (int c = 0; c < m; c++) known[i * n + first + c] += change[i * m + c];
    multiply(m, k, n, D, known, change);
    const size_t from = (size_t)first * n, to = from + (size_t)m * n;
    for (size_t c = 0; c < from; c++) out[c] = P[c];
    for (size_t c = from; c < to; c++) out[c] = P[c] + 2.0 * change[c - from];
    for (size_t c = to; c < (size_t)n * n; c++) out[c] = P[c];
    symmetrise(n, out);
}

/* out = T P T^T, T = 1 + d e^T, d (6) in the first rows, e being half of 1 at the place first and at the next */
WIDE static void move_along(int n, int first, const double *restrict P, const double *restrict d,
                            double *restrict out)
{
    double mean[MOST_STATES];
    for (int c = 0; c < n; c++) mean[c] = 0.5 * (P[first * n + c] + P[(first + 1) * n + c]);
    const double variance = 0.5 * (mean[first] + mean[first + 1]);
    memcpy(out, P, sizeof(double) * n * n);
    for (int i = 0; i < MOVING; i++) {
        for (int c = 0; c < MOVING; c++) {
            const double own = d[i] * mean[c] + 0.5 * variance * (d[i] * d[c]);
            const double other = d[c] * mean[i] + 0.5 * variance * (d[c] * d[i]);
            out[i * n + c] += own + other;
        }
        for (int c = MOVING; c < n; c++) {
            out[i * n + c] += d[i] * mean[c];
            out[c * n + i] += d[i] * mean[c];
        }
    }
}

/* States from first to last decay by a factor: out = D P D, their variances gaining 1 - keep^2 of those in P0 */
WIDE static void fade(int n, int first, int last, double keep, const double *restrict P, const double *restrict P0,
                 double *restrict out)
{
    memcpy(out, P, sizeof(double) * n * n);
    for (int i = first; i < last; i++)
        for (int c = 0; c < n; c++) out[i * n + c] *= keep;
    for (int r = 0; r < n; r++)
        for (int c = first; c < last; c++) out[r * n + c] *= keep;
    for (int i = first; i < last; i++) out[i * n + i] += (1.0 - keep * keep) * P0[i * n + i];
}

/* out = T P T^T, T = 1 + change (k,n) in the rows of these places */
WIDE static void shear(int n, int k, const double *restrict P, const double *restrict change, const int *places,
                  double *restrict out)
{
    double rows[MOST_STATES * MOST_STATES], columns[MOST_STATES * MOST_STATES];
    multiply(k, n, n, change, P, rows);
    memcpy(out, P, sizeof(double) * n * n);
    for (int i = 0; i < k; i++)
        for (int c = 0; c < n; c++) out[places[i] * n + c] += rows[i * n + c];
    transpose(n, n, out, columns);
    multiply(k, n, n, change, columns, rows);
    for (int r = 0; r < n; r++)
        for (int i = 0; i < k; i++) out[r * n + places[i]] += rows[i * n + r];
    symmetrise(n, out);
}

/* Rigid bodies side by side, (.., n): what acts on all of them, radius direction and field, eci, gravity 3 mu/r^3,
   momentum of a wheel; and on each, dipole and torque (3,n), inertia and what a torque gives (3,3,n), body axes */
typedef struct {
    double e1[3], b[3], gravity, wheel[3];
    const double *dipole, *torque, *inertia, *response;
} Bodies;

static inline __attribute__((always_inline)) void cross(const double *a, const double *b, double *out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline __attribute__((always_inline)) void in_body(const double *q, const double *d, double *out)
{
    double crossed[3];
    const double along = d[0] * q[1] + d[1] * q[2] + d[2] * q[3];
    const double square = q[0] * q[0] - (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    cross(q + 1, d, crossed);
    for (int i = 0; i < 3; i++) out[i] = square * d[i] + 2.0 * (along * q[i + 1] - q[0] * crossed[i]);
}

/* dq/dt = 1/2 q (0, w), J dw/dt = (m + d) x b + 3 mu/r^3 e1 x J e1 - w x (J w + h) + t, out (7), of one of them */
static inline __attribute__((always_inline)) void
body_rates(const Bodies *acting, const double *J, const double *response, const double *dipole, const double *torque,
           const double *x, double *out)
{
    const double *w = x + 4;
    double e1[3], b[3], pull[3], back[3], je1[3], jw[3], by_gravity[3], by_rate[3], by_field[3], total[3];
    double half[3], crossed[3];
    in_body(x, acting->e1, e1);
    in_body(x, acting->b, b);
    for (int i = 0; i < 3; i++) {
        je1[i] = J[3 * i] * e1[0] + J[3 * i + 1] * e1[1] + J[3 * i + 2] * e1[2];
        jw[i] = J[3 * i] * w[0] + J[3 * i + 1] * w[1] + J[3 * i + 2] * w[2] + acting->wheel[i];
        pull[i] = acting->gravity * e1[i];
        back[i] = -w[i];
        half[i] = 0.5 * w[i];
    }
    cross(pull, je1, by_gravity);
    cross(back, jw, by_rate);
    cross(dipole, b, by_field);
    for (int i = 0; i < 3; i++) total[i] = by_gravity[i] + by_rate[i] + by_field[i] + torque[i];
    cross(x + 1, half, crossed);
    out[0] = -(x[1] * half[0] + x[2] * half[1] + x[3] * half[2]);
    for (int i = 0; i < 3; i++) {
        out[i + 1] = x[0] * half[i] + crossed[i];
        out[i + 4] = response[3 * i] * total[0] + response[3 * i + 1] * total[1] + response[3 * i + 2] * total[2];
    }
}

/* Attitude and rate of each body, (7,n), after a step by the fourth-order Runge-Kutta method */
WIDE static void move_bodies(size_t n, double h, const Bodies *acting, const double *restrict x,
                             double *restrict out)
{
    const Bodies all = *acting;
    for (size_t c = 0; c < n; c++) {
        double J[9], response[9], dipole[3], torque[3], start[7], mid[7], k1[7], k2[7], k3[7], k4[7];
        for (int i = 0; i < 9; i++) J[i] = all.inertia[i * n + c], response[i] = all.response[i * n + c];
        for (int i = 0; i < 3; i++) dipole[i] = all.dipole[i * n + c], torque[i] = all.torque[i * n + c];
        for (int i = 0; i < 7; i++) start[i] = x[i * n + c];
        body_rates(&all, J, response, dipole, torque, start, k1);
        for (int i = 0; i < 7; i++) mid[i] = start[i] + 0.5 * h * k1[i];
        body_rates(&all, J, response, dipole, torque, mid, k2);
        for (int i = 0; i < 7; i++) mid[i] = start[i] + 0.5 * h * k2[i];
        body_rates(&all, J, response, dipole, torque, mid, k3);
        for (int i = 0; i < 7; i++) mid[i] = start[i] + h * k3[i];
        body_rates(&all, J, response, dipole, torque, mid, k4);
        for (int i = 0; i < 7; i++) mid[i] = start[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        const double length = sqrt(mid[0] * mid[0] + mid[1] * mid[1] + mid[2] * mid[2] + mid[3] * mid[3]);
        for (int i = 0; i < 4; i++) out[i * n + c] = mid[i] / length;
        for (int i = 4; i < 7; i++) out[i * n + c] = mid[i];
    }
}

/* The sum of the variances; infinite where one is negative, or one of the first few is zero */
static double total_variance(int n, int uncertain, const double *P)
{
    double total = 0.0;
    for (int i = 0; i < n; i++) {
        const double variance = P[i * n + i];
        if (variance < 0.0 || (variance == 0.0 && i < uncertain)) return INFINITY;
        total += variance;
    }
    return total;
}

/* The arrays that a call holds while it computes, and numbers of its tuples. */
#define MOST_HELD 12
typedef struct { int count; PyArrayObject *array[MOST_HELD]; } Held;

static void release(Held *held)
{
    while (held->count) Py_DECREF(held->array[--held->count]);
}

/* A matrix (rows, columns) of doubles, contiguous; -1: any number of these. NULL with an exception otherwise. */
static PyArrayObject *matrix(Held *held, PyObject *given, npy_intp rows, npy_intp columns, const char *name)
{
    PyArrayObject *array = (PyArrayObject *)given;
    if (PyArray_CheckExact(given) && PyArray_TYPE(array) == NPY_DOUBLE && PyArray_ISCARRAY_RO(array))
        Py_INCREF(array);
    else if ((array = (PyArrayObject *)PyArray_FROM_OTF(given, NPY_DOUBLE, NPY_ARRAY_IN_ARRAY)) == NULL)
        return NULL;
    held->array[held->count++] = array;
    if (PyArray_NDIM(array) == 2 && (rows < 0 || PyArray_DIM(array, 0) == rows) &&
        (columns < 0 || PyArray_DIM(array, 1) == columns))
        return array;
    return (PyArrayObject *)PyErr_Format(PyExc_ValueError, "%s is not a matrix of this size", name);
}

/* A square one of at most this many rows */
static PyArrayObject *square(Held *held, PyObject *given, npy_intp most, const char *name)
{
    PyArrayObject *array = matrix(held, given, -1, -1, name);
    if (array == NULL || (PyArray_DIM(array, 0) == PyArray_DIM(array, 1) && PyArray_DIM(array, 0) <= most))
        return array;
    return (PyArrayObject *)PyErr_Format(PyExc_ValueError, "%s is not square, or of more than %d rows", name, (int)most);
}

/* One that is returned, not initialised */
static double *result(Held *held, npy_intp rows, npy_intp columns)
{
    npy_intp shape[2] = {rows, columns};
    PyArrayObject *array = (PyArrayObject *)PyArray_SimpleNew(2, shape, NPY_DOUBLE);
    if (array == NULL) return NULL;
    held->array[held->count++] = array;
    return PyArray_DATA(array);
}

/* The last one made, which is returned; NULL if there was an error */
static PyObject *returned(Held *held, double *made)
{
    PyObject *last = made == NULL ? NULL : (PyObject *)held->array[--held->count];
    release(held);
    return last;
}

/* The numbers of a tuple, and of the tuples in it: how many, or -1 with an exception */
static int tuple(PyObject *given, int least, int most, double *numbers, const char *name)
{
    int count = 0;
    if (!PyTuple_Check(given)) {
        PyErr_Format(PyExc_TypeError, "%s: no tuple of numbers", name);
        return -1;
    }
    for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(given); i++) {
        PyObject *part = PyTuple_GET_ITEM(given, i);
        if (PyTuple_Check(part)) {
            const int more = tuple(part, 0, most - count, numbers + count, name);
            if (more < 0) return -1;
            count += more;
        } else if (count < most) {
            numbers[count++] = PyFloat_AsDouble(part);
        } else {
            count = most + 1;
            break;
        }
    }
    if (PyErr_Occurred()) return -1;
    if (count >= least && count <= most) return count;
    PyErr_Format(PyExc_ValueError, "%s: not %d to %d numbers", name, least, most);
    return -1;
}

/* Numbers as a tuple; every step of them is taken */
static PyObject *as_tuple(const double *numbers, int count, int step)
{
    PyObject *made = PyTuple_New(count);
    for (int i = 0; made != NULL && i < count; i++) {
        PyObject *number = PyFloat_FromDouble(numbers[(size_t)i * step]);
        if (number == NULL) Py_CLEAR(made);
        else PyTuple_SET_ITEM(made, i, number);
    }
    return made;
}

static int takes(Py_ssize_t count, Py_ssize_t wanted, const char *what)
{
    if (count != wanted) PyErr_Format(PyExc_TypeError, "it takes %s", what);
    return count == wanted;
}

#define DATA(array) ((const double *)PyArray_DATA(array))
#define ROWS(array) ((int)PyArray_DIM(array, 0))
#define COLUMNS(array) ((int)PyArray_DIM(array, 1))
#define FUNCTION(name) static PyObject *py_##name(PyObject *self, PyObject *const *given, Py_ssize_t count)

FUNCTION(predict)
{
    Held held = {0};
    PyArrayObject *P, *F, *Q;
    double v[3 * MOST_KICKS], *out = NULL;
    int kicks;
    if (takes(count, 4, "P, F, Q and kicks") && (kicks = tuple(given[3], 0, 3 * MOST_KICKS, v, "kicks")) >= 0 &&
        (P = square(&held, given[0], MOST_STATES, "P")) != NULL &&
        (F = matrix(&held, given[1], -1, ROWS(P), "F")) != NULL &&
        (Q = matrix(&held, given[2], ROWS(P), ROWS(P), "Q")) != NULL) {
        if (ROWS(F) > ROWS(P) || kicks % 3)
            PyErr_SetString(PyExc_ValueError, "F has more rows than columns, or a kick less than three numbers");
        else if ((out = result(&held, ROWS(P), ROWS(P))) != NULL)
            predict(ROWS(P), ROWS(F), kicks / 3, DATA(P), DATA(F), DATA(Q), v, out);
    }
    return returned(&held, out);
}

FUNCTION(update)
{
    Held held = {0};
    PyArrayObject *P, *R, *H, *effect = NULL, *sums = NULL;
    PyObject *found = NULL, *made[2] = {Py_None, Py_None};
    double y[MOST_MEASURED], x[MOST_STATES], gain[MOST_MEASURED * MOST_STATES], nis, *after, *carried, *summed;
    double S[MOST_MEASURED * MOST_MEASURED], SI[MOST_MEASURED * MOST_MEASURED];
    if (!takes(count, 8, "P, y, R, H, first, last, effect and sums")) return NULL;
    const int m = tuple(given[1], 1, MOST_MEASURED, y, "the innovation");
    const long first = m < 0 ? -1 : PyLong_AsLong(given[4]), last = m < 0 ? -1 : PyLong_AsLong(given[5]);
    if (PyErr_Occurred() || (P = square(&held, given[0], MOST_STATES, "P")) == NULL) goto done;
    const int n = ROWS(P);
    if (first < 0 || first > last || last > n) {
        PyErr_SetString(PyExc_ValueError, "the considered states are none of P");
        goto done;
    }
    if ((R = matrix(&held, given[2], m, m, "R")) == NULL || (H = matrix(&held, given[3], m, n, "H")) == NULL)
        goto done;
    if (given[6] != Py_None && ((sums = square(&held, given[7], MOST_STATES, "the sums")) == NULL ||
                                (effect = matrix(&held, given[6], n, ROWS(sums), "the effect")) == NULL))
        goto done;
    if ((after = result(&held, n, n)) == NULL) goto done;
    PyObject *covariance = (PyObject *)held.array[held.count - 1];
    if (update(n, m, DATA(P), DATA(H), DATA(R), y, (int)first, (int)last, after, x, gain, S, SI, &nis)) {
        found = Py_NewRef(Py_None);
        goto done;
    }
    if (effect != NULL) {
        const int k = ROWS(sums);
        if ((carried = result(&held, n, k)) == NULL || (summed = result(&held, k, k)) == NULL) goto done;
        made[0] = (PyObject *)held.array[held.count - 2], made[1] = (PyObject *)held.array[held.count - 1];
        trace_update(n, m, k, DATA(effect), DATA(sums), y, DATA(H), gain, SI, carried, summed);
    }
    found = Py_BuildValue("NONdOO", as_tuple(x, n, 1), covariance, as_tuple(S, m, m + 1), nis, made[0], made[1]);
done:
    release(&held);
    return found;
}

FUNCTION(product)
{
    Held held = {0};
    PyArrayObject *A, *B;
    double *out = NULL;
    if (takes(count, 2, "A and B") && (A = matrix(&held, given[0], -1, -1, "A")) != NULL &&
        (B = matrix(&held, given[1], COLUMNS(A), -1, "B")) != NULL &&
        (out = result(&held, ROWS(A), COLUMNS(B))) != NULL)
        multiply(ROWS(A), COLUMNS(A), COLUMNS(B), DATA(A), DATA(B), out);
    return returned(&held, out);
}

FUNCTION(inverse)
{
    Held held = {0};
    PyArrayObject *M;
    double *out = NULL;
    if (takes(count, 1, "a matrix") && (M = square(&held, given[0], MOST_STATES, "M")) != NULL &&
        (out = result(&held, ROWS(M), ROWS(M))) != NULL && invert(ROWS(M), DATA(M), out))
        for (int i = 0; i < ROWS(M) * ROWS(M); i++) out[i] = NAN;
    return returned(&held, out);
}

FUNCTION(linear)
{
    Held held = {0};
    PyArrayObject *constant, *rows;
    Map map[MOST_MAPS];
    double numbers[MOST_MAPS][MOST_STATES], sums[2][MOST_MAPPED], *out = NULL;
    const int maps = (int)(count / 2);
    int width = 0;
    if (!takes(count, 2 * (maps < 1 ? 1 : maps > MOST_MAPS ? MOST_MAPS : maps) + 1, "a constant, numbers, map"))
        return NULL;
    if ((constant = matrix(&held, given[0], -1, -1, "the constant")) == NULL) goto done;
    for (int at = 0; at < maps; at++) {
        map[at].k = tuple(given[1 + 2 * at], 0, MOST_STATES, numbers[at], "what is mapped");
        if (map[at].k < 0 || (rows = matrix(&held, given[2 + 2 * at], map[at].k, -1, "a map")) == NULL) goto done;
        map[at].numbers = numbers[at];
        map[at].rows = DATA(rows);
        if (at == 0 && ROWS(constant) > 0) width = COLUMNS(rows) / ROWS(constant);
        if (width * ROWS(constant) != COLUMNS(rows) || width > COLUMNS(constant) || COLUMNS(rows) > MOST_MAPPED) {
            PyErr_SetString(PyExc_ValueError, "a map is not to the first columns of the constant");
            goto done;
        }
    }
    if ((out = result(&held, ROWS(constant), COLUMNS(constant))) != NULL)
        linear(ROWS(constant), COLUMNS(constant), width, maps, map, DATA(constant), sums[0], sums[1], out);
done:
    return returned(&held, out);
}

FUNCTION(system_rows)
{
    Held held = {0};
    PyArrayObject *constant, *torque;
    double turn[3], inverse_h[9], *out = NULL;
    if (takes(count, 4, "constant, turn, inverse and torque") && tuple(given[1], 3, 3, turn, "the turn") == 3 &&
        tuple(given[2], 9, 9, inverse_h, "the inverse") == 9 &&
        (constant = matrix(&held, given[0], MOVING, -1, "the constant")) != NULL &&
        (torque = matrix(&held, given[3], 3, -1, "the torque")) != NULL) {
        if (COLUMNS(torque) > COLUMNS(constant) || COLUMNS(constant) > MOST_STATES)
            PyErr_SetString(PyExc_ValueError, "the torque is not by the first states");
        else if ((out = result(&held, MOVING, COLUMNS(constant))) != NULL)
            system_rows(COLUMNS(constant), COLUMNS(torque), DATA(constant), turn, inverse_h, DATA(torque), out);
    }
    return returned(&held, out);
}

FUNCTION(series)
{
    Held held = {0};
    PyArrayObject *given_rows;
    double *out = NULL;
    const long order = count == 2 ? PyLong_AsLong(given[1]) : 0;
    if (takes(count, 2, "rows and order") && !PyErr_Occurred() &&
        (given_rows = matrix(&held, given[0], MOVING, -1, "the rows")) != NULL) {
        if (COLUMNS(given_rows) > MOST_STATES || (order != 2 && order != 4))
            PyErr_SetString(PyExc_ValueError, "more states than allowed, or an order other than 2 and 4");
        else if ((out = result(&held, MOVING, COLUMNS(given_rows))) != NULL)
            series(COLUMNS(given_rows), (int)order, DATA(given_rows), out);
    }
    return returned(&held, out);
}

FUNCTION(sensitivity)
{
    Held held = {0};
    PyArrayObject *constant;
    double u[MOST_MEASURED], omega[3], ages[MOST_MEASURED], numbers[MOST_MEASURED], *out = NULL;
    int places[MOST_MEASURED];
    if (!takes(count, 5, "constant, directions, omega, ages and places")) return NULL;
    const int m = tuple(given[1], 3, MOST_MEASURED, u, "the directions");
    if (m < 0 || tuple(given[2], 3, 3, omega, "the rate") < 0 || tuple(given[3], m / 3, m / 3, ages, "the ages") < 0 ||
        tuple(given[4], m, m, numbers, "the places") < 0 ||
        (constant = matrix(&held, given[0], m, -1, "the constant")) == NULL)
        return returned(&held, NULL);
    int fits = m % 3 == 0 && COLUMNS(constant) >= MOVING;
    for (int i = 0; i < m; i++) {
        fits &= numbers[i] >= -1.0 && numbers[i] <= COLUMNS(constant) - (i % 3 ? 3 : 1);
        places[i] = fits ? (int)numbers[i] : -1;
    }
    if (!fits) PyErr_SetString(PyExc_ValueError, "the places are none of H's states");
    else if ((out = result(&held, m, COLUMNS(constant))) != NULL)
        sensitivity(COLUMNS(constant), m / 3, DATA(constant), u, omega, ages, places, out);
    return returned(&held, out);
}

FUNCTION(diagonal)
{
    Held held = {0};
    PyArrayObject *P;
    PyObject *found = NULL;
    if (takes(count, 1, "a matrix") && (P = square(&held, given[0], MOST_STATES, "P")) != NULL)
        found = as_tuple(DATA(P), ROWS(P), ROWS(P) + 1);
    release(&held);
    return found;
}

FUNCTION(total_variance)
{
    Held held = {0};
    PyArrayObject *P;
    PyObject *found = NULL;
    const long uncertain = count == 2 ? PyLong_AsLong(given[1]) : 0;
    if (takes(count, 2, "P, and how many are uncertain") && !PyErr_Occurred() &&
        (P = square(&held, given[0], MOST_STATES, "P")) != NULL)
        found = PyFloat_FromDouble(total_variance(ROWS(P), (int)uncertain, DATA(P)));
    release(&held);
    return found;
}

FUNCTION(largest_variance)
{
    Held held = {0};
    PyArrayObject *P;
    PyObject *found = NULL;
    if (!takes(count, 3, "P, first and last")) return NULL;
    const long first = PyLong_AsLong(given[1]), last = PyLong_AsLong(given[2]);
    if (!PyErr_Occurred() && (P = square(&held, given[0], MOST_STATES, "P")) != NULL) {
        if (first < 0 || first >= last || last > ROWS(P)) {
            PyErr_SetString(PyExc_ValueError, "these are none of P's states");
        } else {
            double most = DATA(P)[first * ROWS(P) + first];
            for (long i = first + 1; i < last; i++)
                if (DATA(P)[i * ROWS(P) + i] > most) most = DATA(P)[i * ROWS(P) + i];
            found = PyFloat_FromDouble(most);
        }
    }
    release(&held);
    return found;
}

FUNCTION(carry_trace)
{
    Held held = {0};
    PyArrayObject *effect, *F;
    double *out = NULL;
    if (takes(count, 2, "effect and F") && (effect = matrix(&held, given[0], -1, -1, "the effect")) != NULL &&
        (F = matrix(&held, given[1], -1, ROWS(effect), "F")) != NULL) {
        if (ROWS(F) > ROWS(effect))
            PyErr_SetString(PyExc_ValueError, "F has more rows than columns");
        else if ((out = result(&held, ROWS(effect), COLUMNS(effect))) != NULL) {
            memcpy(out, DATA(effect), sizeof(double) * ROWS(effect) * COLUMNS(effect));
            multiply(ROWS(F), ROWS(effect), COLUMNS(effect), DATA(F), DATA(effect), out);
        }
    }
    return returned(&held, out);
}

FUNCTION(move_bodies)
{
    Held held = {0};
    PyArrayObject *x, *dipole, *torque, *inertia, *response;
    Bodies acting;
    double numbers[10], *out = NULL;
    if (!takes(count, 7, "x, step, what acts, dipoles, torques, inertias and responses")) return NULL;
    const double h = PyFloat_AsDouble(given[1]);
    if (!PyErr_Occurred() && tuple(given[2], 10, 10, numbers, "what acts") > 0 &&
        (x = matrix(&held, given[0], 7, -1, "x")) != NULL &&
        (dipole = matrix(&held, given[3], 3, COLUMNS(x), "the dipoles")) != NULL &&
        (torque = matrix(&held, given[4], 3, COLUMNS(x), "the torques")) != NULL &&
        (inertia = matrix(&held, given[5], 9, COLUMNS(x), "the inertias")) != NULL &&
        (response = matrix(&held, given[6], 9, COLUMNS(x), "the responses")) != NULL &&
        (out = result(&held, 7, COLUMNS(x))) != NULL) {
        memcpy(acting.e1, numbers, sizeof(acting.e1));
        memcpy(acting.b, numbers + 3, sizeof(acting.b));
        memcpy(acting.wheel, numbers + 6, sizeof(acting.wheel));
        acting.gravity = numbers[9];
        acting.dipole = DATA(dipole), acting.torque = DATA(torque);
        acting.inertia = DATA(inertia), acting.response = DATA(response);
        move_bodies(COLUMNS(x), h, &acting, DATA(x), out);
    }
    return returned(&held, out);
}

FUNCTION(unexplained)
{
    Held held = {0};
    PyArrayObject *sums;
    PyObject *found = NULL;
    if (takes(count, 1, "sums") && (sums = square(&held, given[0], MOST_STATES, "the sums")) != NULL) {
        if (ROWS(sums) < 1) PyErr_SetString(PyExc_ValueError, "there are no sums");
        else found = PyFloat_FromDouble(unexplained(ROWS(sums), DATA(sums)));
    }
    release(&held);
    return found;
}

FUNCTION(turn_along)
{
    Held held = {0};
    PyArrayObject *P, *W, *moving;
    double e[MOST_STATES], *out = NULL;
    if (!takes(count, 6, "P, error, first, factor, W and the map")) return NULL;
    const long first = PyLong_AsLong(given[2]);
    const double factor = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(given[3]);
    if (!PyErr_Occurred() && (P = square(&held, given[0], MOST_STATES, "P")) != NULL &&
        tuple(given[1], ROWS(P), ROWS(P), e, "the error") >= 0 &&
        (W = matrix(&held, given[4], -1, ROWS(P), "W")) != NULL &&
        (moving = matrix(&held, given[5], -1, -1, "the map")) != NULL) {
        const int m = ROWS(moving), k = ROWS(W);
        if (first < 0 || first + m > ROWS(P) || k > MOST_TURNS || COLUMNS(moving) != m * k)
            PyErr_SetString(PyExc_ValueError, "the map is not to the directions of P");
        else if ((out = result(&held, ROWS(P), ROWS(P))) != NULL)
            turn_along(ROWS(P), m, k, (int)first, DATA(P), e, factor, DATA(W), DATA(moving), out);
    }
    return returned(&held, out);
}

FUNCTION(move_along)
{
    Held held = {0};
    PyArrayObject *P;
    double d[MOVING], *out = NULL;
    if (!takes(count, 3, "P, the change and the first place")) return NULL;
    const long first = PyLong_AsLong(given[2]);
    if (!PyErr_Occurred() && tuple(given[1], MOVING, MOVING, d, "the change") > 0 &&
        (P = square(&held, given[0], MOST_STATES, "P")) != NULL) {
        if (first < MOVING || first + 2 > ROWS(P)) PyErr_SetString(PyExc_ValueError, "the places are none of P's states");
        else if ((out = result(&held, ROWS(P), ROWS(P))) != NULL)
            move_along(ROWS(P), (int)first, DATA(P), d, out);
    }
    return returned(&held, out);
}

FUNCTION(fade)
{
    Held held = {0};
    PyArrayObject *P, *P0;
    double *out = NULL;
    if (!takes(count, 5, "P, P a priori, first, last and what is left")) return NULL;
    const long first = PyLong_AsLong(given[2]), last = PyLong_AsLong(given[3]);
    const double keep = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(given[4]);
    if (!PyErr_Occurred() && (P = square(&held, given[0], MOST_STATES, "P")) != NULL &&
        (P0 = matrix(&held, given[1], ROWS(P), ROWS(P), "P a priori")) != NULL) {
        if (first < 0 || first > last || last > ROWS(P))
            PyErr_SetString(PyExc_ValueError, "the states that decay are none of P");
        else if ((out = result(&held, ROWS(P), ROWS(P))) != NULL)
            fade(ROWS(P), (int)first, (int)last, keep, DATA(P), DATA(P0), out);
    }
    return returned(&held, out);
}

FUNCTION(shear)
{
    Held held = {0};
    PyArrayObject *P, *change;
    double numbers[MOST_STATES], *out = NULL;
    int places[MOST_STATES], k;
    if (takes(count, 3, "P, change and places") && (k = tuple(given[2], 0, MOST_STATES, numbers, "the places")) >= 0 &&
        (P = square(&held, given[0], MOST_STATES, "P")) != NULL &&
        (change = matrix(&held, given[1], k, ROWS(P), "the change")) != NULL) {
        for (int i = 0; i < k; i++)
            if (!(numbers[i] >= 0.0 && numbers[i] < ROWS(P))) {
                PyErr_SetString(PyExc_ValueError, "the places are none of P's states");
                return returned(&held, NULL);
            } else {
                places[i] = (int)numbers[i];
            }
        if ((out = result(&held, ROWS(P), ROWS(P))) != NULL)
            shear(ROWS(P), k, DATA(P), DATA(change), places, out);
    }
    return returned(&held, out);
}

#define METHOD(name, words) {#name, (PyCFunction)(void (*)(void))py_##name, METH_FASTCALL, words}

static PyMethodDef methods[] = {
    METHOD(predict, "predict(P, F, Q, kicks) -> P"),
    METHOD(update, "update(P, y, R, H, first, last, effect, sums) -> (x, P, diagonal of S, y^T S^-1 y, effect, sums); "
                   "None: S is singular"),
    METHOD(product, "product(A, B) -> A B"),
    METHOD(inverse, "inverse(M) -> M^-1, NaN where M is singular"),
    METHOD(linear, "linear(constant, numbers, map, ...) -> constant + numbers * map, in its first columns"),
    METHOD(system_rows, "system_rows(constant, -h omega, h J^-1, torque by state) -> rows of 1 + A h"),
    METHOD(series, "series(1 + A h, 2 or 4) -> exp(A h) to this order"),
    METHOD(sensitivity, "sensitivity(constant, directions, omega, ages, places) -> H"),
    METHOD(diagonal, "diagonal(M) -> its numbers"),
    METHOD(total_variance, "total_variance(P, k) -> the sum of the variances; inf: one is negative, or of the first k zero"),
    METHOD(largest_variance, "largest_variance(P, first, last) -> that of these states"),
    METHOD(carry_trace, "carry_trace(effect, F) -> effect"),
    METHOD(move_bodies, "move_bodies(x, h, what acts, dipoles, torques, inertias, responses) -> x"),
    METHOD(unexplained, "unexplained(sums) -> what no deviation explains, NaN of damaged sums"),
    METHOD(turn_along, "turn_along(P, error, first, factor, W, map) -> P"),
    METHOD(move_along, "move_along(P, change, first) -> P"),
    METHOD(fade, "fade(P, P a priori, first, last, what is left) -> P"),
    METHOD(shear, "shear(P, change, places) -> P"),
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_kalman_kernel", "The filter's algebra in a fixed order of sums.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__kalman_kernel(void)
{
    import_array();
    PyObject *made = PyModule_Create(&module);
    if (made != NULL && PyModule_AddStringConstant(made, "SOURCE_SHA256", SOURCE_SHA256) < 0) Py_CLEAR(made);
    return made;
}
