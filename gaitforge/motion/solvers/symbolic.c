/* Where the factor of a symmetric matrix has entries: elimination tree, supernodes and their rows.

   The matrix is given by the upper triangle of its pattern by columns, with an ordering of it (position → index). */

#include <stdlib.h>

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* Share of stored zeros that a supernode may have: narrow ones gain most from being joined. */
static double allowed(int width)
{
    return width <= 4 ? 0.6 : width <= 16 ? 0.3 : 0.1;
}

/* Elimination tree (Liu 1990) and how many entries each column of L has below its diagonal. */
static void grow(int n, const int *begin, const int *left, int *parent, int *counts, int *seen)
{
    for (int k = 0; k < n; k++) {
        parent[k] = -1;
        counts[k] = 0;
        seen[k] = k;
        for (int e = begin[k]; e < begin[k + 1]; e++)
            for (int i = left[e]; seen[i] != k; i = parent[i]) {
                if (parent[i] < 0) parent[i] = k;
                counts[i]++;
                seen[i] = k;
            }
    }
}

/* Children before their parents, the one with most entries next to its parent, which it may be joined with. */
static void postorder(int n, const int *parent, const int *counts, int *post, int *head, int *next, int *largest)
{
    for (int k = 0; k <= n; k++) head[k] = largest[k] = -1;
    for (int k = 0; k < n; k++) {
        int p = parent[k] < 0 ? n : parent[k];
        if (largest[p] < 0 || counts[k] >= counts[largest[p]]) largest[p] = k;
    }
    for (int p = 0; p <= n; p++)
        if (largest[p] >= 0) {
            head[p] = largest[p];
            next[largest[p]] = -1;
        }
    for (int k = n - 1; k >= 0; k--) {
        int p = parent[k] < 0 ? n : parent[k];
        if (largest[p] == k) continue;
        next[k] = head[p];
        head[p] = k;
    }
    int *stack = largest, depth = 0, done = 0; /* largest is not needed any more */
    stack[0] = n;
    while (depth >= 0) {
        int k = stack[depth], child = head[k];
        if (child >= 0) {
            head[k] = next[child];
            stack[++depth] = child;
        } else {
            depth--;
            if (k < n) post[done++] = k;
        }
    }
}

/* Columns that are stored together: a column joins the one after it when that is its parent and few zeros are stored
   for it.  first gets where supernodes begin, and n; how many there are is returned. */
static int join(int n, const int *parent, const int *counts, int *first)
{
    int found = 0;
    double zeros = 0.0;
    for (int j = 0; j < n; j++) {
        if (j && parent[j - 1] == j) {
            int width = j - first[found - 1];
            double extra = (double)width * (counts[j] + 1 - counts[j - 1]);
            double full = (width + 1) * (counts[j] + 1 + 0.5 * width);
            if (zeros + extra <= allowed(width + 1) * full) {
                zeros += extra;
                continue;
            }
        }
        first[found++] = j;
        zeros = 0.0;
    }
    first[found] = n;
    return found;
}

/* Number of supernodes.  order is put in postorder; first [n + 1] and rowptr [n + 1] get where their columns and rows
   begin.  Work: 8 n + 10 integers, and one for every entry of the pattern. */
int symbolic_supernodes(int n, const int *indptr, const int *indices, int *order, int *first, int *rowptr, int *work,
                        int *left)
{
    int *place = work, *begin = place + n, *parent = begin + n + 2, *counts = parent + n, *post = counts + n;
    int *head = post + n, *next = head + n + 1, *largest = next + n + 1;
    for (int k = 0; k < n; k++) place[order[k]] = k;
    for (int k = 0; k <= n + 1; k++) begin[k] = 0;
    for (int pass = 0; pass < 2; pass++) { /* count the entries of each row left of its diagonal, then list them */
        for (int b = 0; b < n; b++)
            for (int e = indptr[b]; e < indptr[b + 1]; e++) {
                int i = place[indices[e]], j = place[b], low = i < j ? i : j, high = i < j ? j : i;
                if (i == j) continue;
                if (pass) left[begin[high + 1]++] = low;
                else begin[high + 2]++;
            }
        for (int k = 0; !pass && k < n; k++) begin[k + 2] += begin[k + 1];
    }
    grow(n, begin, left, parent, counts, post);
    postorder(n, parent, counts, post, head, next, largest);
    for (int k = 0; k < n; k++) place[post[k]] = k;
    for (int k = 0; k < n; k++) { /* everything in postorder; head, next and largest are free again */
        int old = post[k];
        head[k] = order[old];
        next[k] = counts[old];
        largest[k] = parent[old] < 0 ? -1 : place[parent[old]];
    }
    for (int k = 0; k < n; k++) order[k] = head[k];
    int found = join(n, largest, next, first);
    rowptr[0] = 0;
    for (int s = 0; s < found; s++) rowptr[s + 1] = rowptr[s] + first[s + 1] - first[s] + next[first[s + 1] - 1];
    return found;
}

/* Rows of every supernode, its own columns first; owner [n] of each column; where the matrix' entries go: those of
   supernode s are source[i], i = entry[s] … entry[s+1]−1, and lie at target[i] in its panel.  Work: 4 n integers. */
void symbolic_rows(int n, int supernodes, const int *indptr, const int *indices, const int *order, const int *first,
                   const int *rowptr, int *rows, int *owner, int *entry, int *source, int *target, int *work)
{
    int *place = work, *mark = place + n, *head = mark + n, *next = head + n;
    for (int k = 0; k < n; k++) place[order[k]] = k;
    for (int k = 0; k < n; k++) mark[k] = head[k] = -1;
    for (int s = 0; s < supernodes; s++)
        for (int k = first[s]; k < first[s + 1]; k++) owner[k] = s;
    for (int s = 0; s <= supernodes; s++) entry[s] = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int b = 0; b < n; b++)
            for (int e = indptr[b]; e < indptr[b + 1]; e++) {
                int i = place[indices[e]], j = place[b], s = owner[i < j ? i : j];
                if (pass) {
                    source[entry[s]] = e;
                    target[entry[s]++] = b; /* its column for now */
                } else if (s + 1 < supernodes) entry[s + 1]++;
            }
        if (!pass)
            for (int s = 1; s < supernodes; s++) entry[s] += entry[s - 1];
    }
    for (int s = supernodes; s > 0; s--) entry[s] = entry[s - 1];
    entry[0] = 0;
    for (int s = 0; s < supernodes; s++) {
        int width = first[s + 1] - first[s], height = rowptr[s + 1] - rowptr[s], found = width;
        int *own = rows + rowptr[s];
        for (int k = 0; k < width; k++) own[k] = first[s] + k;
        for (int i = entry[s]; i < entry[s + 1]; i++) {
            int a = place[indices[source[i]]], b = place[target[i]], row = a < b ? b : a;
            if (row >= first[s + 1] && mark[row] != s) {
                mark[row] = s;
                own[found++] = row;
            }
        }
        for (int c = head[s]; c >= 0; c = next[c])
            for (int i = rowptr[c]; i < rowptr[c + 1]; i++)
                if (rows[i] >= first[s + 1] && mark[rows[i]] != s) {
                    mark[rows[i]] = s;
                    own[found++] = rows[i];
                }
        qsort(own + width, (size_t)(found - width), sizeof(int), ascending);
        for (int i = 0; i < height; i++) mark[own[i]] = i; /* places, until the entries are done */
        for (int i = entry[s]; i < entry[s + 1]; i++) {
            int a = place[indices[source[i]]], b = place[target[i]], row = a < b ? b : a, column = a < b ? a : b;
            target[i] = (column - first[s]) * height + mark[row];
        }
        for (int i = 0; i < height; i++) mark[own[i]] = -1;
        if (width < height) {
            int to = owner[own[width]];
            next[s] = head[to];
            head[to] = s;
        }
    }
}
