"""What the sensors show of a block, given the states: the equations of the split filter, once.

    load that pitch delays:  P = (xi + kappa (psi + nu psi')) W,  psi' = d psi/d ln frequency
    loads                    L_f = F_zf - P,  L_r = F_zr + P
    brakes, (2)              phi = B_f e^(rho/2)/(B_f e^(rho/2) + B_r e^(-rho/2))
    forces, (1)              F_f = (phi B + M_f)/L_f,  F_r = ((1 - phi) B + M_r)/L_r
    tyre                     lambda_0 = e^(c - s +- T/2) (2 L/W)^q F (1 + b2 u + b3 u^2),
                             u = F e^w, T = tau + dtau, + in front
    near its peak            no tyre follows a cubic: its slip errs by e (u/F_e)^12, of the axle
                             that is nearer to it, and by e at most; e, F_e as for a ramp
                             (`calib.model.ramp`)
    delay                    lambda = lambda_0 - delta d lambda_0/dF dF/dt,  dF_f/dt = phi B'/L_f
    radius under load        1 - lambda' = (1 - lambda) e^(r (L/L_0 - 1)),  L_0 at rest
    sensed, (22)             eta = (1 + eta0) (1 - lambda'_r)/(1 - lambda'_f)
    sensed, (19), (20)       slip = x lambda'_f + (1 - x) lambda'_r + sl0 + g z/V lag,  x = F_zf/W

B_f, B_r are the brake forces of nominal pads, B = level (B_f + B_r) with its rate B', M other
moments as a force at the road. Brakes that follow the pressure late make less slip than it says
while it rises; tyres that build up their force over a way sigma make more, by a delay of -sigma/V
(Pacejka, Tyre and Vehicle Dynamics, section 7.2). Where the brakes do not act, the normalised force
is that of the coasting car, on both axles, and that of the drive on its own. Symbols are those of
`calib.estimation.states`.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Generic, NamedTuple, TypeVar

from calib.estimation.expression import Expression, Trace, compiled, exp, python
from calib.estimation.states import States

T = TypeVar("T")


class Given(NamedTuple, Generic[T]):
    """What the equations are given of a block, besides the states. SI.

    ``brake_f``, ``brake_r`` brake forces of nominal pads [N]; ``level`` common factor on them, 0 if
    not braked [1]; ``moment_f``, ``moment_r`` what slows the wheels otherwise, as a force at the
    road [N]; ``load_f``, ``load_r`` [N]; ``coasting_f``, ``coasting_r`` normalised force [1], read
    where not braked; ``weight`` [N]; ``pitch_deficit`` load over W that the pitch mode has not yet
    moved [1], ``pitch_slope`` its slope by the logarithm of the mode's frequency [1]; ``lag_gain``
    g z/V, slip per second of clock offset [1/s]; ``static_f``, ``static_r`` axle loads at rest [N];
    ``rise`` of the brake force of nominal pads [N/s].
    """

    brake_f: T
    brake_r: T
    level: T
    moment_f: T
    moment_r: T
    load_f: T
    load_r: T
    coasting_f: T
    coasting_r: T
    weight: T
    pitch_deficit: T
    pitch_slope: T
    lag_gain: T
    static_f: T
    static_r: T
    rise: T


Pair = tuple[Expression, Expression]
_Rises = tuple[Expression | float, Expression | float]


class _Shown(NamedTuple):
    """What a block shows: ``eta`` and the mean ``slip`` [1].

    ``near_f``, ``near_r`` how near the tyres of each axle are to their peak: the normalised force
    that would be as near on the road of the ramp, F e^w [1].
    """

    eta: Expression
    slip: Expression
    near_f: Expression
    near_r: Expression


def braked(x: States[Expression], g: Given[Expression]) -> _Shown:
    """What is shown by a block in which the brakes act."""
    load_f, load_r = loads(x, g)
    half = exp(0.5 * x.log_pad_ratio)
    front, rear = g.brake_f * half, g.brake_r / half
    share = front / (front + rear)  # (2)
    total = g.level * (g.brake_f + g.brake_r)
    force_f = (share * total + g.moment_f) / load_f  # (1)
    force_r = ((1.0 - share) * total + g.moment_r) / load_r
    rise = g.level * g.rise
    rises = (share * rise / load_f, (1.0 - share) * rise / load_r)
    return sensed(x, g, (force_f, force_r), (load_f, load_r), rises)


def coasting(x: States[Expression], g: Given[Expression]) -> _Shown:
    """What is shown by a block in which the brakes do not act."""
    return sensed(x, g, (g.coasting_f, g.coasting_r), loads(x, g))


def loads(x: States[Expression], g: Given[Expression]) -> Pair:
    """Axle loads [N] less what the body has not moved yet."""
    mode = g.pitch_deficit + x.pitch_tempo * g.pitch_slope
    late = (x.load_shift + x.elastic_share * mode) * g.weight
    return g.load_f - late, g.load_r + late


def slips(
    x: States[Expression],
    g: Given[Expression],
    forces: Pair,
    load: Pair,
    rises: _Rises,
) -> Pair:
    """Slips [1] that the wheel speeds show: `calib.car.tyre.AxleTyres`.

    ``rises`` rates of the normalised ``forces`` [1/s].
    """
    apart = exp(0.5 * (x.log_tyre_ratio + x.tyre_change))
    front, rear = (slip(x, g, *axle) for axle in zip(forces, load, rises, strict=True))
    return (
        1.0 - (1.0 - front * apart) * exp(x.radius_load * (load[0] / g.static_f - 1.0)),
        1.0 - (1.0 - rear / apart) * exp(x.radius_load * (load[1] / g.static_r - 1.0)),
    )


def slip(
    x: States[Expression],
    g: Given[Expression],
    force: Expression,
    load: Expression,
    rise: Expression | float,
) -> Expression:
    """Slip [1] that carries a normalised force: the compliance of `calib.car.tyre`.

    As late as ``slip_delay`` says where the force rises by ``rise`` [1/s].
    """
    gain = exp(x.log_compliance - x.log_stiffness) * (2.0 * load / g.weight) ** x.load_exponent
    u = force * exp(x.log_peak_ratio)
    still = gain * force * (1.0 + x.curvature_2 * u + x.curvature_3 * u * u)
    slope = gain * (1.0 + 2.0 * x.curvature_2 * u + 3.0 * x.curvature_3 * u * u)
    return still - x.slip_delay * slope * rise


def sensed(
    x: States[Expression],
    g: Given[Expression],
    forces: Pair,
    load: Pair,
    rises: _Rises = (0.0, 0.0),
) -> _Shown:
    """Eta (22) and the load-weighted mean slip (19), (20) [1], with zeros and clock offset.

    ``rises`` rates of the normalised ``forces`` [1/s].
    """
    slip_f, slip_r = slips(x, g, forces, load, rises)
    share = g.load_f / g.weight
    eta = (1.0 + x.eta_zero) * ((1.0 - slip_r) / (1.0 - slip_f))
    mean = share * slip_f + (1.0 - share) * slip_r
    slip = mean + x.slip_zero + g.lag_gain * x.clock_offset
    w = exp(x.log_peak_ratio)
    return _Shown(eta, slip, forces[0] * w, forces[1] * w)


Numbers = Sequence[float]
Sensed = tuple[tuple[float, float], Numbers, tuple[float, float]]
"""Eta and slip [1], their gradients over the states, and how near the peak both axles are [1]."""

Measurement = Callable[[Numbers, Numbers], Sensed]
Loads = Callable[[Numbers, Numbers], tuple[tuple[float, float]]]


@cache
def measurement(
    equations: Callable[[States[Expression], Given[Expression]], _Shown],
) -> Measurement:
    """Compile `braked` or `coasting`: states and given numbers in; `Sensed` out.

    Arguments and gradients are in the order of `States` and `Given`. The gradients come in one
    tuple, first that of eta.
    """
    trace, x, g = _inputs()
    eta, mean, *near = equations(x, g)
    gradients = (*trace.gradient(eta, x), *trace.gradient(mean, x))
    return compiled(python(trace, _ARGUMENTS, [(eta, mean), gradients, tuple(near)]))


@cache
def axle_loads_now() -> Loads:
    """Compile `loads`: states and given numbers in; ((load_f, load_r),) [N] out."""
    trace, x, g = _inputs()
    return compiled(python(trace, _ARGUMENTS, [loads(x, g)]))


_ARGUMENTS = {"x": States._fields, "g": Given._fields}


def _inputs() -> tuple[Trace, States[Expression], Given[Expression]]:
    trace = Trace()
    return trace, States(*map(trace.input, States._fields)), Given(*map(trace.input, Given._fields))
