/* Supernodal LDL' of a symmetric quasi-definite matrix without pivoting, on a pattern that stays.

   Columns with (nearly) the same pattern form a supernode; supernode s holds columns first[s] … first[s+1]−1 in a
   dense panel, column by column, whose rows are rows[rowptr[s]] … rows[rowptr[s+1]−1] (its own columns first).
   Left-looking: every supernode is updated by those before it that reach into it, then factored. */

#include <math.h>
#include <string.h>

#define BLOCK 16

/* c (m × n, lower trapezoid when `low`) −= a (m × k) · b (k × n), b packed by columns of k */
static void subtract(int m, int n, int k, const double *restrict a, int lda, const double *restrict b,
                     double *restrict c, int ldc, int low)
{
    int j = 0;
    for (; j + 4 <= n; j += 4) {
        const double *b0 = b + (long)j * k, *b1 = b0 + k, *b2 = b1 + k, *b3 = b2 + k;
        double *restrict c0 = c + (long)j * ldc, *restrict c1 = c0 + ldc, *restrict c2 = c1 + ldc, *restrict c3 = c2 + ldc;
        int from = low ? j : 0, p = 0;
        for (; p + 4 <= k; p += 4) {
            const double *restrict a0 = a + (long)p * lda, *restrict a1 = a0 + lda, *restrict a2 = a1 + lda,
                         *restrict a3 = a2 + lda;
            for (int i = from; i < m; i++) {
                double x = a0[i], y = a1[i], z = a2[i], w = a3[i];
                c0[i] -= x * b0[p] + y * b0[p + 1] + z * b0[p + 2] + w * b0[p + 3];
                c1[i] -= x * b1[p] + y * b1[p + 1] + z * b1[p + 2] + w * b1[p + 3];
                c2[i] -= x * b2[p] + y * b2[p + 1] + z * b2[p + 2] + w * b2[p + 3];
                c3[i] -= x * b3[p] + y * b3[p + 1] + z * b3[p + 2] + w * b3[p + 3];
            }
        }
        for (; p < k; p++) {
            const double *restrict a0 = a + (long)p * lda;
            for (int i = from; i < m; i++) {
                double x = a0[i];
                c0[i] -= x * b0[p];
                c1[i] -= x * b1[p];
                c2[i] -= x * b2[p];
                c3[i] -= x * b3[p];
            }
        }
    }
    for (; j < n; j++) {
        double *restrict c0 = c + (long)j * ldc;
        for (int p = 0; p < k; p++) {
            const double *restrict a0 = a + (long)p * lda;
            double x = b[(long)j * k + p];
            for (int i = low ? j : 0; i < m; i++) c0[i] -= a0[i] * x;
        }
    }
}

/* LDL' of a panel (m × n, its first n rows the square part); d gets the pivots. 0, or 1 at a zero pivot. */
static int factor_panel(int m, int n, double *x, double *d, double *work)
{
    for (int at = 0; at < n; at += BLOCK) {
        int width = n - at < BLOCK ? n - at : BLOCK;
        for (int j = at; j < at + width; j++) {
            double *restrict column = x + (long)j * m;
            double pivot = column[j];
            if (!(fabs(pivot) > 1e-300) || !isfinite(pivot)) return 1;
            d[j] = pivot;
            double inverse = 1.0 / pivot;
            for (int k = j + 1; k < at + width; k++) {
                double *restrict other = x + (long)k * m;
                double scale = column[k] * inverse;
                for (int i = k; i < m; i++) other[i] -= column[i] * scale;
            }
            for (int i = j + 1; i < m; i++) column[i] *= inverse;
        }
        int next = at + width, left = n - next;
        if (left <= 0) continue;
        for (int j = 0; j < left; j++)
            for (int p = 0; p < width; p++) work[(long)j * width + p] = x[(long)(at + p) * m + next + j] * d[at + p];
        subtract(m - next, left, width, x + (long)at * m + next, m, work, x + (long)next * m + next, m, 1);
    }
    return 0;
}

/* Number of negative pivots, or −1 when a pivot is zero.  x holds the matrix in panels and gets L below the
   diagonal; d the pivots.  Integer work: head, next, reach [supernodes], map, place [n]; double work: as large as the
   largest update, twice. */
int ldl_factor(int supernodes, const int *first, const int *rowptr, const int *rows, const long *start, double *x,
               double *d, int *head, int *next, int *reach, int *map, int *place, const int *owner, double *work, double *packed)
{
    int negative = 0;
    for (int s = 0; s < supernodes; s++) head[s] = -1;
    for (int s = 0; s < supernodes; s++) {
        int from = first[s], n = first[s + 1] - from, m = rowptr[s + 1] - rowptr[s];
        const int *own = rows + rowptr[s];
        double *panel = x + start[s];
        for (int i = 0; i < m; i++) map[own[i]] = i;
        for (int u = head[s], after; u >= 0; u = after) {
            after = next[u];
            int k = first[u + 1] - first[u], total = rowptr[u + 1] - rowptr[u], begin = reach[u], end = begin;
            const int *theirs = rows + rowptr[u];
            while (end < total && theirs[end] < first[s + 1]) end++;
            int columns = end - begin, below = total - begin;
            const double *source = x + start[u];
            for (int j = 0; j < columns; j++)
                for (int p = 0; p < k; p++)
                    packed[(long)j * k + p] = source[(long)p * total + begin + j] * d[first[u] + p];
            for (int i = 0; i < below; i++) place[i] = map[theirs[begin + i]];
            if (place[below - 1] - place[0] == below - 1) { /* a block of the panel: no detour */
                subtract(below, columns, k, source + begin, total, packed, panel + (long)place[0] * (m + 1), m, 1);
            } else {
                memset(work, 0, sizeof(double) * (size_t)below * (size_t)columns);
                subtract(below, columns, k, source + begin, total, packed, work, below, 1);
                for (int j = 0; j < columns; j++) {
                    double *restrict target = panel + (long)place[j] * m;
                    const double *restrict update = work + (long)j * below;
                    for (int i = j; i < below; i++) target[place[i]] += update[i];
                }
            }
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
