"""The list of quantities: each once, with symbol, unit and sign.

Everything inside the program is SI; bar, km/h, rpm and cm^2 occur only in input and output. Forces,
torques and slips are positive magnitudes when they brake. ``a_x`` keeps the sign of ISO 8855:
forward positive, so that braking is negative; ``z = -a_x/g`` is positive when braking.
"""

from dataclasses import dataclass

G = 9.80665
"""Standard gravity [m/s^2], ISO 80000-3."""

AXLES = ("f", "r")
AXLE_NAMES = {"f": "front", "r": "rear"}
WHEELS = ("fl", "fr", "rl", "rr")


@dataclass(frozen=True)
class _Quantity:
    """One logged quantity: canonical ``name``, ``symbol`` in the paper, ``meaning`` with the sign.

    ``unit`` of the canonical log file; ``si`` inside the program; ``required`` of every log.
    """

    name: str
    symbol: str
    unit: str
    si: str
    meaning: str
    required: bool = False


def _per_wheel(
    name: str, symbol: str, unit: str, si: str, meaning: str, required: bool = False
) -> list[_Quantity]:
    return [
        _Quantity(f"{name}_{w}", f"{symbol}_{w}", unit, si, f"{meaning}, {w}", required)
        for w in WHEELS
    ]


CHANNELS: dict[str, _Quantity] = {
    q.name: q
    for q in [
        _Quantity("time", "t", "s", "s", "time, increasing", True),
        _Quantity("p_mc", "P_mc", "bar", "Pa", "master-cylinder pressure", True),
        _Quantity(
            "a_x", "a_x", "m/s^2", "m/s^2", "acceleration at the c.g., forward positive", True
        ),
        *_per_wheel("omega", "omega", "rad/s", "rad/s", "wheel speed", True),
        _Quantity("v", "V", "m/s", "m/s", "reference speed over ground"),
        *_per_wheel("p", "P", "bar", "Pa", "wheel pressure"),
        _Quantity("T_disc_f", "T_f", "degC", "degC", "front disc temperature"),
        _Quantity("T_disc_r", "T_r", "degC", "degC", "rear disc temperature"),
        _Quantity("steering", "delta", "rad", "rad", "steering-wheel angle, left positive"),
        *[
            _Quantity(
                f"T_drive_{axle}",
                f"T_d{axle}",
                "N*m",
                "N*m",
                f"torque of engine or motor at both {side} wheels together, negative slows",
            )
            for axle, side in zip(AXLES, ("front", "rear"), strict=True)
        ],
    ]
}
"""The canonical channels, in the order in which a log is written."""

TRUTH_UNITS = {"true_Tb": "N*m", "true_Fx": "N", "true_Fz": "N", "true_mu_pad": "1"}
"""SI unit of each truth channel of a simulation, by prefix. Fit, estimator and diagnosis never read
them."""
