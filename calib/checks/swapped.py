"""Why the wrong axle slips more while braking: the possible causes, most likely first."""

_SWAPPED = "front and rear wheel speeds that are swapped"


def causes_of_reversed_slip(less: str, *, mirrored: bool = True) -> tuple[str, ...]:
    """The causes if the wheels of the axle that should slip less slip more.

    ``less`` is that axle, ``front`` or ``rear``. A swap mirrors the difference of the axles: if it
    is clearly larger or smaller than expected, not ``mirrored``, a torque of the drive is likelier.
    """
    drive = (
        f"a motor or engine that brakes the {less} wheels and is not logged: regeneration",
        "an all-wheel drive that couples the axles",
    )
    others = (f"{less} wheels that brake more",)
    return (_SWAPPED, *drive, *others) if mirrored else (*drive, _SWAPPED, *others)


def what_to_check(less: str, *, mirrored: bool = True) -> str:
    """The same as advice for a refusal, in the same order."""
    swap = "are the axles swapped? correct them with a channel map"
    drive = (
        f"does a motor or the engine brake the {less} wheels? log T_drive_{less[0]}, or switch "
        "regeneration off; does an all-wheel drive couple the axles? open it"
    )
    return "; ".join((swap, drive) if mirrored else (drive, swap))
