"""What weighted rows leave free, made consistent with motions that are known to be free."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.kinematics.joints.pair.freedoms import beyond, left_by


@pytest.mark.parametrize("known", [0, 1, 2, 5, 6])
@pytest.mark.parametrize("count", [1, 4, 6, 30])
def test_what_is_known_to_be_free_remains_and_few_rows_leave_the_rest(count, known):
    rng = np.random.default_rng(10 * count + known)
    free = np.linalg.qr(rng.normal(size=(6, known)))[0] if known else np.zeros((6, 0))
    rows = rng.normal(size=(count, 6))
    basis, values = left_by(rows, rng.random(count) + 0.1, free, 1e-4)
    held = rows - rows @ free @ free.T
    assert basis.shape[1] == 6 - np.linalg.matrix_rank(held, tol=1e-9)
    assert np.abs(held @ basis).max(initial=0.0) < 1e-12
    assert np.allclose(basis @ (basis.T @ free), free)
    assert (np.diff(values) >= 0.0).all()
    for n in range(known + 1):
        freed = beyond(basis, free[:, :n])
        assert freed.shape[1] == basis.shape[1] - n
        both = np.hstack([free[:, :n], freed])
        assert np.allclose(both.T @ both, np.eye(both.shape[1]))
        assert np.allclose(both @ (both.T @ basis), basis)
