"""Why the wrong axle slips more while braking: the possible causes, most likely first."""

_SWAPPED = "front and rear wheel speeds that are swapped"
_OTHER = {"front": "rear", "rear": "front"}


def causes_of_reversed_slip(less: str) -> tuple[str, ...]:
    """The causes if the wheels of the axle that should slip less slip more.

    ``less`` is that axle, ``front`` or ``rear``.
    """
    return (
        _SWAPPED,
        f"{_OTHER[less]} pads that are weak: wet, hot, glazed or new",
        f"a motor or engine that brakes the {less} wheels and is not logged: regeneration",
        "an all-wheel drive that couples the axles",
        f"{less} wheels that brake more",
    )


def what_to_check(less: str, *, mirrored: bool = True) -> str:
    """Advice for a refusal.

    A swap mirrors the difference of the axles: if it is clearly larger or smaller than expected,
    not ``mirrored``, a torque of the drive is likelier.
    """
    swap = "are the axles swapped? correct them with a channel map"
    drive = (
        f"does a motor or the engine brake the {less} wheels? log T_drive_{less[0]}, or switch "
        "regeneration off; does an all-wheel drive couple the axles? open it"
    )
    pads = (
        f"are the {_OTHER[less]} pads weak (wet, hot, glazed or new), or does ABS work on the "
        f"{less} wheels?"
    )
    return "; ".join((swap, drive, pads) if mirrored else (drive, swap, pads))
