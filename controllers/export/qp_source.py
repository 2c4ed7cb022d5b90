"""A dual active-set method in C, of fixed size.

    min |z|^2 / 2 + sum_i w (v_i + c v_i^2 / 2),  lower - v <= M z <= upper + v

v_i >= 0 is the excess over a soft row; a hard row has none. Multipliers mu >= 0 start from zero, where z = 0 is the
optimum without rows. The row that is broken most joins with a growing multiplier, while the rows in the set stay at
their bounds; a multiplier that falls to zero leaves; that of a soft row which grows past w is that of a row which
yields, mu = w + w c v. Each step raises the dual cost, so that no set comes again but by rounding. The method is that
of "A numerically stable dual method for solving strictly convex quadratic programs" (Goldfarb and Idnani 1983), with
the set's Gram matrix factorised row by row: rows before the first that left or yielded stay as they are. At the end
the multipliers of the set are solved for once more, so that rounding of the steps does not add up, and every row is
looked at: a plan that breaks one which does not yield is none.

A program is its sizes, M row by row, which rows are soft, and w / 2 with 1 / (c w / 2). Rounds are at most ten for each
row and unknown; what needs more counts as a failure, and the law says what it does then.
"""

from __future__ import annotations

PROGRAM = """typedef struct {
    int rows, nz;
    const REAL *M; /* (rows, nz) */
    const char *soft; /* (rows), 0: none */
    REAL price, compliance;
} NAME_program;
"""

QP = r"""/* Cholesky factor of a packed symmetric matrix by rows, in place, from row `first` on; 0: not definite */
static int NAME_factor(int first, int n, REAL *K)
{
    int i, j, k;
    for (i = first; i < n; i++) {
        REAL *row = K + i * (i + 1) / 2;
        for (j = 0; j <= i; j++) {
            const REAL *other = K + j * (j + 1) / 2;
            REAL sum = row[j];
            for (k = 0; k < j; k++) sum -= row[k] * other[k];
            if (j < i) row[j] = sum / other[j];
            else if (sum > NAME_DEFINITE * row[i]) row[i] = SQRT(sum);
            else return 0;
        }
    }
    return 1;
}

/* x := K^-1 x */
static void NAME_substitute(int n, const REAL *K, REAL *x)
{
    int i, k;
    for (i = 0; i < n; i++) {
        for (k = 0; k < i; k++) x[i] -= K[i * (i + 1) / 2 + k] * x[k];
        x[i] /= K[i * (i + 1) / 2 + i];
    }
    for (i = n - 1; i >= 0; i--) {
        for (k = i + 1; k < n; k++) x[i] -= K[k * (k + 1) / 2 + i] * x[k];
        x[i] /= K[i * (i + 1) / 2 + i];
    }
}

static REAL NAME_dot(int n, const REAL *a, const REAL *b)
{
    int k;
    REAL sum = 0;
    for (k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

/* factor of the Gram matrix of the rows in the set, with signs and what yields; 0 where they depend on each other */
static int NAME_gram(NAME_work *w, const NAME_program *q)
{
    const int nz = q->nz;
    const int first = w->known;
    int i, j;
    for (i = first; i < w->count; i++)
        for (j = 0; j <= i; j++) {
            const int a = w->set[i], b = w->set[j];
            REAL sum = NAME_dot(nz, q->M + a * nz, q->M + b * nz) * (REAL)(w->side[a] * w->side[b]);
            if (i == j && w->yields[a]) sum += q->compliance;
            w->K[i * (i + 1) / 2 + j] = sum;
        }
    w->known = w->count;
    return NAME_factor(first, w->count, w->K);
}

static void NAME_drop(NAME_work *w, int at)
{
    int i;
    w->side[w->set[at]] = 0;
    w->yields[w->set[at]] = 0;
    w->mu[w->set[at]] = 0;
    for (i = at; i + 1 < w->count; i++) w->set[i] = w->set[i + 1];
    w->count--;
    if (w->known > at) w->known = at;
}

/* z where all rows hold as far as they can; 1: found, 0: no z keeps the hard rows, -1: not found in so many rounds */
static int NAME_qp(NAME_work *w, const NAME_program *q, const REAL *lower, const REAL *upper, int all_hard, REAL *z)
{
    const REAL *const M = q->M;
    const int nz = q->nz, rows = q->rows, rounds = 10 * (rows + nz);
    int i, k, round, p = -1;
    w->count = w->known = 0; /* rows in the set, and of those in the factor */
    for (i = 0; i < rows; i++) {
        w->mu[i] = 0;
        w->side[i] = 0;
        w->yields[i] = 0;
    }
    for (k = 0; k < nz; k++) z[k] = 0;
    for (round = 0; round < rounds; round++) {
        REAL gap, slope, step, own, *const d = w->d;
        int event = 0, at = -1;
        if (p < 0) {
            REAL worst = NAME_TOLERANCE;
            for (i = 0; i < rows; i++) {
                REAL value;
                if (w->side[i]) continue;
                value = NAME_dot(nz, M + i * nz, z);
                if (value - upper[i] > worst) {
                    worst = value - upper[i];
                    p = i;
                    at = 1;
                }
                if (lower[i] - value > worst) {
                    worst = lower[i] - value;
                    p = i;
                    at = -1;
                }
            }
            if (p < 0) break;
            w->side[p] = at;
        }
        if (!NAME_gram(w, q)) return -1;
        for (i = 0; i < w->count; i++) {
            const int j = w->set[i];
            d[i] = -NAME_dot(nz, M + j * nz, M + p * nz) * (REAL)(w->side[j] * w->side[p]);
        }
        NAME_substitute(w->count, w->K, d);
        for (k = 0; k < nz; k++) w->dz[k] = -M[p * nz + k] * (REAL)w->side[p];
        for (i = 0; i < w->count; i++)
            for (k = 0; k < nz; k++)
                w->dz[k] -= d[i] * M[w->set[i] * nz + k] * (REAL)w->side[w->set[i]];
        own = NAME_dot(nz, M + p * nz, M + p * nz);
        slope = -NAME_dot(nz, M + p * nz, w->dz) * (REAL)w->side[p];
        gap = w->side[p] > 0 ? NAME_dot(nz, M + p * nz, z) - upper[p]
                             : lower[p] - NAME_dot(nz, M + p * nz, z);
        if (slope < NAME_DEFINITE * own) slope = 0;
        if (w->yields[p]) {
            slope += q->compliance;
            gap -= q->compliance * (w->mu[p] - q->price);
        }
        step = slope > 0 ? (gap > 0 ? gap / slope : 0) : INFINITY;
        if (!all_hard && q->soft[p] && !w->yields[p] && q->price - w->mu[p] < step) {
            step = q->price - w->mu[p];
            event = 1; /* p yields from here on */
        }
        for (i = 0; i < w->count; i++) {
            const int j = w->set[i], soft = !all_hard && q->soft[j];
            REAL room = INFINITY;
            int what = 0;
            if (d[i] < 0) {
                room = (w->mu[j] - (w->yields[j] ? q->price : 0)) / -d[i];
                what = w->yields[j] ? 2 : 3; /* firm again, or leaves */
            } else if (d[i] > 0 && soft && !w->yields[j]) {
                room = (q->price - w->mu[j]) / d[i];
                what = 4; /* yields */
            }
            if (room < step) {
                step = room > 0 ? room : 0;
                event = what;
                at = i;
            }
        }
        if (!(step < INFINITY)) return 0;
        for (i = 0; i < w->count; i++) w->mu[w->set[i]] += step * d[i];
        w->mu[p] += step;
        for (k = 0; k < nz; k++) z[k] += step * w->dz[k];
        if (event == 0) {
            w->set[w->count++] = p;
            p = -1;
        } else if (event == 1) w->yields[p] = 1;
        else if (event == 3) NAME_drop(w, at);
        else {
            w->yields[w->set[at]] = event == 4;
            if (w->known > at) w->known = at;
        }
    }
    if (round == rounds || !NAME_gram(w, q)) return -1;
    for (i = 0; i < w->count; i++) {
        const int j = w->set[i];
        w->d[i] = w->side[j] > 0 ? -upper[j] : lower[j];
        if (w->yields[j]) w->d[i] += q->compliance * q->price;
    }
    NAME_substitute(w->count, w->K, w->d);
    for (k = 0; k < nz; k++) z[k] = 0;
    for (i = 0; i < w->count; i++)
        for (k = 0; k < nz; k++)
            z[k] -= w->d[i] * M[w->set[i] * nz + k] * (REAL)w->side[w->set[i]];
    for (i = 0; i < rows; i++) { /* rows that nearly depend on each other can have let a row go */
        const REAL value = NAME_dot(nz, M + i * nz, z);
        if (w->yields[i]) continue;
        if (value - upper[i] > NAME_KEPT || lower[i] - value > NAME_KEPT) return 0;
    }
    return 1;
}

"""
