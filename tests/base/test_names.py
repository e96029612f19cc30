"""The channels against the contract, written out by hand."""

from calib.base.names import CHANNELS

CONTRACT = """
    time      s
    p_mc      bar
    a_x       m/s^2
    omega_fl  rad/s
    omega_fr  rad/s
    omega_rl  rad/s
    omega_rr  rad/s
    v         m/s
    p_fl      bar
    p_fr      bar
    p_rl      bar
    p_rr      bar
    T_disc_f  degC
    T_disc_r  degC
"""
REQUIRED = {"time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr"}


def test_channels_and_units_are_those_of_the_contract_in_its_order():
    rows = [tuple(line.split()) for line in CONTRACT.strip().splitlines()]
    actual = [(name, channel.unit) for name, channel in CHANNELS.items()]
    assert {name for name, channel in CHANNELS.items() if channel.required} == REQUIRED
    assert actual[: len(rows)] == rows
    # further channels
    assert actual[len(rows) :] == [
        ("steering", "deg"), ("T_drive_f", "N*m"), ("T_drive_r", "N*m"), ("abs_active", "1"),
    ]  # fmt: skip
