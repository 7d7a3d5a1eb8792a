"""The search over change times: k times and one mask of segments per limb instead of a matrix over C.

Between two change times the contact state is constant, and g1 leaves each limb at most one swing (or one
stance) run, so a pattern is k times 0 < t_1 < … < t_k < m (cyclic: t_1 = 0 and arcs wrap) and, per limb, the
segments in which it swings.  The first feasible k from a lower bound upward is optimal.

``reading``  families → limb types, clauses, spread          ``options``  masks of segments, per number of times
``rows``     the rows that a type of limb may have           ``bound``    a lower bound on k
``times``    sets of change times as rows of one array       ``masks``    which masks are available, per set
``placing``  one mask per limb by memoised search            ``optimum``  the least k, or a proof
``counting`` ties counted and unranked                       ``listing``  distinct patterns
"""
