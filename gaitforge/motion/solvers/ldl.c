/* Supernodal LDL' of a symmetric quasi-definite matrix without pivoting, on a pattern that stays.

   Columns with (nearly) the same pattern form a supernode; supernode s holds columns first[s] … first[s+1]−1 in a
   dense panel, column by column, whose rows are rows[rowptr[s]] … rows[rowptr[s+1]−1] (its own columns first).
   Left-looking: every supernode is updated by those before it that reach into it, then factored.  Above the diagonal
   of a panel's square part there is nothing that means anything.

   All work is done on tiles of a few rows and columns that stay in registers (Goto & van de Geijn 2008).  Tiles read
   whole vectors and so up to TALL entries beyond the last row; the array of panels is that much longer. */

#include <math.h>
#include <string.h>

#if defined(LANES)
#elif defined(__AVX512F__)
#define LANES 8
#elif defined(__AVX__)
#define LANES 4
#else
#define LANES 2
#endif
#define WIDE 8 /* most columns of a tile */
#define TALL (2 * LANES)
#define BLOCK 16 /* columns of a panel that are factored together */

typedef double vector __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
#define INLINE static inline __attribute__((always_inline))

/* tile (TALL × n) ← −a (TALL × k) · b (k × n), b packed by rows */
INLINE void product(const int vectors, const int n, int k, const double *restrict a, long lda,
                    const double *restrict b, vector tile[WIDE][2])
{
    for (int j = 0; j < n; j++) tile[j][0] = tile[j][1] = (vector){0};
    for (int p = 0; p < k; p++, a += lda, b += n) {
        vector low = *(const vector *)a, high = vectors > 1 ? *(const vector *)(a + LANES) : low;
        for (int j = 0; j < n; j++) {
            tile[j][0] -= low * b[j];
            if (vectors > 1) tile[j][1] -= high * b[j];
        }
    }
}

/* c (m × n) −= a (m × k) · b (k × n); row i of the product belongs to row place[i] of c, to row i without `place`.
   Places that follow each other are met often: relaxed supernodes have long runs of rows in common. */
INLINE void columns(const int n, int m, int k, const double *restrict a, long lda, const double *restrict b,
                    double *restrict const *c, const int *restrict place)
{
    for (int i = 0; i < m; i += TALL) {
        int left = m - i < TALL ? m - i : TALL;
        vector tile[WIDE][2];
        if (left > LANES) product(2, n, k, a + i, lda, b, tile);
        else product(1, n, k, a + i, lda, b, tile);
        int from = place ? place[i] : i, together = !place || place[i + left - 1] - from == left - 1;
        if (together && left == TALL) {
            for (int j = 0; j < n; j++) {
                *(vector *)(c[j] + from) += tile[j][0];
                *(vector *)(c[j] + from + LANES) += tile[j][1];
            }
        } else if (together) {
            for (int j = 0; j < n; j++)
                for (int r = 0; r < left; r++) c[j][from + r] += ((const double *)tile[j])[r];
        } else {
            for (int j = 0; j < n; j++)
                for (int r = 0; r < left; r++) c[j][place[i + r]] += ((const double *)tile[j])[r];
        }
    }
}

/* Lower trapezoid of a panel −= a · d · (first n rows of a)': a (m × k) are rows of a panel whose pivots are d.
   Row i goes to row place[i], or at + i without `place`; column j to the column of row j. */
static void update(int m, int n, int k, const double *restrict a, long lda, const double *restrict d,
                   double *restrict x, long ldx, const int *restrict place, int at, double *restrict packed)
{
    for (int j = 0; j < n;) {
        int width = n - j >= 8 ? 8 : n - j >= 4 ? 4 : n - j >= 2 ? 2 : 1;
        double *restrict c[WIDE], *restrict b = packed;
        for (int p = 0; p < k; p++, b += width)
            for (int q = 0; q < width; q++) b[q] = a[p * lda + j + q] * d[p];
        for (int q = 0; q < width; q++) c[q] = x + (place ? place[j + q] * ldx : (at + j + q) * ldx + at + j);
        const double *from = a + j;
        const int *to = place ? place + j : 0;
        switch (width) {
        case 8: columns(8, m - j, k, from, lda, packed, c, to); break;
        case 4: columns(4, m - j, k, from, lda, packed, c, to); break;
        case 2: columns(2, m - j, k, from, lda, packed, c, to); break;
        default: columns(1, m - j, k, from, lda, packed, c, to);
        }
        j += width;
    }
}

/* Rows of L below a factored square of n columns: x ← x L'⁻¹ D⁻¹, LANES rows at a time; l (n × n) by columns. */
static void below(int m, int n, double *restrict x, long ldx, const double *restrict l, const double *restrict inverse)
{
    for (int i = 0; i < m; i += LANES) {
        int left = m - i < LANES ? m - i : LANES;
        vector row[BLOCK];
        for (int j = 0; j < n; j++) {
            vector sum = *(const vector *)(x + j * ldx + i);
            for (int p = 0; p < j; p++) sum -= row[p] * l[p * BLOCK + j];
            row[j] = sum;
        }
        for (int j = 0; j < n; j++) {
            vector done = row[j] * inverse[j];
            if (left == LANES) *(vector *)(x + j * ldx + i) = done;
            else for (int r = 0; r < left; r++) x[j * ldx + i + r] = done[r];
        }
    }
}

/* LDL' of a square of n ≤ BLOCK columns; 1 at a zero pivot. */
static int square(int n, double *restrict x, long ldx, double *restrict d, double *restrict l, double *restrict inverse)
{
    for (int j = 0; j < n; j++) {
        double *restrict column = x + j * ldx, pivot = column[j];
        if (!(fabs(pivot) > 1e-300) || !isfinite(pivot)) return 1;
        d[j] = pivot;
        inverse[j] = 1.0 / pivot;
        for (int i = j + 1; i < n; i++) l[j * BLOCK + i] = column[i] * inverse[j];
        for (int k = j + 1; k < n; k++)
            for (int i = k; i < n; i++) x[k * ldx + i] -= column[i] * l[j * BLOCK + k];
        for (int i = j + 1; i < n; i++) column[i] = l[j * BLOCK + i];
    }
    return 0;
}

/* LDL' of a panel (m × n, its first n rows the square part); d gets the pivots. 0, or 1 at a zero pivot. */
static int factor_panel(int m, int n, double *x, double *d, double *packed)
{
    double l[BLOCK * BLOCK], inverse[BLOCK];
    for (int at = 0; at < n; at += BLOCK) {
        int width = n - at < BLOCK ? n - at : BLOCK;
        double *corner = x + (long)at * (m + 1);
        if (at) update(m - at, width, at, x + at, m, d, x, m, 0, at, packed);
        if (square(width, corner, m, d + at, l, inverse)) return 1;
        below(m - at - width, width, corner + width, m, l, inverse);
    }
    return 0;
}

/* Number of negative pivots, or −1 when a pivot is zero.  x gets L below the diagonal, d the pivots.  The matrix'
   nonzeros of supernode s are values[source[i]], i = entry[s] … entry[s+1]−1, and go to target[i] in its panel.
   Integer work: head, next, reach [supernodes], map, place [n]; double work: WIDE times the widest supernode. */
int ldl_factor(int supernodes, const int *first, const int *rowptr, const int *rows, const long *start, double *x,
               double *d, const int *entry, const int *source, const int *target, const double *values, int *head,
               int *next, int *reach, int *map, int *place, const int *owner, double *packed)
{
    int negative = 0;
    for (int s = 0; s < supernodes; s++) head[s] = -1;
    for (int s = 0; s < supernodes; s++) {
        int from = first[s], n = first[s + 1] - from, m = rowptr[s + 1] - rowptr[s];
        const int *own = rows + rowptr[s];
        double *panel = x + start[s];
        memset(panel, 0, sizeof(double) * (size_t)m * (size_t)n);
        for (int i = entry[s]; i < entry[s + 1]; i++) panel[target[i]] = values[source[i]];
        for (int i = 0; i < m; i++) map[own[i]] = i;
        for (int u = head[s], after; u >= 0; u = after) {
            after = next[u];
            int k = first[u + 1] - first[u], total = rowptr[u + 1] - rowptr[u], begin = reach[u], end = begin;
            const int *theirs = rows + rowptr[u];
            while (end < total && theirs[end] < first[s + 1]) end++;
            int count = total - begin;
            for (int i = 0; i < count; i++) place[i] = map[theirs[begin + i]];
            int whole = place[count - 1] - place[0] == count - 1; /* a block of the panel */
            update(count, end - begin, k, x + start[u] + begin, total, d + first[u], panel, m, whole ? 0 : place,
                   place[0], packed);
            if (end < total) {
                int to = owner[theirs[end]];
                reach[u] = end;
                next[u] = head[to];
                head[to] = u;
            }
        }
        if (factor_panel(m, n, panel, d + from, packed)) return -1;
        for (int j = 0; j < n; j++) negative += d[from + j] < 0;
        if (n < m) {
            int to = owner[own[n]];
            reach[s] = n;
            next[s] = head[to];
            head[to] = s;
        }
    }
    return negative;
}

/* b ← (L D L')⁻¹ b, in the order of the factor; work: as long as the tallest panel. */
void ldl_solve(int supernodes, const int *first, const int *rowptr, const int *rows, const long *start,
               const double *x, const double *d, double *b, double *restrict work)
{
    for (int s = 0; s < supernodes; s++) {
        int n = first[s + 1] - first[s], m = rowptr[s + 1] - rowptr[s];
        const int *own = rows + rowptr[s];
        for (int i = 0; i < m; i++) work[i] = b[own[i]];
        for (int j = 0; j < n; j++) {
            const double *restrict column = x + start[s] + (long)j * m;
            double value = work[j];
            for (int i = j + 1; i < m; i++) work[i] -= column[i] * value;
        }
        for (int i = 0; i < m; i++) b[own[i]] = work[i];
    }
    for (int i = 0; i < first[supernodes]; i++) b[i] /= d[i];
    for (int s = supernodes - 1; s >= 0; s--) {
        int n = first[s + 1] - first[s], m = rowptr[s + 1] - rowptr[s];
        const int *own = rows + rowptr[s];
        for (int i = 0; i < m; i++) work[i] = b[own[i]];
        for (int j = n - 1; j >= 0; j--) {
            const double *restrict column = x + start[s] + (long)j * m;
            double sums[8] = {0};
            int i = j + 1;
            for (; i + 8 <= m; i += 8)
                for (int k = 0; k < 8; k++) sums[k] += column[i + k] * work[i + k];
            for (; i < m; i++) sums[0] += column[i] * work[i];
            work[j] -= ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
        }
        for (int j = 0; j < n; j++) b[own[j]] = work[j];
    }
}
