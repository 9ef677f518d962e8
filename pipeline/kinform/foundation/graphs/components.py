"""Connected components of large graphs: which facets, vertices or surfaces hang together.

Every node learns of the lowest one that it hangs together with: of two neighbouring trees the one with the higher root
is hung under the other, and all are made flat again (hooking and shortcutting, as Shiloach and Vishkin, J. Algorithms
3, 1982), in a number of rounds that grows with the logarithm of the nodes.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Ints


def components(a: Ints, b: Ints, count: int) -> Ints:
    """(count,) number of the connected component of each node under the links a–b, (n,) each; components are numbered
    by their first node."""
    root = roots(a, b, count)
    return np.asarray((np.cumsum(root == np.arange(count)) - 1).take(root))


def roots(a: Ints, b: Ints, count: int) -> Ints:
    """(count,) first node of the component of each."""
    own = np.arange(count)
    root, rounds = own.copy(), 0
    while True:
        apart = (a != b).nonzero()[0]
        if not len(apart):
            break
        a, b = a.take(apart), b.take(apart)
        hung = np.maximum(a, b)
        np.minimum.at(root, hung, np.minimum(a, b))
        if len(hung) > count:
            hung = (root != own).nonzero()[0]
        # only what was hung now is made flat; what hangs under it, in the end
        mine = root.take(hung)
        higher = root.take(mine)
        while (higher != mine).any():
            root[hung] = mine = higher
            higher = root.take(mine)
        a, b = root.take(a), root.take(b)
        rounds += 1
    while rounds > 1:
        higher = root.take(root)
        if (higher == root).all():
            break
        root = higher
    return root
