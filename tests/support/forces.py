"""A force balance with a stated demanded brake force."""

import numpy as np

from calib.car.balance import ForceBalance


def made_balance(demanded: np.ndarray) -> ForceBalance:
    """The balance of a car whose tyres carry ``demanded`` [N] (n,) and nothing else."""
    none = np.zeros_like(demanded)
    return ForceBalance(none + 9000.0, none + 7000.0, none, none, none, none, none, demanded)
